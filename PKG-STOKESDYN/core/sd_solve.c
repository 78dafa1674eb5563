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
static void scaled_residual(const sd_system *A, const double *slip, const double *F, double *out,
                            double *plain, double *natural)
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

sd_status sd_solve_substitution(const sd_system *A, const double *slip, double tolerance,
                                int max_iter, double *F, double *work, sd_solve_report *report)
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
    if (report->growth > 1.0)
      return report->residual < rounding_level ? SD_ESTAGNATED : SD_EDIVERGED;
    if (k == max_iter) return SD_EMAXITER;
    for (int j = 0; j < 3 * A->n; j++)
      F[j] += res[j]; /* F^(k+1) - F^k is the scaled residual itself */
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

sd_status sd_solve_gradients(const sd_system *A, const double *slip, double tolerance, int max_iter,
                             double *F, double *work, sd_solve_report *report)
{
  /* x, z: iterate and scaled residual D (s - M x) of conjugate gradients; F, y: the same after smoothing. */
  const int n3 = 3 * A->n;
  const size_t bytes = sizeof(double) * (size_t) n3;
  double *x = work, *z = x + n3, *y = z + n3, *p = y + n3, *q = p + n3;
  double plain, natural, verified = INFINITY;
  *report = (sd_solve_report){.curvature = 1.0};
  const double rhs = free_draining(A, slip, y);
  if (!isfinite(rhs)) return SD_ENOTFINITE;
  memset(F, 0, bytes);
  if (rhs == 0.0) return SD_OK;
  memset(y, 0, bytes); /* Omega F for F = 0 */
  scaled_residual(A, slip, F, y, &plain, &natural);

  for (;;) {
    memcpy(x, F, bytes);
    memcpy(z, y, bytes);
    memcpy(p, y, bytes);
    for (report->residual = sqrt(plain / rhs);
         report->residual > tolerance && natural > 0.0 && report->iterations < max_iter;) {
      double pMp, pDp;
      apply_matrix(A, p, q, &pMp, &pDp);
      if (!isfinite(pMp)) return SD_ENOTFINITE;
      report->curvature = fmin(report->curvature, pMp / pDp);
      if (fabs(pMp) <= singular_below * pDp) return SD_ESINGULAR;
      if (pMp < 0.0) return SD_EINDEFINITE;
      report->iterations++;

      const double alpha = natural / pMp, last = natural;
      double v[3] = {0.0, 0.0, 0.0}; /* z.D^-1 z,  z.z,  y.z */
      for (int i = 0; i < A->n; i++) {
        const double D = A->drag[i];
        if (D == 0.0) continue;
        double zz = 0.0;
        for (int k = 3 * i; k < 3 * i + 3; k++) {
          x[k] += alpha * p[k];
          z[k] -= alpha * D * q[k];
          zz += z[k] * z[k];
          v[2] += y[k] * z[k];
        }
        v[0] += zz / D;
        v[1] += zz;
      }
      sum(A, v, 3);
      natural = v[0];
      const double beta = natural / last, zz = v[1], yz = v[2];
      const double ee = plain - 2.0 * yz + zz; /* |y - z|^2 */
      const double theta = ee > 0.0 ? (plain - yz) / ee : 1.0;
      plain = ee > 0.0 ? (plain * zz - yz * yz) / ee
                       : zz; /* |y + theta (z - y)|^2, without loss when z << y */
      for (int k = 0; k < n3; k++) {
        p[k] = z[k] + beta * p[k];
        y[k] += theta * (z[k] - y[k]);
        F[k] += theta * (x[k] - F[k]);
      }
      report->residual = sqrt(fmax(plain, 0.0) / rhs);
    }
    A->apply(A->apply_ctx, F, y);
    scaled_residual(A, slip, F, y, &plain, &natural);
    report->residual = sqrt(plain / rhs);
    if (!isfinite(plain)) return SD_ENOTFINITE;
    if (report->residual <= tolerance) return SD_OK;
    if (report->iterations >= max_iter) return SD_EMAXITER;
    if (report->residual > 0.5 * verified) return SD_ESTAGNATED;
    verified = report->residual;
  }
}
