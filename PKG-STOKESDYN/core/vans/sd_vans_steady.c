#include "sd_vans_steady.h"

#include <math.h>

void sd_vans_series_add(sd_vans_series *series, const double sample[SD_VANS_SERIES])
{
  if (series->length == 0.0) series->length = 1.0;
  for (int k = 0; k < SD_VANS_SERIES; k++) series->sum[k] += sample[k];
  series->filled += 1.0;
  if (series->filled < series->length) return;
  const int n = (int) series->blocks;
  for (int k = 0; k < SD_VANS_SERIES; k++) {
    series->block[k][n] = series->sum[k] / series->length;
    series->sum[k] = 0.0;
  }
  series->filled = 0.0;
  series->blocks += 1.0;
  if (n + 1 < SD_VANS_BLOCKS) return;
  for (int k = 0; k < SD_VANS_SERIES; k++)
    for (int i = 0; i < SD_VANS_BLOCKS / 2; i++)
      series->block[k][i] = 0.5 * (series->block[k][2 * i] + series->block[k][2 * i + 1]);
  series->blocks = SD_VANS_BLOCKS / 2;
  series->length *= 2.0;
}

static double steady_mean_of(const double *x, int n)
{
  double sum = 0.0;
  for (int i = 0; i < n; i++) sum += x[i];
  return sum / n;
}

/* Sum of the squares about the mean of means over `together` blocks, counted from the end; how many
 * such means there are. */
static double squares(const double *x, int n, int together, int *count)
{
  const int m = n / together;
  const double *from = x + n - m * together, mean = steady_mean_of(from, m * together);
  double sum = 0.0;
  for (int i = 0; i < m; i++) {
    const double d = steady_mean_of(from + i * together, together) - mean;
    sum += d * d;
  }
  *count = m;
  return sum;
}

/* The number of blocks at the start that belong to the way there. */
static int start_of_steady(const double *x, int n)
{
  int best = 0;
  double least = INFINITY;
  for (int cut = 0; 4 * cut <= 3 * n; cut++) {
    int count;
    const double sum = squares(x + cut, n - cut, 1, &count), value = sum / ((double) count * count);
    if (value < least) {
      least = value;
      best = cut;
    }
  }
  return best;
}

int sd_vans_series_mean(const sd_vans_series *series, int which, double *mean, double *error)
{
  const int n = (int) series->blocks;
  const double *x = series->block[which];
  *mean = *error = 0.0;
  if (n == 0) return 0;
  const int cut = start_of_steady(x, n), left = n - cut;
  *mean = steady_mean_of(x + cut, left);
  if (n < 16 || 2 * cut > n) {
    double low = x[0], high = x[0];
    for (int i = 1; i < n; i++) {
      low = fmin(low, x[i]);
      high = fmax(high, x[i]);
    }
    *error = fmax(fabs(*mean), high - low);
    return 0;
  }
  *error = 0.5 * fabs(steady_mean_of(x + cut, left / 2) - steady_mean_of(x + cut + left / 2, left - left / 2));
  for (int together = 1; together <= 4; together *= 2) {
    int count;
    const double sum = squares(x + cut, left, together, &count);
    if (count > 1) *error = fmax(*error, sqrt(sum / (count * (count - 1.0))));
  }
  return 1;
}
