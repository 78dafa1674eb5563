#include "sd_cg.h"

#include <math.h>
#include <string.h>

static double cg_dot(long n, const double *a, const double *b)
{
  double sum = 0.0;
  for (long j = 0; j < n; j++) sum += a[j] * b[j];
  return sum;
}

/* z = P r, with the sums that are about it; beta */
static sd_status cg_look(const sd_cg *A, const sd_cg_vectors *v, sd_cg_state *now)
{
  double s[2 + SD_CG_OWN] = {0.0};
  sd_status status = A->precondition(A->ctx, v->r, v->z);
  if (status != SD_OK) return status;
  s[0] = cg_dot(A->paired, v->r, v->z);
  if (now->steps > 0) s[1] = cg_dot(A->paired, v->w, v->z);
  if (A->measure) A->measure(A->ctx, v, s + 2);
  if ((status = sd_world_sum(A->world, s, 2 + SD_CG_OWN)) != SD_OK) return status;
  for (int k = 0; k < 2 + SD_CG_OWN; k++)
    if (!isfinite(s[k])) return SD_ENOTFINITE;
  now->rz = s[0];
  now->beta = now->steps > 0 ? -s[1] / now->pw : 0.0;
  memcpy(now->own, s + 2, sizeof(now->own));
  return SD_OK;
}

/* w = A p; is there a step along p? */
static sd_status find_curvature(const sd_cg *A, const sd_cg_vectors *v, sd_cg_state *now)
{
  sd_status status = A->apply(A->ctx, v->p, v->w);
  if (status != SD_OK) return status;
  double s[3] = {cg_dot(A->paired, v->p, v->w), cg_dot(A->paired, v->r, v->p),
                 A->square ? A->square(A->ctx, v->p) : 0.0};
  if ((status = sd_world_sum(A->world, s, 3)) != SD_OK) return status;
  now->pw = s[0];
  now->rp = s[1];
  now->pp = s[2];
  if (!isfinite(s[0]) || !isfinite(s[1])) return SD_ENOTFINITE;
  if (now->pw > SD_CG_SINGULAR * now->pp) return SD_OK;
  return now->pw < -SD_CG_SINGULAR * now->pp ? SD_EINDEFINITE : SD_ESINGULAR;
}

sd_status sd_cg_run(const sd_cg *A, const sd_cg_vectors *v, sd_cg_state *now)
{
  *now = (sd_cg_state){.steps = 0};
  memset(v->p, 0, sizeof(double) * (size_t) A->size);
  for (;; now->steps++) {
    int done = 0;
    sd_status status = cg_look(A, v, now);
    if (status == SD_OK) status = A->judge(A->ctx, now, &done);
    if (status != SD_OK || done) return status;
    for (long j = 0; j < A->size; j++) v->p[j] = v->z[j] + now->beta * v->p[j];
    if ((status = find_curvature(A, v, now)) != SD_OK) return status;
    now->alpha = now->rp / now->pw;
    for (long j = 0; j < A->size; j++) v->x[j] += now->alpha * v->p[j];
    for (long j = 0; j < A->paired; j++) v->r[j] -= now->alpha * v->w[j];
  }
}
