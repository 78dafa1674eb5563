#include "sd_chebyshev.h"

#include <math.h>
#include <string.h>

/* cos(pi m/(2n)), which has the period 4n */
static long double wave(int m, int n)
{
  return cosl(acosl(-1.0L) * m / (2 * n));
}

long double sd_chebyshev_node(int s, int n)
{
  return wave(2 * s + 1, n);
}

void sd_chebyshev_series(const long double *sample, int n, long double *series)
{
  long double waves[4 * SD_CHEBYSHEV_MOST];
  for (int m = 0; m < 4 * n; m++) waves[m] = wave(m, n);
  for (int k = 0; k < n; k++) {
    long double sum = 0.0L;
    for (int s = 0; s < n; s++) sum += sample[s] * waves[k * (2 * s + 1) % (4 * n)];
    series[k] = sum * (k == 0 ? 1.0L : 2.0L) / n;
  }
}

/* T_0 = 1, T_1 = t, T_k = 2 t T_k-1 - T_k-2 */
void sd_chebyshev_powers(const long double *series, int degree, double *coefficient)
{
  long double before[SD_CHEBYSHEV_MOST + 1] = {0.0L}, now[SD_CHEBYSHEV_MOST + 1] = {1.0L};
  long double sum[SD_CHEBYSHEV_MOST] = {0.0L};
  for (int k = 0; k <= degree; k++) {
    for (int m = 0; m <= k; m++) sum[m] += series[k] * now[m];
    long double next[SD_CHEBYSHEV_MOST + 1] = {0.0L};
    for (int m = 0; m <= k; m++) next[m + 1] = (k == 0 ? 1.0L : 2.0L) * now[m];
    for (int m = 0; m < k; m++) next[m] -= before[m];
    memcpy(before, now, sizeof(now));
    memcpy(now, next, sizeof(next));
  }
  for (int m = 0; m <= degree; m++) coefficient[m] = (double) sum[m];
}
