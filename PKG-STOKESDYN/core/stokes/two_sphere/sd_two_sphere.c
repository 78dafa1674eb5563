#include "sd_two_sphere.h"

#include <stdlib.h>

#include "sd_two_sphere_exact.h"

struct sd_two_sphere {
  double largest_ratio;
};

sd_status sd_two_sphere_create(double largest_ratio, sd_two_sphere **out)
{
  *out = NULL;
  if (!(largest_ratio <= 100.0)) return SD_EOUTSIDE;
  sd_two_sphere *t = malloc(sizeof *t);
  if (!t) return SD_ENOMEMORY;
  t->largest_ratio = largest_ratio;
  *out = t;
  return SD_OK;
}

void sd_two_sphere_free(sd_two_sphere *t)
{
  free(t);
}

sd_status sd_two_sphere_correction(const sd_two_sphere *t, double a1, double a2, double xi,
                                   sd_pair_resistance *full, sd_pair_resistance *relative)
{
  const double ratio = a1 > a2 ? a1 / a2 : a2 / a1;
  if (!(ratio <= t->largest_ratio * (1.0 + 1e-12)) || !(xi > 0.0)) return SD_EOUTSIDE;
  const double gap = xi * 0.5 * (a1 + a2), distance = a1 + a2 + gap;
  const sd_pair_resistance exact = sd_two_sphere_exact(a1, a2, gap, NULL);
  const sd_pair_resistance rpy = sd_pair_resistance_rpy(a1, a2, distance);
  *full = sd_pair_resistance_sum(1.0, &exact, -1.0, &rpy);
  *relative = sd_pair_resistance_relative(full, a1, a2, distance);
  return SD_OK;
}
