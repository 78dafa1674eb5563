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

/* q: explicit friction bears steps below h^2 rho/(q mu). Fix nve/sph estimates the velocity that friction
 * sees by the force before, so that step times rate must be below 1 for the mode that dies fastest. On
 * square and cubic lattices, for both kernels and h of 1.2 to 3 spacings, this rate over mu/(rho h^2) is 5.7
 * to 7.0 with laplacian (Morris et al. 1997 have 8), and 13.7 to 17.8 with central, whose forces along d
 * resist modes along their own wave vector most. */
static inline double sd_sph_friction_share(sd_sph_friction form)
{
  return form == SD_SPH_CENTRAL ? 18.0 : 8.0;
}

/* That step; HUGE_VAL without friction. */
double sd_sph_friction_limit(sd_sph_friction form, double h, double mu, double rho);

/* The smaller of Courant's limit h / (c + approach) and that of friction. */
double sd_sph_step_limit(sd_sph_friction form, double h, double c, double approach, double mu, double rho);

/* Above this step sound grows if an integrator advances rho with velocities of the wrong time, as fix sph
 * of LAMMPS does (the leapfrog of fix nve/sph does not): a wave with the frequency w = c k then gains (w
 * dt)^2/4 in a step, eigenvalue by eigenvalue, and viscosity takes nu k^2 dt/2 off, so that the limit is
 * 2 nu/c^2 for any k. nu: the kinematic viscosity for such waves: 3 times that for shear where forces are
 * along d (artVisc, whose shear has alpha h c/16 in two dimensions and alpha h c/20 in three; central), and
 * once where they are along v (laplacian). p: of one type; 0: any step is too long. */
double sd_sph_growth_limit(const sd_sph_model *model, const sd_sph_parameters *p, double rho);

SD_END_C
#endif
