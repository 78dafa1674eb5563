#include "sd_tie.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_room.h"
#include "sd_tie_approach.h"

enum { MOST_PRODUCTS = 1000, VECTORS = 4 };

static sd_status reserve_all(const sd_bodies *A)
{
  sd_tie *t = A->tie;
  const size_t number = sizeof(double), bodies = (size_t) sd_tie_bodies(A);
  /* ghosts are as wide as L_ii */
  const int there = sd_reserve(&t->vectors, number, 6 * VECTORS * bodies, &t->most_vectors) &&
      sd_reserve(&t->rows, number, 12 * (size_t) A->n, &t->most_rows) &&
      sd_reserve(&t->ghosts, number, 36 * (size_t) A->ghosts, &t->most_ghosts);
  return there ? SD_OK : SD_ENOMEMORY;
}

sd_status sd_tie_make(const sd_bodies *A)
{
  A->tie->products = 0;
  sd_status status = reserve_all(A);
  if (status == SD_OK) status = sd_tie_approach_make(A);
  return status == SD_OK ? sd_tie_factor(A) : status;
}

/* --- K, by numbers of bodies --- */

static void spread(const sd_bodies *A, const double *V, double *rows)
{
  for (int e = 0; e < A->lone; e++)
    memcpy(rows + 6 * (long) A->loner[e], V + 6 * (long) e, 6 * sizeof(double));
  for (int b = 0; b < A->clumps; b++) {
    double in_shape[6];
    sd_bodies_clear(A, b, rows);
    sd_bodies_to_shape(A->pose + 9 * (long) b, V + 6 * (long) (A->lone + b), in_shape);
    sd_bodies_add_rigid(A, b, in_shape, rows);
  }
}

static sd_status collect(const sd_bodies *A, const double *rows, double *f)
{
  for (int e = 0; e < A->lone; e++)
    memcpy(f + 6 * (long) e, rows + 6 * (long) A->loner[e], 6 * sizeof(double));
  return sd_bodies_onto_clumps(A, rows, A->tie->ghosts, f + 6 * (long) A->lone);
}

/* out = H_0 V */
static void resist_alone(const sd_bodies *A, const double *V, double *out)
{
  for (int e = 0; e < A->lone; e++)
    for (int d = 0; d < 6; d++)
      out[6 * (long) e + d] = sd_bodies_drag(A, A->loner[e], d) * V[6 * (long) e + d];
  for (int b = 0; b < A->clumps; b++) {
    const double *R = A->pose + 9 * (long) b;
    double v[6], f[6], *to = out + 6 * (long) (A->lone + b);
    sd_bodies_to_shape(R, V + 6 * (long) (A->lone + b), v);
    sd_bodies_multiply6(A->shape[b]->resistance, v, f);
    sd_bodies_to_space(R, f, to);
    for (int d = 0; d < 6; d++) to[d] *= A->eta[b];
  }
}

/* out = K^T (L + X) K V */
static sd_status apply(const sd_bodies *A, const double *V, double *out)
{
  sd_tie *t = A->tie;
  double *v = t->rows, *f = v + 6 * (long) A->n;
  spread(A, V, v);
  const sd_status status = sd_lubrication_apply(t->L, v, f);
  t->products++;
  if (status != SD_OK) return status;
  sd_tie_approach_add(A, v, f);
  return collect(A, f, out);
}

/* --- the model --- */

/* share += X v, by rows */
static sd_status add_approach(const sd_bodies *A, const double *v, double *share)
{
  const sd_world *world = &A->tie->L->world;
  if (world->refresh && world->ranks > 1) {
    const sd_status status = world->refresh(world->ctx, v, A->tie->L->others, 6);
    if (status != SD_OK) return status;
  }
  sd_tie_approach_add(A, v, share);
  return SD_OK;
}

/* share = X r, borne = K^T X r */
static sd_status take_slip(const sd_bodies *A, const double *r, double *borne, double *share)
{
  memset(borne, 0, sizeof(double) * 6 * (size_t) sd_tie_bodies(A));
  memset(share, 0, sizeof(double) * 6 * (size_t) A->n);
  if (!r) return SD_OK;
  const sd_status status = add_approach(A, r, share);
  return status == SD_OK ? collect(A, share, borne) : status;
}

