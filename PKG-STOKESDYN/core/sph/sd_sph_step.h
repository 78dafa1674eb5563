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

/* Above this step sound grows if an integrator advances rho with velocities of the wrong time, as fix sph
 * of LAMMPS does (the leapfrog of fix nve/sph does not): a wave with the frequency w = c k then gains (w
 * dt)^2/4 in a step, eigenvalue by eigenvalue, and viscosity takes nu k^2 dt/2 off, so that the limit is
 * 2 nu/c^2 for any k. nu: the kinematic viscosity for such waves: 3 times that for shear where forces are
 * along d (artVisc, whose shear has alpha h c/16 in two dimensions and alpha h c/20 in three; central), and
 * once where they are along v (laplacian). p: of one type; 0: any step is too long. */
double sd_sph_growth_limit(const sd_sph_model *model, const sd_sph_parameters *p, double rho);

SD_END_C
#endif
