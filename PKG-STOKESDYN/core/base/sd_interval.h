/* Where a number lies among edges that grow. */
#ifndef SD_INTERVAL_H
#define SD_INTERVAL_H

/* k of 0 .. n - 1 with edge[k] <= x < edge[k + 1], of n intervals, n >= 1, by halving. Below edge[1] it is 0,
 * from edge[n - 1] on n - 1. */
static inline int sd_interval(const double *edge, int n, double x)
{
  int low = 0, high = n;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    if (edge[middle] <= x)
      low = middle;
    else
      high = middle;
  }
  return low;
}

#endif