/* --- conjugate gradients --- */

/* sums[k] = a[k].b[k] over all bodies, each once */
static sd_status dots(const sd_bodies *A, int count, const double *const *a, const double *const *b,
                      double *sums)
{
  for (int k = 0; k < count; k++) {
    sums[k] = 0.0;
    for (long j = 0; j < 6 * (long) A->lone; j++) sums[k] += a[k][j] * b[k][j];
    for (int c = 0; c < A->clumps; c++)
      for (long d = 0; d < 6 && sd_tie_ours(A, c); d++) {
        const long j = 6 * (long) (A->lone + c) + d;
        sums[k] += a[k][j] * b[k][j];
      }
  }
  return A->sum ? A->sum(A->sum_ctx, sums, count) : SD_OK;
}

/* r, z, p, w as ever: one step along p; w holds K^T (L + X) K p, z H_0 p */
static sd_status step(const sd_bodies *A, double rz, double *V, double *borne)
{
  const sd_tie *t = A->tie;
  const long size = 6 * sd_tie_bodies(A);
  double *r = t->vectors, *z = r + size, *p = z + size, *w = p + size, sums[2];
  sd_status status = apply(A, p, w);
  if (status != SD_OK) return status;
  resist_alone(A, p, z);
  status = dots(A, 2, (const double *[]){p, p}, (const double *[]){w, z}, sums);
  if (status != SD_OK) return status;
  const double pHp = sums[0] + sums[1], alpha = rz / pHp;
  if (!(pHp > 0.0)) return isfinite(pHp) ? SD_EINDEFINITE : SD_ENOTFINITE;
  for (long j = 0; j < size; j++) {
    V[j] += alpha * p[j];
    borne[j] += alpha * w[j];
    r[j] -= alpha * (w[j] + z[j]);
  }
  return SD_OK;
}

/* H V = f, t->vectors on entry, from V = 0. What is borne follows V by the same steps, so that it
 * needs no product of its own. What V lacks after too many products is left to the loop. */
static sd_status solve(const sd_bodies *A, double tolerance, double *V, double *borne)
{
  const long size = 6 * sd_tie_bodies(A);
  double *r = A->tie->vectors, *z = r + size, *p = z + size, rz, before = 1.0, enough = 0.0;
  memset(V, 0, sizeof(double) * (size_t) size);
  memset(p, 0, sizeof(double) * (size_t) size);
  for (int k = 0;; k++) {
    sd_status status = sd_tie_precondition(A, r, z);
    if (status == SD_OK) status = dots(A, 1, (const double *[]){r}, (const double *[]){z}, &rz);
    if (status != SD_OK) return status;
    if (!isfinite(rz)) return SD_ENOTFINITE;
    if (k == 0) enough = tolerance * tolerance * rz;
    if (rz <= enough || k == MOST_PRODUCTS) return SD_OK;
    for (long j = 0; j < size; j++) p[j] = z[j] + rz / before * p[j];
    before = rz;
    if ((status = step(A, rz, V, borne)) != SD_OK) return status;
  }
}

sd_status sd_tie_solve(const sd_bodies *A, const double *V_0, const double *r, double tolerance,
                       double *V, double *borne, double *share)
{
  const sd_tie *t = A->tie;
  const long size = 6 * sd_tie_bodies(A);
  sd_status status = take_slip(A, r, borne, share);
  if (status != SD_OK) return status;
  resist_alone(A, V_0, t->vectors);
  for (long j = 0; j < size; j++) t->vectors[j] -= borne[j];
  if ((status = solve(A, tolerance, V, borne)) != SD_OK) return status;
  for (long j = 0; j < size; j++)
    if (t->scale[j] == 0.0) V[j] = V_0[j];
  spread(A, V, t->rows);
  return add_approach(A, t->rows, share);
}

void sd_tie_free(sd_tie *t)
{
  sd_block_cholesky_free(&t->factor);
  free(t->spring);
  free(t->stiff);
  free(t->vectors);
  free(t->rows);
  free(t->ghosts);
  free(t->number);
  free(t->scale);
  free(t->all);
  *t = (sd_tie){0};
}
