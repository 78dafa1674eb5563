#include "sd_dense_internal.h"
#include "sd_lanes.h"

/* Sums that stay in registers: five vectors of eight hold a shell of twelve points. */
enum { VECTORS = 5 };

/* Where vector v of those from i on begins: the last ones may overlap, so that all are whole. n >= LANES */
INLINE long begin_of(long n, long i, int v)
{
  const long at = i + v * LANES;
  return at + LANES <= n ? at : n - LANES;
}

INLINE void some_rows(long n, long i, const double *A, const double *y, double *out)
{
  vec sum[VECTORS];
  long at[VECTORS];
#pragma GCC unroll 5
  for (int v = 0; v < VECTORS; v++) {
    at[v] = begin_of(n, i, v);
    sum[v] = all(0.0);
  }
  for (long j = 0; j < n; j++) {
    const vec f = all(y[j]);
#pragma GCC unroll 5
    for (int v = 0; v < VECTORS; v++) sum[v] += load_any(A + n * j + at[v]) * f;
  }
#pragma GCC unroll 5
  for (int v = 0; v < VECTORS; v++) store_any(out + at[v], sum[v]);
}

/* Of matrices too small for a vector, or so large that rows are best read from memory as they stand */
static void row_by_row(long n, const double *A, const double *y, double *out)
{
  for (long i = 0; i < n; i++) out[i] = 0.0;
  for (long j = 0; j < n; j++)
    for (long i = 0; i < n; i++) out[i] += A[n * j + i] * y[j];
}

static void dense_times(long n, const double *A, const double *y, double *out)
{
  enum { LARGE = 256 };
  if (n < LANES || n > LARGE) {
    row_by_row(n, A, y, out);
    return;
  }
  for (long i = 0; i < n; i += VECTORS * LANES) some_rows(n, i, A, y, out);
}

const struct sd_dense_kernels SD_KERNELS(sd_dense) = {dense_times};
