#include "sd_sph_step.h"

#include "sd_sph_visit.h"

/* Once every few steps for check/timestep, so one pair after the other will do. v.d does not change
 * sign between a and b, and h is that of the pair: one number for both. */
void sd_sph_approach(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                     double *largest)
{
  sd_sph_visitor v;
  SD_SPH_VISIT(model, list, p, v)
  {
    const double *vi = p->v4 + 4 * (size_t) v.i, *vj = p->v4 + 4 * (size_t) v.j;
    double vd = 0.0;
    for (int c = 0; c < 3; c++) vd += (vi[c] - vj[c]) * v.d[c];
    const double s = fabs(vd) / (v.k->inv_h * (v.r2 + model->eta));
    if (s > largest[v.i]) largest[v.i] = s;
    if (s > largest[v.j]) largest[v.j] = s;
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
