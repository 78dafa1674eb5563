#include "sd_constants.h"
#include "sd_vans_grains.h"

#include <math.h>

int sd_vans_class_of(const sd_vans_averaging *how, double a)
{
  if (!how->class_limit) {
    for (int c = 0; c < how->nclass; c++)
      if (how->class_radius[c] == a) return c;
    return -1;
  }
  int lowest = 0, highest = how->nclass - 1; /* the class is one of these */
  while (lowest < highest) {
    const int middle = (lowest + highest + 1) / 2;
    if (a < how->class_limit[middle])
      highest = middle - 1;
    else
      lowest = middle;
  }
  return lowest;
}

void sd_vans_bins(double lo, double hi, int n, double *limit)
{
  for (int c = 0; c < n; c++) limit[c] = lo * pow(hi / lo, (double) c / n);
  limit[n] = hi;
}

void sd_vans_class_sums(const sd_vans_averaging *how, const sd_vans_grains *grains, double *sums)
{
  for (int i = 0; i < grains->n; i++) {
    const double a = grains->a[i];
    const int c = grains->take && !grains->take[i] ? -1 : sd_vans_class_of(how, a);
    if (c < 0) continue;
    sums[2 * c] += a * a * a;
    sums[2 * c + 1] += a * a;
  }
}

void sd_vans_class_means(int nclass, const double *limit, const double *sums, double *radius,
                         double *volume)
{
  for (int c = 0; c < nclass; c++) {
    const double a3 = sums[2 * c], a2 = sums[2 * c + 1];
    radius[c] = a2 > 0.0 ? a3 / a2 : sqrt(limit[c] * limit[c + 1]);
    volume[c] = 4.0 / 3.0 * SD_PI * a3;
  }
}
