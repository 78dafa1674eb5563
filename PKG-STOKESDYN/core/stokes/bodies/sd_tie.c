#include "sd_tie.h"

#include <stdlib.h>
#include <string.h>

#include "sd_bodies_alone.h"
#include "sd_cg.h"
#include "sd_tie_approach.h"
#include "sd_tie_factor.h"

/* SD_TIE_OF_BODY: vectors of conjugate gradients and one more; or the blocks that the factor is made of */
enum { MOST_PRODUCTS = 1000, CG_VECTORS = SD_TIE_OF_BODY / 6 - 1 };

sd_status sd_tie_make(const sd_bodies *A, sd_tie_room room)
{
  A->tie->products = 0;
  const int there = sd_tie_approach_reserve(A);
  sd_status status = sd_world_agree(&A->tie->L->world, there ? SD_OK : SD_ENOMEMORY);
  if (status == SD_OK) status = sd_tie_approach_make(A, room.spheres);
  return status == SD_OK ? sd_tie_factor(A, room.bodies) : status;
}

/* out += sign K^T f of what spheres at the arms of K bear when they move with K V: (L + X), or L alone. */
static sd_status add_borne(const sd_bodies *A, const sd_rigid *K, int both, double sign, const double *V,
                           sd_tie_room room, double *out)
{
  sd_tie *t = A->tie;
  double *f = room.spheres + 6 * (long) t->L->n, *bodies = room.bodies + 6 * CG_VECTORS * (long) sd_bodies_count(A);
  const double *v = sd_rigid_moved(K, V, room.spheres);
  const sd_status status = both ? sd_lubrication_apply_both(t->L, t->springs.own, t->springs.c, v, f)
                                : sd_lubrication_apply(t->L, v, f);
  t->products++;
  if (status != SD_OK) return status;
  const double *by_bodies = sd_rigid_collected(K, f, sd_bodies_count(A), bodies);
  for (long j = 0; j < 6 * (long) sd_bodies_count(A); j++) out[j] += sign * by_bodies[j];
  return SD_OK;
}

/* out = K^T (L + X) K V. Where films have arms of their own L has these, and X, which is of the points, those of
 * the points: their forces must add up to what is borne. */
static sd_status resist(const sd_bodies *A, const double *V, sd_tie_room room, double *out)
{
  const sd_rigid films = sd_bodies_films(A);
  memset(out, 0, sizeof(double) * 6 * (size_t) sd_bodies_count(A));
  sd_status status = add_borne(A, &A->spheres, 1, 1.0, V, room, out);
  if (!A->film_arm || status != SD_OK) return status;
  status = add_borne(A, &A->spheres, 0, -1.0, V, room, out);
  return status == SD_OK ? add_borne(A, &films, 0, 1.0, V, room, out) : status;
}

typedef struct {
  const sd_bodies *A;
  double tolerance, enough;
  double *alone;
  sd_tie_room room;
} films;

/* w = H p */
static sd_status tie_apply(void *ctx, const double *p, double *w)
{
  const films *s = ctx;
  const sd_status status = resist(s->A, p, s->room, w);
  if (status != SD_OK) return status;
  sd_bodies_alone_resist(s->A, p, s->alone);
  for (long j = 0; j < 6 * (long) sd_bodies_count(s->A); j++) w[j] += s->alone[j];
  return SD_OK;
}

static sd_status tie_precondition(void *ctx, const double *r, double *z)
{
  const films *s = ctx;
  return sd_tie_precondition(s->A, r, z);
}

/* What V lacks after too many products is left to the loop. */
static sd_status tie_judge(void *ctx, const sd_cg_state *now, int *done)
{
  films *s = ctx;
  if (now->steps == 0) s->enough = s->tolerance * s->tolerance * now->rz;
  *done = now->rz <= s->enough || now->steps == MOST_PRODUCTS;
  return SD_OK;
}

/* borne = K^T (L + X) K V_held + K^T X r, what is so before anybody moves */
static sd_status bear_before(const sd_bodies *A, const sd_tie_problem *problem, const double *V, sd_tie_room room,
                             double *borne)
{
  const double *r = problem->r;
  const int bodies = sd_bodies_count(A);
  sd_status status = SD_OK;
  memset(borne, 0, sizeof(double) * 6 * (size_t) bodies);
  if (sd_tie_has_springs(A)) sd_tie_approach_see(A, r);
  if (sd_tie_has_springs(A) && r) status = sd_tie_approach_push(A, NULL, room.spheres, borne);
  if (!problem->moved || status != SD_OK) return status;
  double *by_held = room.bodies;
  status = resist(A, V, room, by_held);
  for (long j = 0; j < 6 * (long) bodies; j++) borne[j] += by_held[j];
  return status;
}

/* H V = b by H (V - V_held) = b - H V_held: r on entry, less H_0 V, is what is borne. What is held,
 * and bodies without neighbours, is not the preconditioner's, and stays as it is. H_0 V_held loads
 * bodies that are spun, whose centres are free. */
sd_status sd_tie_solve(const sd_bodies *A, const sd_tie_problem *problem, sd_tie_room room, double *V, double *borne)
{
  const double *g = problem->g;
  const long size = 6 * (long) sd_bodies_count(A);
  double *x = room.bodies;
  const sd_cg_vectors v = {x, x + size, x + 2 * size, x + 3 * size, x + 4 * size};
  films s = {A, problem->tolerance, 0.0, borne, room};
  const sd_cg cg = {.size = size,
                    .paired = size,
                    .ctx = &s,
                    .apply = tie_apply,
                    .precondition = tie_precondition,
                    .judge = tie_judge,
                    .world = &A->world};
  sd_cg_state state;
  sd_status status = bear_before(A, problem, V, room, borne);
  if (status != SD_OK) return status;
  memset(x, 0, sizeof(double) * (size_t) size);
  if (problem->moved) sd_bodies_alone_resist(A, V, x);
  for (long j = 0; j < size; j++) v.r[j] = g[j] - borne[j] - x[j];
  memset(x, 0, sizeof(double) * (size_t) size);
  if ((status = sd_cg_run(&cg, &v, &state)) != SD_OK) return status;
  A->tie->left = state.rz;
  for (long j = 0; j < size; j++) V[j] += x[j];
  sd_bodies_alone_resist(A, V, borne);
  for (long j = 0; j < size; j++) borne[j] = g[j] - v.r[j] - borne[j];
  return sd_tie_has_springs(A) ? sd_tie_approach_push(A, V, room.spheres, NULL) : SD_OK;
}

void sd_tie_share(const sd_bodies *A, double *l)
{
  if (sd_tie_has_springs(A)) sd_tie_approach_add(A, l);
}

void sd_tie_free(sd_tie *t)
{
  const sd_tie_border *b = &t->border;
  const sd_tie_springs *X = &t->springs;
  void *const arrays[] = {t->made_of, t->scale, t->all,  X->c,    X->own,  X->seen,   X->there, b->other,
                          b->weight,  b->shared, b->lent, b->away, b->lend, b->borrow, b->sent};
  sd_block_cholesky_free(&t->factor);
  for (size_t k = 0; k < sizeof(arrays) / sizeof(arrays[0]); k++) free(arrays[k]);
  *t = (sd_tie){0};
}
