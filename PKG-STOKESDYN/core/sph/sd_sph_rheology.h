/* Fluids whose dynamic viscosity mu depends on the shear rate G = (2 S:S)^(1/2), S the symmetric part of the
 * gradient of the velocity. The stress is mu(G) 2 S, of size mu G.
 *   Newton             mu
 *   Herschel-Bulkley   min(mu_max, mu G^(n-1) + tau/G): stress tau + mu G^n. tau = 0 is the power law, n = 1
 *                      Bingham's fluid, both a Newtonian one. mu_max is what regularises the law: below the
 *                      shear rate where the two meet, about tau/mu_max, the fluid creeps with mu_max
 *   Carreau            mu + (mu_max - mu) (1 + (lambda G)^2)^((n-1)/2), from mu_max at rest to mu
 * The stress grows with G for all of them: that of the second is the smaller of two functions that do.
 * Sources: Herschel & Bulkley 1926; Bingham 1922; Carreau 1972. */
#ifndef SD_SPH_RHEOLOGY_H
#define SD_SPH_RHEOLOGY_H

#include "sd_sph_sums.h"

SD_BEGIN_C

typedef enum { SD_SPH_NEWTON, SD_SPH_HERSCHEL_BULKLEY, SD_SPH_CARREAU } sd_sph_law;

/* mu      pressure * time, of Herschel-Bulkley pressure * time^n; > 0
 * tau     yield stress, a pressure >= 0
 * n       exponent > 0, of Carreau at most 1
 * mu_max  pressure * time, > 0; of Carreau mu at least
 * lambda  time > 0 */
typedef struct {
  sd_sph_law law;
  double mu, tau, n, mu_max, lambda;
} sd_sph_rheology;

/* mu of a shear rate >= 0. */
double sd_sph_mu(const sd_sph_rheology *fluid, double shear_rate);

/* The largest that there is. */
double sd_sph_largest_mu(const sd_sph_rheology *fluid);

/* G from a row of sums of sd_sph_velocity_gradients: exact for a velocity that is linear in space. 0 where
 * neighbours are too few to tell. */
double sd_sph_shear_rate(int dimension, const double sums[SD_SPH_GRADIENTS]);

SD_END_C
#endif
