/* Densities from sums over neighbours, and the diffusion of density of delta-SPH. */
#ifndef SD_SPH_DENSITY_H
#define SD_SPH_DENSITY_H

#include "sd_sph_pair.h"

#ifdef __cplusplus
extern "C" {
#endif

/* sums [2 (n+1)]: adds sum m_b W and, with rho not null, sum (m_b / rho_b) W, without the particle
 * itself. */
void sd_sph_sums(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                 const double *rho, double *sums);

/* rho of the particles i < n with mask[i] & bit from these sums, the particle itself included:
 *   summation   sum m_b W
 *   Shepard     sum m_b W / sum (m_b / rho_b) W */
void sd_sph_summation(const sd_sph_model *model, const sd_sph_particles *p, const double *sums,
                      int n, const int *mask, int bit, double *rho);
void sd_sph_shepard(const sd_sph_model *model, const sd_sph_particles *p, const double *sums, int n,
                    const int *mask, int bit, double *rho);

/* delta-SPH, Antuono et al. 2010: the rate of density
 *   delta h c sum_b V_b psi_ab . grad_a W,   d_ba = x_b - x_a
 *   psi_ab = 2 (rho_b - rho_a) d_ba / r^2 - (grad rho_a + grad rho_b)
 * where grad rho is the first-order consistent gradient
 *   L^-1 sum_b V_b (rho_b - rho_a) grad_a W,   L = sum_b V_b d_ba (grad_a W)^T.
 *
 * 1. sd_sph_gradient_sums adds to sums [9 (n+1)]: L (xx yy zz xy xz yz) and the right side
 *    (x y z).
 * 2. sd_sph_gradient solves for one particle; g = 0 where L is nearly singular (too few neighbours,
 *    all in a plane), which leaves the diffusion of Molteni & Colagrossi 2009 there.
 * 3. sd_sph_diffusion adds delta times the rate; gradient [3 (n+1)]. */
void sd_sph_gradient_sums(const sd_sph_model *model, const sd_sph_list *list,
                          const sd_sph_particles *p, const double *rho, double *sums);
void sd_sph_gradient(int dimension, const double sums[9], double g[3]);
void sd_sph_diffusion(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                      const double *rho, const double *gradient, double delta, double *rate);

#ifdef __cplusplus
}
#endif
#endif
