#include <math.h>

#include "sd_constants.h"
#include "sd_two_sphere_table_internal.h"

double sd_two_sphere_node(int n, int k)
{
  return 0.5 + 0.5 * cos(SD_PI * (k + 0.5) / n);
}

double sd_two_sphere_mu(double ratio, double xi)
{
  const double t = (1.0 + ratio) * (1.0 + ratio) / ratio * xi * (4.0 + xi) / 8.0;
  return log1p(t + sqrt(t * (t + 2.0)));
}

double sd_two_sphere_largest_mu(double ratio)
{
  return sd_two_sphere_mu(ratio, SD_TWO_SPHERE_LARGEST_XI);
}

void sd_two_sphere_scales(double a1, double a2, double scale[SD_TWO_SPHERE_FUNCTIONS])
{
  const double spin = a1 * a1 * a1;
  const double all[SD_TWO_SPHERE_FUNCTIONS] = {
      a1,      a1,      a1,   a1,   a1,   a1,   a1 * a1,      a1 * a1,
      a1 * a2, a1 * a2, spin, spin, spin, spin, a1 * a1 * a2, a1 * a2 * a2};
  for (int k = 0; k < SD_TWO_SPHERE_FUNCTIONS; k++) scale[k] = 6.0 * SD_PI * all[k];
}

sd_pair_resistance sd_two_sphere_alone(double a1, double a2)
{
  const double f = 6.0 * SD_PI, t = 8.0 * SD_PI;
  const double t1 = t * a1 * a1 * a1, t2 = t * a2 * a2 * a2;
  return (sd_pair_resistance){{f * a1, 0.0, f * a2},
                              {f * a1, 0.0, f * a2},
                              {0.0, 0.0, 0.0, 0.0},
                              {t1, 0.0, t2},
                              {t1, 0.0, t2}};
}
