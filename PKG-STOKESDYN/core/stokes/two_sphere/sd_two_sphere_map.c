#include <math.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_two_sphere_table_internal.h"

const double sd_two_sphere_table[SD_TWO_SPHERE_RATIOS][SD_TWO_SPHERE_GAPS]
                                [SD_TWO_SPHERE_FUNCTIONS] = {
#include "sd_two_sphere_table.inc"
};

double sd_two_sphere_node(int n, int k)
{
  return 0.5 + 0.5 * cos(SD_PI * (k + 0.5) / n);
}

void sd_two_sphere_nodes(int n, double *node, double *root)
{
  for (int k = 0; k < n; k++) {
    node[k] = sd_two_sphere_node(n, k);
    root[k] = sqrt(node[k] * (1.0 - node[k]));
  }
}

void sd_two_sphere_weights_at(int n, const double *node, const double *root, double t, double *w)
{
  double sum = 0.0;
  for (int k = 0; k < n; k++) {
    const double d = t - node[k];
    if (d == 0.0) {
      memset(w, 0, sizeof(double) * (size_t) n);
      w[k] = 1.0;
      return;
    }
    sum += w[k] = (k % 2 ? -root[k] : root[k]) / d;
  }
  for (int k = 0; k < n; k++) w[k] /= sum;
}

void sd_two_sphere_weights(int n, double t, double *w)
{
  double node[SD_TWO_SPHERE_GAPS], root[SD_TWO_SPHERE_GAPS];
  sd_two_sphere_nodes(n, node, root);
  sd_two_sphere_weights_at(n, node, root, t, w);
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
