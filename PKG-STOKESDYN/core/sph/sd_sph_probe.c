#include "sd_sph_probe.h"

#include "sd_constants.h"
#include "sd_sph_class.h"

#include <math.h>

static double spread_to(const sd_sph_spread *of, double r)
{
  return of->V * sd_sph_W(of->kernel, of->dimension, r, of->h);
}

void sd_sph_probe_add(const sd_sph_spread *of, double r, double P, double sums[2])
{
  const double VW = spread_to(of, r);
  sums[0] += VW;
  sums[1] += VW * P;
}

double sd_sph_probe_pressure(const double sums[2])
{
  return sums[0] > 0.0 ? sums[1] / sums[0] : 0.0;
}

/* The line crosses the support of a particle from z - reach to z + reach. */
void sd_sph_gauge_add(const sd_sph_spread *of, double across, double z, const sd_sph_stretch *at,
                      double *fraction)
{
  if (!(across < 2.0 * of->h)) return;
  const double reach = sqrt(4.0 * of->h * of->h - across * across), step = at->step;
  const double first = fmax(0.0, ceil((z - reach) / step) - at->first);
  const double last = fmin(at->count - 1.0, floor((z + reach) / step) - at->first);
  if (!(first <= last)) return;    /* out of the stretch, perhaps by more than an int holds */
  for (int k = (int) first; k <= last; k++)
    fraction[k] += spread_to(of, hypot(across, z - (at->first + k) * step));
}

double sd_sph_gauge_height(const sd_sph_stretch *at, const double *fraction)
{
  for (int k = at->count - 2; k >= 0; k--) {
    const double below = fraction[k], above = fraction[k + 1];
    if (below >= 0.5 && above < 0.5)
      return at->step * (at->first + k + (below - 0.5) / (below - above));
  }
  return 0.0;
}

static void add_moments(const sd_sph_model *model, const sd_sph_particles *p, const sd_sph_two *two,
                        double *M)
{
  static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
  const double g =
      -two->pair->grad * sd_sph_G(model->kernel, sqrt(two->r2) * two->pair->inv_h);
  for (int c = 0; c < 6; c++) {
    const double dd = g * two->d[row[c]] * two->d[column[c]];
    M[6 * (size_t) two->i + c] += fabs(p->x4[4 * (size_t) two->j + 3]) * dd;
    M[6 * (size_t) two->j + c] += fabs(p->x4[4 * (size_t) two->i + 3]) * dd;
  }
}

void sd_sph_moments(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                    double *M)
{
  sd_sph_each_pair(model, list, p, add_moments, M);
}

/* Two dimensions: mean less radius of Mohr's circle. Three: roots of the characteristic polynomial
 * by a cosine, Smith 1961; with N = (M - mean I) / p they are mean + 2 p cos(angle + 2 pi k / 3),
 * cos(3 angle) = det N / 2. */
double sd_sph_least_eigenvalue(int dimension, const double M[6])
{
  if (dimension == 2) return 0.5 * (M[0] + M[1]) - hypot(0.5 * (M[0] - M[1]), M[3]);
  const double mean = (M[0] + M[1] + M[2]) / 3.0;
  const double a = M[0] - mean, b = M[1] - mean, c = M[2] - mean;
  const double p =
      sqrt((a * a + b * b + c * c + 2.0 * (M[3] * M[3] + M[4] * M[4] + M[5] * M[5])) / 6.0);
  if (p == 0.0) return mean;
  const double det = a * (b * c - M[5] * M[5]) - M[3] * (M[3] * c - M[5] * M[4]) +
      M[4] * (M[3] * M[5] - b * M[4]);
  const double cosine = fmax(-1.0, fmin(1.0, det / (2.0 * p * p * p)));
  return mean + 2.0 * p * cos((acos(cosine) + 2.0 * SD_PI) / 3.0);
}
