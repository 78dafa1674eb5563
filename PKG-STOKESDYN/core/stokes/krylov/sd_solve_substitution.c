/* Algorithm 1 of sd_solve.h */
#include "sd_solve_internal.h"

#include <math.h>

/* A residual that falls by less than this, relative, never gets there: the ratio of two successive
 * ones can only grow. */
static const double hardly_falls = 1e-9;
/* Residuals of this size are rounding, whatever the tolerance. */
static const double rounding_level = 1e-13;

/* F^(k+1) - F^k = D (s - Omega F^k) - F^k = D (s - M F^k): the correction is the scaled residual
 * itself, and its next value is -D Omega times this one. */
sd_status sd_solve_substitution(const sd_system *A, const double *slip, double tolerance,
                                int max_iter, double *F, double *work, sd_solve_report *report)
{
  const long size = (long) sd_solve_width(A) * A->n;
  double *residual = work, last = INFINITY;
  sd_solve_squares rhs, now;
  *report = (sd_solve_report){0};
  sd_status status = sd_solve_free_draining(A, slip, F, &rhs);
  if (status != SD_OK) return status;
  if (!isfinite(rhs.plain)) return SD_ENOTFINITE;
  if (rhs.plain == 0.0) return SD_OK;

  for (int k = 0;; k++) {
    if ((status = A->apply(A->apply_ctx, F, residual)) != SD_OK) return status;
    report->products++;
    if ((status = sd_solve_residual(A, slip, F, residual, &now)) != SD_OK) return status;
    report->iterations = k;
    report->residual = sqrt(now.plain / rhs.plain);
    report->growth = k > 0 && last > 0.0 ? sqrt(now.natural / last) : 0.0;
    if (!isfinite(now.plain)) return SD_ENOTFINITE;
    if (report->residual <= tolerance) return SD_OK;
    if (report->growth > 1.0 - hardly_falls)
      return report->residual < rounding_level ? SD_ESTAGNATED : SD_EDIVERGED;
    if (k == max_iter) return SD_EMAXITER;
    for (long j = 0; j < size; j++) F[j] += residual[j];
    last = now.natural;
  }
}
