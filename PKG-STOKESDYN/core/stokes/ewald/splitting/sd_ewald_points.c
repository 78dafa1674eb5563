/* The rule for the flow at points, which have no size */
#include <math.h>

#include "sd_constants.h"
#include "sd_ewald.h"
#include "sd_ewald_rule_internal.h"

/* Of a splitting at points the reference radius, and the rms of a^2 - a_ref^2 where forces are as large
 * as radii; 0 if all are equal. The sixth moment is no more than the fourth times the largest a^2. */
static double spread_of(const sd_ewald_class *s, double *ref)
{
  const double a2 = s->squares / s->count, a4 = s->fourths / s->count;
  const double rms = sd_ewald_six_digits(sqrt(a2)), largest = s->largest;
  const int equal = !(fabs(rms - largest) > 1e-5 * largest);
  *ref = equal ? largest : rms;
  return equal ? 0.0 : sd_ewald_six_digits(sqrt((largest * largest - 2.0 * a2) * a4 / a2 + a2 * a2));
}

/* With H of sd_radial.h the error at points, over the rms of F/(6 pi a), is near 10^-D of
 *   6 pi a sqrt(n R) A,   A^2 = 1 + (0.7 K^2 (rms of a^2 - a_ref^2))^2 + (K a)^2 with torques,
 * for the range R = (D - 1/2) h, the band K = 0.95 pi/h and windows of 1.06 D + 0.6 points, h the
 * spacing, n spheres a volume. Found by minimising what is left of near spheres beyond R and what windows
 * mistake, which are alike then. A is what the short waves of unlike spheres and of torques add; their
 * windows are differentiated and have 1.15 D + 0.6 points. */
static double digits_at_points(const sd_ewald *e, double a, double spread, int width)
{
  const double K = e->band, n = e->count / sd_ewald_volume(&e->box);
  const double unit = fmax(1.0, 6.0 * SD_PI * a * sqrt(n * e->range));
  const double more = 1.0 + pow(0.7 * K * K * spread, 2.0) + (width == 6 ? K * K * a * a : 0.0);
  const double digits = log10(unit * sqrt(more) / (0.75 * e->tolerance));
  return fmax(2.5, fmin(digits, 16.0));
}

sd_status sd_ewald_choose_at_points(const sd_ewald_box *box, const sd_ewald_sizes *sizes, int width,
                                    double points, double tolerance, sd_ewald *out)
{
  const sd_ewald_class *all = &sizes->all;
  int some;
  sd_status status = sd_ewald_prepare(box, all, tolerance, out, &some);
  if (status != SD_OK) return status;
  double spread = spread_of(all, &out->a_ref), digits = 5.0, h = 0.0;
  out->count = all->count;
  out->largest = all->largest;
  for (int k = 0; k < 6; k++) {
    /* Near pairs and transforms cost about the same where the range holds so many of as many places as
     * there would be in a product of sqrt(n points) spheres. */
    const double many = 9.0 * pow(digits - 0.5, 1.5) / sqrt(all->count * points);
    out->range = fmax(cbrt(3.0 / (4.0 * SD_PI) * many * sd_ewald_volume(box)), 2.0 * all->largest);
    h = out->range / (digits - 0.5);
    out->band = 0.95 * SD_PI / h;
    digits = digits_at_points(out, out->a_ref, spread, width);
  }
  const int slopes = spread > 0.0 || width == 6;
  out->points = (int) ceil((slopes ? 1.15 : 1.06) * digits + 0.6);
  out->beta = (slopes ? 2.42 : 2.25) * out->points;
  status = sd_ewald_lay_grid(box, h, out->points, &out->spacing, out->grid);
  if (status != SD_OK) return status;
  /* Numbers of grid points are few: what the next of them is finer than asked for shortens the range. */
  h = 0.0;
  for (int d = 0; d < 3; d++) h = fmax(h, sd_ewald_edge_length(box, d) / out->grid[d]);
  out->band = 0.95 * SD_PI / h;
  out->range = fmax((digits - 0.5) * h, 2.0 * all->largest);
  out->xi = sqrt(0.5 * out->band / out->range); /* that of long waves */
  out->reach = out->range;
  return SD_OK;
}
