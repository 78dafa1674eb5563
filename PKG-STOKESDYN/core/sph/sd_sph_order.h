/* What the sums in the middle of a step make of each particle: gradient of the density, rate, shift
 * and correction. Notation of sd_sph_pair.h and sd_sph_sums.h; B = M^-1. */
#ifndef SD_SPH_ORDER_H
#define SD_SPH_ORDER_H

#include "sd_sph_sums.h"

SD_BEGIN_C

/* Fills the last column of x4 with V = m / rho, - V of a wall, and that of row n with 0. */
void sd_sph_pack_volumes(const sd_sph_model *model, const sd_sph_particles *p, const double *rho,
                         double *x4);

typedef struct {
  /* particles of this rank, the first ones */
  int n;
  /* [sd_sph_sum_columns n] */
  const double *sums;
  /* Those with mask & moving, and a phase that is none of a wall, flow and are shifted. */
  const int *mask;
  int moving;
  /* There is no free surface, as always with correction: who flows is shifted, however few its neighbours
   * are. Otherwise a gap that the flow draws inside the fluid stays for ever. */
  int full;
  /* with `full`: whose smallest eigenvalue of M is below this is at a surface all the same */
  double least;
  /* with shift: the last column of du is 1 where a particle flows and the smallest eigenvalue of M is above
   * this; 0: not asked for */
  double whole;
  /* out [n]; rows of sd_sph_particles; and with pliant shift and correction [3 n] the acceleration (G B) du,
   * which is that of correction alone */
  double *rate, *slope, *du, *B, *kick;
} sd_sph_closing;

/* rate    the sum; with correction, and pliant where du is not 0 by the rule below, - rho tr(G B).
 *         With shift and correction + du . grad rho
 * grad rho = B sum V_b (rho_b - rho_a) g d, exact for a linear density; 0 where M is nearly
 * singular (too few neighbours, all in a plane), which leaves the diffusion of Molteni & Colagrossi
 * 2009 there.
 * du      - U x, x = 10 h s, of length 1 at most: the law of Michel et al. 2022 in a bounded form;
 *         0 for walls and, unless `full`, where an eigenvalue of M is below 0.9: at a free surface and,
 *         since M is that of one fluid, at an interface. Where it is below 0.9 B of pliant is the unit
 *         matrix: M says more of the cut than of the arrangement
 * Returns the first particle that flows and is at a surface although there should be none (`full`), -1:
 * there is none. */
int sd_sph_close(const sd_sph_model *model, const sd_sph_particles *p, const sd_sph_closing *c);

SD_END_C
#endif
