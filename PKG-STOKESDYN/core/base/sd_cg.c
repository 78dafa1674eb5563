#include "sd_cg.h"

#include <math.h>
#include <string.h>

/* a.b and a.c: each in parts that do not wait for each other, and a is read once */
static void cg_dots(long n, const double *a, const double *b, const double *c, double out[2])
{
  enum { PARTS = 8 };
  double with_b[PARTS] = {0.0}, with_c[PARTS] = {0.0};
  long j = 0;
  for (; j + PARTS <= n; j += PARTS)
    for (int k = 0; k < PARTS; k++) {
      with_b[k] += a[j + k] * b[j + k];
      with_c[k] += a[j + k] * c[j + k];
    }
  for (; j < n; j++) {
    with_b[0] += a[j] * b[j];
    with_c[0] += a[j] * c[j];
  }
  out[0] = out[1] = 0.0;
  for (int k = 0; k < PARTS; k++) {
    out[0] += with_b[k];
    out[1] += with_c[k];
  }
}

/* z = P r, with the sums that are about it; beta */
static sd_status cg_look(const sd_cg *A, const sd_cg_vectors *v, sd_cg_state *now)
{
  double s[2 + SD_CG_OWN] = {0.0};
  sd_status status = A->precondition(A->ctx, v->r, v->z);
  if (status != SD_OK) return status;
  cg_dots(A->paired, v->z, v->r, now->steps > 0 ? v->w : v->r, s); /* before the first step there is no w */
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
  double s[3];
  cg_dots(A->paired, v->p, v->w, v->r, s);
  s[2] = A->square ? A->square(A->ctx, v->p) : 0.0;
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
  for (;; now->steps++) {
    int done = 0;
    sd_status status = cg_look(A, v, now);
    if (status == SD_OK) status = A->judge(A->ctx, now, &done);
    if (status != SD_OK || done) return status;
    if (now->steps == 0) memcpy(v->p, v->z, sizeof(double) * (size_t) A->size);
    else
      for (long j = 0; j < A->size; j++) v->p[j] = v->z[j] + now->beta * v->p[j];
    if ((status = find_curvature(A, v, now)) != SD_OK) return status;
    now->alpha = now->rp / now->pw;
    for (long j = 0; j < A->size; j++) v->x[j] += now->alpha * v->p[j];
    for (long j = 0; j < A->paired; j++) v->r[j] -= now->alpha * v->w[j];
  }
}
