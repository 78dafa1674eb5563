/* Walls of SPH: repulsion by a surface, and fixed particles that carry the fluid's pressure. */
#ifndef SD_SPH_WALL_H
#define SD_SPH_WALL_H

#include "sd_sph_pair.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Force along the inward normal at the distance r from a wall: D ((r0/r)^4 - (r0/r)^2) for 0 < r < r0, 0
 * beyond (Monaghan 1994). */
double sd_sph_repulsion(double D, double r0, double r);

/* Adami, Hu & Adams 2012. Sums of a wall particle w over the fluid particles f in its support:
 *   sums [5 (n+1)]   sum W,  sum (P_f + rho_f b . (x_w - x_f)) W,  sum v_f W (3)
 * with b = g - a_w, the body force per mass as the wall sees it. is_wall [n+1]: neither wall-wall nor
 * fluid-fluid pairs count. */
void sd_sph_wall_sums(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                      const int *is_wall, const double *pressure, const double b[3], double *sums);

#ifdef __cplusplus
}
#endif
#endif
