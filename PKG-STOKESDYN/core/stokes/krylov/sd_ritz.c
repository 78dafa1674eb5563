#include "sd_ritz.h"

#include <math.h>

/* Conjugate gradients are Lanczos's process on the same vectors: the matrix, seen from the span of
 * the first residuals normalised, is tridiagonal (Golub & Van Loan, Matrix Computations),
 *
 *   T_kk = 1/alpha_k + beta_(k-1)/alpha_(k-1),   T_k,k+1 = sqrt(beta_k)/alpha_k
 *
 * and its eigenvalues are the Ritz values. */

void sd_ritz_add(sd_ritz *r, double alpha, double beta)
{
  if (r->count == SD_RITZ_KEPT) return;
  r->alpha[r->count] = alpha;
  r->beta[r->count++] = beta;
}

/* How many eigenvalues are below value: as many as there are negative pivots in the elimination of
 * T - value (Sylvester). Pivot k is T_kk - value - T_(k-1),k^2 / pivot k-1; one that is zero
 * counts as just below. */
static int below(const sd_ritz *r, double value)
{
  int count = 0;
  double pivot = 1.0;
  for (int k = 0; k < r->count; k++) {
    double d = 1.0 / r->alpha[k] - value;
    if (k > 0) {
      const double last = 1.0 / r->alpha[k - 1], b = r->beta[k - 1];
      d += b * last - b * last * last / pivot;
    }
    if (d == 0.0) d = -1e-300;
    count += d < 0.0;
    pivot = d;
  }
  return count;
}

/* Smallest value with more than `under` eigenvalues below it. All lie between 0 and `highest`. */
static double bisect(const sd_ritz *r, int under, double highest)
{
  double low = 0.0, high = highest;
  while (high - low > 1e-6 * high && high > 1e-14 * highest) {
    const double middle = 0.5 * (low + high);
    if (below(r, middle) > under)
      high = middle;
    else
      low = middle;
  }
  return high;
}

void sd_ritz_extremes(const sd_ritz *r, double *smallest, double *largest)
{
  double highest = 0.0;
  *smallest = *largest = 0.0;
  if (r->count == 0) return;
  /* No eigenvalue lies above the largest sum of a row (Gershgorin). */
  for (int k = 0; k < r->count; k++) {
    double disc = 1.0 / r->alpha[k];
    if (k > 0) disc += (r->beta[k - 1] + sqrt(r->beta[k - 1])) / r->alpha[k - 1];
    if (k + 1 < r->count) disc += sqrt(r->beta[k]) / r->alpha[k];
    highest = fmax(highest, disc);
  }
  if (!isfinite(highest)) return;
  *smallest = bisect(r, 0, highest * (1.0 + 1e-12));
  *largest = bisect(r, r->count - 1, highest * (1.0 + 1e-12));
}
