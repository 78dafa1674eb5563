/* The time step limits of a weakly compressible SPH run. */
#ifndef SD_SPH_STEP_H
#define SD_SPH_STEP_H

#include "sd_sph_pair.h"

SD_BEGIN_C

/* largest [n+1]: the largest |h v.d / (r^2 + eta)| over the neighbours, taken as maximum with what
 * is there. */
void sd_sph_approach(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                     double *largest);

/* The largest speed of n particles. */
double sd_sph_fastest(int n, const double *v);

/* Courant limit h / (c + approach), and with a dynamic viscosity mu > 0 also h^2 rho / (8 mu)
 * (Morris et al. 1997); the smaller. */
double sd_sph_step_limit(double h, double c, double approach, double mu, double rho);

SD_END_C
#endif
