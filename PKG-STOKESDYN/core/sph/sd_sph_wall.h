/* Walls of SPH: repulsion by a surface, and fixed particles that carry the fluid's pressure. */
#ifndef SD_SPH_WALL_H
#define SD_SPH_WALL_H

#include "sd_sph_pair.h"
#include "sd_sph_pressure.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Force of a mirror particle behind the wall, m^2 2 P / rho^2 |W'(r)|; dW = W'(r) < 0. */
double sd_sph_mirror(double m, double P, double rho, double dW);

/* Force along the inward normal at the distance r from a wall, Monaghan 1994:
 * D ((r0/r)^4 - (r0/r)^2) for 0 < r < r0, 0 beyond. */
double sd_sph_repulsion(double D, double r0, double r);

/* Adami, Hu & Adams 2012. Sums of a wall particle w over the fluid particles f in its support:
 *   sums [5 (n+1)]   sum W,  sum (P_f + rho_f b . (x_w - x_f)) W,  sum v_f W (3)
 * with b = g - a_w, the body force per mass as the wall sees it. Walls are the particles with
 * mask & bit; neither wall-wall nor fluid-fluid pairs count. */
void sd_sph_wall_sums(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                      const int *mask, int bit, const double *pressure, const double b[3],
                      double *sums);

/* What these sums make of one wall particle that moves with v. row, in: its density. Out: the
 * density that has the pressure of the fluid before it (0: none has), and by how much the velocity
 * that friction sees differs from v: to that of the fluid with slip, to its mirror image without.
 * A wall without fluid in reach has P0, or keeps its density (absolut). */
void sd_sph_wall_particle(const sd_sph_state *state, const double sums[5], const double v[3],
                          int slip, double row[4]);

#ifdef __cplusplus
}
#endif
#endif
