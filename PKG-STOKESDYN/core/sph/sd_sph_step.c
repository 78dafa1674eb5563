#include "sd_sph_step.h"

#include "sd_sph_class.h"

#include <math.h>

/* |h v.d / (r^2 + eta)| of two particles: the same for both, since v.d does not change sign and h
 * is that of the pair. 0 beyond the support. */
static double approach(const sd_sph_model *model, const sd_sph_particles *p, int i, int j)
{
  const sd_sph_coefficients *pair = sd_sph_of_pair(model, p, i, j);
  double r2 = 0.0, vd = 0.0;
  for (int c = 0; c < 3; c++) {
    const double d = p->x4[4 * (size_t) i + c] - p->x4[4 * (size_t) j + c];
    r2 += d * d;
    vd += d * (p->v4[4 * (size_t) i + c] - p->v4[4 * (size_t) j + c]);
  }
  if (!(r2 < pair->support * pair->support)) return 0.0;
  return fabs(vd) / (pair->inv_h * (r2 + model->eta));
}

/* Once every few steps for check/timestep, so one pair after the other will do. */
void sd_sph_approach(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                     double *largest)
{
  for (int k = 0; k < list->n; k++) {
    const int i = list->first[k];
    for (int m = 0; m < list->count[i]; m++) {
      const int j = list->neighbor[i][m] & list->mask;
      const double s = approach(model, p, i, j);
      if (s > largest[i]) largest[i] = s;
      if (s > largest[j]) largest[j] = s;
    }
  }
}

/* Squares are compared; one root at the end. */
double sd_sph_fastest(int n, const double *v)
{
  double square = 0.0;
  for (int i = 0; i < n; i++, v += 3) {
    const double here = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if (here > square) square = here;
  }
  return sqrt(square);
}

/* Sound and the approach of particles must not cross h in a step; momentum diffuses over h in
 * h^2 rho / mu, of which an eighth is stable. */
double sd_sph_step_limit(double h, double c, double approach, double mu, double rho)
{
  const double courant = h / (c + approach);
  return mu > 0.0 ? fmin(courant, h * h * rho / (8.0 * mu)) : courant;
}
