#include "sd_solve.h"

#include <math.h>
#include <string.h>

/* Rayleigh quotients of the unit-diagonal matrix below this are rounding (its entries are at most 1). */
static const double singular_below = 1e-13;
/* Residuals of this size are rounding, whatever the tolerance. */
static const double rounding_level = 1e-13;

static void sum(const sd_system *A, double *values, int count)
{
  if (A->sum) A->sum(A->sum_ctx, values, count);
}

/* out = D (slip - M F), given Omega F in out: D slip - F - D Omega F. Sums of squares: all plain, natural over D. */
static void scaled_residual(const sd_system *A, const double *slip, const double *F, double *out, double *plain, double *natural)
{
  double sq = 0.0, nat = 0.0;
  for (int i = 0; i < A->n; i++) {
    const double D = A->drag[i];
    if (D == 0.0) {
      out[3 * i] = out[3 * i + 1] = out[3 * i + 2] = 0.0;
      continue;
    }
    double s = 0.0;
    for (int k = 3 * i; k < 3 * i + 3; k++) {
      out[k] = D * (slip[k] - out[k]) - F[k];
      s += out[k] * out[k];
    }
    sq += s;
    nat += s / D;
  }
  double v[2] = {sq, nat};
  sum(A, v, 2);
  *plain = v[0];
  *natural = v[1];
}

/* F = D slip, the drag of spheres that do not see each other; returns |D slip|^2. */
static double free_draining(const sd_system *A, const double *slip, double *F)
{
  double sq = 0.0;
  for (int i = 0; i < A->n; i++)
    for (int k = 3 * i; k < 3 * i + 3; k++) {
      F[k] = A->drag[i] == 0.0 ? 0.0 : A->drag[i] * slip[k];
      sq += F[k] * F[k];
    }
  sum(A, &sq, 1);
  return sq;
}

sd_status sd_solve_substitution(const sd_system *A, const double *slip, double tolerance, int max_iter, double *F, double *work,
                                sd_solve_report *report)
{
  double *res = work, last = INFINITY;
  *report = (sd_solve_report){0};
  const double rhs = free_draining(A, slip, F);
  if (!isfinite(rhs)) return SD_ENOTFINITE;
  if (rhs == 0.0) return SD_OK;

  for (int k = 0;; k++) {
    double plain, natural;
    A->apply(A->apply_ctx, F, res);
    scaled_residual(A, slip, F, res, &plain, &natural);
    report->iterations = k;
    report->residual = sqrt(plain / rhs);
    report->growth = k > 0 && last > 0.0 ? sqrt(natural / last) : 0.0;
    if (!isfinite(plain)) return SD_ENOTFINITE;
    if (report->residual <= tolerance) return SD_OK;
    if (report->growth > 1.0) return report->residual < rounding_level ? SD_ESTAGNATED : SD_EDIVERGED;
    if (k == max_iter) return SD_EMAXITER;
    for (int j = 0; j < 3 * A->n; j++) F[j] += res[j];          /* F^(k+1) - F^k is the scaled residual itself */
    last = natural;
  }
}

/* q = M p; returns p.Mp and p.D^-1 p */
static void apply_matrix(const sd_system *A, const double *p, double *q, double *pMp, double *pDp)
{
  double v[2] = {0.0, 0.0};
  A->apply(A->apply_ctx, p, q);
  for (int i = 0; i < A->n; i++) {
    if (A->drag[i] == 0.0) {
      q[3 * i] = q[3 * i + 1] = q[3 * i + 2] = 0.0;
      continue;
    }
    const double inv = 1.0 / A->drag[i];
    for (int k = 3 * i; k < 3 * i + 3; k++) {
      const double own = inv * p[k];
      q[k] += own;
      v[0] += p[k] * q[k];
      v[1] += p[k] * own;
    }
  }
  sum(A, v, 2);
  *pMp = v[0];
  *pDp = v[1];
}

sd_status sd_solve_gradients(const sd_system *A, const double *slip, double tolerance, int max_iter, double *F, double *work,
                             sd_solve_report *report)
{
  const int n3 = 3 * A->n;
  double *z = work, *p = z + n3, *q = p + n3;                    /* z = D r, the preconditioned residual */
  double plain, natural, verified = INFINITY;
  *report = (sd_solve_report){.curvature = 1.0};
  const double rhs = free_draining(A, slip, z);
  if (!isfinite(rhs)) return SD_ENOTFINITE;
  memset(F, 0, sizeof(double) * (size_t) n3);
  if (rhs == 0.0) return SD_OK;
  memset(q, 0, sizeof(double) * (size_t) n3);
  scaled_residual(A, slip, F, q, &plain, &natural);              /* F = 0: only the norms are new */

  for (;;) {
    /* r.z = |D r|^2 over D: the natural norm of the scaled residual */
    memcpy(p, z, sizeof(double) * (size_t) n3);
    for (report->residual = sqrt(plain / rhs); report->residual > tolerance && report->iterations < max_iter;) {
      double pMp, pDp;
      apply_matrix(A, p, q, &pMp, &pDp);
      if (!isfinite(pMp)) return SD_ENOTFINITE;
      report->curvature = fmin(report->curvature, pMp / pDp);
      if (fabs(pMp) <= singular_below * pDp) return SD_ESINGULAR;
      if (pMp < 0.0) return SD_EINDEFINITE;
      report->iterations++;

      const double alpha = natural / pMp, last = natural;
      double v[2] = {0.0, 0.0};
      for (int i = 0; i < A->n; i++) {
        const double D = A->drag[i];
        if (D == 0.0) continue;
        double s = 0.0;
        for (int k = 3 * i; k < 3 * i + 3; k++) {
          F[k] += alpha * p[k];
          z[k] -= alpha * D * q[k];
          s += z[k] * z[k];
        }
        v[0] += s;
        v[1] += s / D;
      }
      sum(A, v, 2);
      plain = v[0];
      natural = v[1];
      report->residual = sqrt(plain / rhs);
      const double beta = natural / last;
      for (int k = 0; k < n3; k++) p[k] = z[k] + beta * p[k];
    }
    A->apply(A->apply_ctx, F, z);
    scaled_residual(A, slip, F, z, &plain, &natural);
    report->residual = sqrt(plain / rhs);
    if (!isfinite(plain)) return SD_ENOTFINITE;
    if (report->residual <= tolerance) return SD_OK;
    if (report->iterations >= max_iter) return SD_EMAXITER;
    if (report->residual > 0.5 * verified) return SD_ESTAGNATED;
    verified = report->residual;
  }
}
