/* cmocka with the few helpers that every core test needs. */
#ifndef CHECK_H
#define CHECK_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>
#include <math.h>

#define CHECK_NEAR(value, expected, tolerance)                                             \
  do {                                                                                     \
    const double v_ = (value), e_ = (expected), t_ = (tolerance);                          \
    if (!(fabs(v_ - e_) <= t_))                                                            \
      fail_msg("%s = %.17g, expected %.17g within %.2g (off by %.2g)", #value, v_, e_, t_, \
               v_ - e_);                                                                   \
  } while (0)

/* How much a test goes through: with sanitizers, and where kernels are not optimized, which take several
 * times as long, as much as leads through the same code */
#ifdef SD_SMALL
#define CHECK_SIZE(whole, small) (small)
#else
#define CHECK_SIZE(whole, small) (whole)
#endif

/* Uniform in (lo, hi), the same on every machine. */
static inline double uniform(uint64_t *seed, double lo, double hi)
{
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return lo + (hi - lo) * ((double) (*seed >> 11) + 0.5) / 9007199254740992.0;
}

/* Is the symmetric n x n matrix A, less shift times unity, positive definite? Destroys A. */
static inline int positive_definite(double *A, int n, double shift)
{
  for (int i = 0; i < n; i++) A[i * n + i] -= shift;
  for (int k = 0; k < n; k++) {
    if (!(A[k * n + k] > 0.0)) return 0;
    const double root = sqrt(A[k * n + k]);
    for (int i = k; i < n; i++) A[i * n + k] /= root;
    for (int j = k + 1; j < n; j++)
      for (int i = j; i < n; i++) A[i * n + j] -= A[i * n + k] * A[j * n + k];
  }
  return 1;
}

#endif
