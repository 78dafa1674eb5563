#include "sd_sph_implicit.h"

#include "sd_cg.h"
#include "sd_sph_class.h"

#include <string.h>

static const double IMPLICIT_TOLERANCE = 1e-8;
enum { IMPLICIT_MOST_STEPS = 1000 };

/* A solve: rows of velocities for the loops of forces, and what they make of them */
typedef struct {
  const sd_sph_implicit *A;
  sd_sph_model friction;
  sd_sph_particles p;
  double *v4, *f4, *mu, *diagonal;
  double first;
} rubbing;

static int is_given(const sd_sph_implicit *A, int i)
{
  return A->particles->phase[i] < 0;
}

size_t sd_sph_implicit_size(const sd_sph_implicit *A)
{
  return 5 * (size_t) (A->particles->n + 1) + 16 * (size_t) A->n;
}

/* f4 = - K y over all particles, y [3 n] of which those with a given velocity are not read. */
static void rub(const rubbing *s, const double *y)
{
  const sd_sph_implicit *A = s->A;
  const int all = A->particles->n;
  for (int i = 0; i < A->n; i++)
    for (int d = 0; d < 3; d++) s->v4[4 * (size_t) i + d] = is_given(A, i) ? 0.0 : y[3 * (size_t) i + d];
  if (A->forward) A->forward(A->ctx, s->v4);
  memset(s->f4, 0, sizeof(double) * 4 * (size_t) (all + 1));
  sd_sph_forces(&s->friction, A->list, &s->p, 0, s->f4, NULL);
  if (A->back) A->back(A->ctx, s->f4);
}

static sd_status rub_apply(void *ctx, const double *p, double *w)
{
  const rubbing *s = ctx;
  const sd_sph_implicit *A = s->A;
  rub(s, p);
  for (int i = 0; i < A->n; i++)
    for (int d = 0; d < 3; d++) {
      const size_t k = 3 * (size_t) i + d;
      w[k] = is_given(A, i) ? 0.0 : A->m[i] / A->tau * p[k] - s->f4[4 * (size_t) i + d];
    }
  return SD_OK;
}

static sd_status rub_precondition(void *ctx, const double *r, double *z)
{
  const rubbing *s = ctx;
  for (int i = 0; i < s->A->n; i++)
    for (int d = 0; d < 3; d++) z[3 * (size_t) i + d] = r[3 * (size_t) i + d] / s->diagonal[i];
  return SD_OK;
}

static sd_status rub_judge(void *ctx, const sd_cg_state *now, int *done)
{
  rubbing *s = ctx;
  if (now->steps == 0) s->first = now->rz;
  *done = now->rz <= IMPLICIT_TOLERANCE * IMPLICIT_TOLERANCE * s->first;
  return !*done && now->steps >= IMPLICIT_MOST_STEPS ? SD_EMAXITER : SD_OK;
}

/* Those with a given velocity have so large a mu that the harmonic mean is twice the other's. The diagonal of
 * K is about that of the smooth fluid, m 8 mu/(rho h^2); central has (D + 2)/D times as much along each axis. */
static void rub_prepare(rubbing *s)
{
  const sd_sph_implicit *A = s->A;
  const sd_sph_particles *p = A->particles;
  const double form = A->model->friction == SD_SPH_CENTRAL ? 1.0 + 2.0 / A->model->dimension : 1.0;
  s->friction = *A->model;
  s->friction.scheme = SD_SPH_PLAIN;
  s->friction.artvisc = s->friction.tenscorr = 0;
  s->p = *p;
  s->p.v4 = s->v4;
  s->p.mu = s->mu;
  memcpy(s->v4, p->v4, sizeof(double) * 4 * (size_t) (p->n + 1));
  memcpy(s->mu, p->mu, sizeof(double) * (size_t) (p->n + 1));
  for (int i = 0; i < p->n; i++) {
    if (is_given(A, i)) s->mu[i] = 1e100;
    for (int d = 0; d < 3; d++) s->v4[4 * (size_t) i + d] = 0.0;
  }
  for (int i = 0; i < A->n; i++) {
    const double rest = A->m[i] / A->tau, inv_h = sd_sph_of_pair(A->model, p, i, i)->inv_h;
    s->diagonal[i] = is_given(A, i) ? 1.0
        : rest + A->m[i] * form * 8.0 * p->mu[i] * inv_h * inv_h / p->v4[4 * (size_t) i + 3];
  }
}

sd_status sd_sph_rub_implicitly(const sd_sph_implicit *A, const double *v, const double *u, double *F,
                                double *more, double *work, int *steps)
{
  const size_t size = 3 * (size_t) A->n, all = (size_t) (A->particles->n + 1);
  double *y = work + 5 * all, *r = y + 3 * size;
  rubbing s = {.A = A, .v4 = work, .f4 = more, .mu = work + 4 * all, .diagonal = y + 5 * size};
  rub_prepare(&s);
  memset(y, 0, sizeof(double) * size);
  for (size_t k = 0; k < size; k++)
    r[k] = is_given(A, (int) (k / 3)) ? 0.0 : F[k] + A->m[k / 3] / A->tau * (v[k] - u[k]);
  const sd_cg_vectors vectors = {y, y + size, y + 2 * size, r, y + 4 * size};
  const sd_cg cg = {.size = (long) size, .paired = (long) size, .ctx = &s, .apply = rub_apply,
                    .precondition = rub_precondition, .judge = rub_judge, .world = A->world};
  sd_cg_state state;
  const sd_status status = sd_cg_run(&cg, &vectors, &state);
  *steps = state.steps;
  if (status != SD_OK) return status;
  rub(&s, y);
  for (size_t k = 0; k < size; k++) F[k] += more[4 * (k / 3) + k % 3];
  return SD_OK;
}
