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

static int width(const sd_system *A)
{
  return A->spin ? 6 : 3;
}

/* v.D^-1 w of sphere i: of scaled residuals, which are forces and torques. Times D of its force: their product in forces alone. */
static double natural_product(const sd_system *A, int i, const double *v, const double *w)
{
  double s = (v[0] * w[0] + v[1] * w[1] + v[2] * w[2]) / A->drag[i];
  if (A->spin) s += (v[3] * w[3] + v[4] * w[4] + v[5] * w[5]) / A->spin[i];
  return s;
}

/* Row k of sphere i: its entry of D */
static double scale(const sd_system *A, int i, int k)
{
  return k < 3 ? A->drag[i] : A->spin[i];
}

/* out = D (slip - M F), given Omega F in out: D slip - F - D Omega F. Squares: plain in forces, natural over D. */
static void scaled_residual(const sd_system *A, const double *slip, const double *F, double *out,
                            double *plain, double *natural)
{
  const int m = width(A);
  double v[2] = {0.0, 0.0};
  for (int i = 0; i < A->n; i++) {
    double *o = out + (long) m * i;
    for (int k = 0; k < m; k++)
      o[k] = A->drag[i] == 0.0
          ? 0.0
          : scale(A, i, k) * (slip[(long) m * i + k] - o[k]) - F[(long) m * i + k];
    if (A->drag[i] == 0.0) continue;
    const double nat = natural_product(A, i, o, o);
    v[0] += A->drag[i] * nat;
    v[1] += nat;
  }
  sum(A, v, 2);
  *plain = v[0];
  *natural = v[1];
}

/* F = D slip, the drag of spheres that do not see each other; returns |D slip|^2. */
static double free_draining(const sd_system *A, const double *slip, double *F)
{
  const int m = width(A);
  double sq = 0.0;
  for (int i = 0; i < A->n; i++) {
    double *f = F + (long) m * i;
    for (int k = 0; k < m; k++)
      f[k] = A->drag[i] == 0.0 ? 0.0 : scale(A, i, k) * slip[(long) m * i + k];
    if (A->drag[i] != 0.0) sq += A->drag[i] * natural_product(A, i, f, f);
  }
  sum(A, &sq, 1);
  return sq;
}

sd_status sd_solve_substitution(const sd_system *A, const double *slip, double tolerance,
                                int max_iter, double *F, double *work, sd_solve_report *report)
{
  double *res = work, last = INFINITY;
  const long size = (long) width(A) * A->n;
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
    for (long j = 0; j < size; j++)
      F[j] += res[j]; /* F^(k+1) - F^k is the scaled residual itself */
    last = natural;
  }
}

/* q = M p; returns p.Mp and p.D^-1 p */
static void apply_matrix(const sd_system *A, const double *p, double *q, double *pMp, double *pDp)
{
  const int m = width(A);
  double v[2] = {0.0, 0.0};
  A->apply(A->apply_ctx, p, q);
  for (int i = 0; i < A->n; i++) {
    const double *pi = p + (long) m * i;
    double *qi = q + (long) m * i;
    for (int k = 0; k < m; k++) {
      if (A->drag[i] == 0.0) {
        qi[k] = 0.0;
        continue;
      }
      const double own = pi[k] / scale(A, i, k);
      qi[k] += own;
      v[0] += pi[k] * qi[k];
      v[1] += pi[k] * own;
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
  const int m = width(A);
  const long size = (long) m * A->n;
  const size_t bytes = sizeof(double) * (size_t) size;
  double *x = work, *z = x + size, *y = z + size, *p = y + size, *q = p + size;
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
    report->residual = sqrt(plain / rhs);
    while (report->residual > tolerance && natural > 0.0 && report->iterations < max_iter) {
      double pMp, pDp;
      apply_matrix(A, p, q, &pMp, &pDp);
      if (!isfinite(pMp)) return SD_ENOTFINITE;
      report->curvature = fmin(report->curvature, pMp / pDp);
      if (fabs(pMp) <= singular_below * pDp) return SD_ESINGULAR;
      if (pMp < 0.0) return SD_EINDEFINITE;
      report->iterations++;

      const double alpha = natural / pMp, last = natural;
      double v[3] = {0.0, 0.0, 0.0}; /* z.D^-1 z; in forces: z.z, y.z */
      for (int i = 0; i < A->n; i++) {
        if (A->drag[i] == 0.0) continue;
        double *zi = z + (long) m * i;
        for (int k = 0; k < m; k++) {
          x[(long) m * i + k] += alpha * p[(long) m * i + k];
          zi[k] -= alpha * scale(A, i, k) * q[(long) m * i + k];
        }
        const double nat = natural_product(A, i, zi, zi);
        v[0] += nat;
        v[1] += A->drag[i] * nat;
        v[2] += A->drag[i] * natural_product(A, i, y + (long) m * i, zi);
      }
      sum(A, v, 3);
      natural = v[0];
      const double beta = natural / last, zz = v[1], yz = v[2];
      const double ee = plain - 2.0 * yz + zz; /* |y - z|^2 */
      const double theta = ee > 0.0 ? (plain - yz) / ee : 1.0;
      /* |y + theta (z - y)|^2, without loss when z << y */
      plain = ee > 0.0 ? (plain * zz - yz * yz) / ee : zz;
      for (long k = 0; k < size; k++) {
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
