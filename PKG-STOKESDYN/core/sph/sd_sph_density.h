/* Densities from sums over neighbours. */
#ifndef SD_SPH_DENSITY_H
#define SD_SPH_DENSITY_H

#include "sd_sph_sums.h"

SD_BEGIN_C

/* q [4 (n+1)] for sd_sph_weigh: m, m / rho, 0, 0. */
void sd_sph_pack_masses(const sd_sph_model *model, const sd_sph_particles *p, const double *rho,
                        double *q);

/* rho of the particles i < n with mask[i] & bit from these sums [4 n], itself included:
 *   summation   sum m_b W
 *   Shepard     sum m_b W / sum (m_b / rho_b) W */
typedef struct {
  int n, bit, shepard;
  const int *mask;
  const double *sums;
} sd_sph_densities;
void sd_sph_sum_densities(const sd_sph_model *model, const sd_sph_particles *p,
                          const sd_sph_densities *how, double *rho);

SD_END_C
#endif
