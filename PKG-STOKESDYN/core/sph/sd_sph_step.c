#include "sd_sph_step.h"

#include "sd_linear.h"
#include "sd_sph_class.h"

#include <math.h>

/* |h v.d / (r^2 + eta)| is the same for both, since v.d does not change sign and h is that of the
 * pair. */
static void approach(const sd_sph_model *model, const sd_sph_particles *p, const sd_sph_two *two,
                     double *largest)
{
  double v[3];
  sd_minus(p->v4 + 4 * (size_t) two->i, p->v4 + 4 * (size_t) two->j, v);
  const double s = fabs(sd_dot(v, two->d)) / (two->pair->inv_h * (two->r2 + model->eta));
  largest[two->i] = fmax(largest[two->i], s);
  largest[two->j] = fmax(largest[two->j], s);
}

void sd_sph_approach(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                     double *largest)
{
  sd_sph_each_pair(model, list, p, approach, largest);
}

/* Squares are compared; one root at the end. */
double sd_sph_fastest(int n, const double *v)
{
  double square = 0.0;
  for (int i = 0; i < n; i++, v += 3) {
    const double here = sd_dot(v, v);
    if (here > square) square = here;
  }
  return sqrt(square);
}

double sd_sph_friction_limit(sd_sph_friction form, double h, double mu, double rho)
{
  return form != SD_SPH_INVISCID && mu > 0.0 ? h * h * rho / (sd_sph_friction_share(form) * mu) : HUGE_VAL;
}

/* Sound and the approach of particles must not cross h in a step. */
double sd_sph_step_limit(sd_sph_friction form, double h, double c, double approach, double mu, double rho)
{
  return fmin(h / (c + approach), sd_sph_friction_limit(form, h, mu, rho));
}

double sd_sph_growth_limit(const sd_sph_model *model, const sd_sph_parameters *p, double rho)
{
  const double of_alpha = model->dimension == 2 ? 1.0 / 16.0 : 1.0 / 20.0;
  double nu = 0.0;
  if (model->artvisc) nu += 3.0 * of_alpha * p->alpha * p->h * p->c;
  if (model->friction) nu += (model->friction == SD_SPH_CENTRAL ? 3.0 : 1.0) * p->mu / rho;
  return 2.0 * nu / (p->c * p->c);
}
