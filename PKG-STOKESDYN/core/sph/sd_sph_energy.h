/* Energies of SPH, and the power of forces. Sums over the particles of one rank. */
#ifndef SD_SPH_ENERGY_H
#define SD_SPH_ENERGY_H

#include "sd_sph_pressure.h"

SD_BEGIN_C

/* Energy per mass that is stored in a fluid of density rho > 0, e = int P / rho^2 drho from rho0 to
 * rho (absolut: from 1). With s = ln(rho / rho0)
 * and E(k) = (e^(k s) - 1) / k
 *   Tait      [B E(gamma - 1) - (B - P0) E(-1)] / rho0
 *   relativ   B s - (B - P0 / rho0) E(-1)
 *   absolut   B^2 ln rho
 * Without tension - P0 / rho0 E(-1) below rho0. */
double sd_sph_elastic(const sd_sph_state *state, double rho);

/* Those with mask & members == members take part. */
typedef struct {
  int n;
  const int *mask;
  int members;
  /* [n] mass, [3 n] velocity */
  const double *m, *v;
} sd_sph_members;

/* sum m v^2 / 2 */
double sd_sph_kinetic_energy(const sd_sph_members *g);

/* sum m e of the density rho [n] */
double sd_sph_elastic_energy(const sd_sph_members *g, const sd_sph_state *state, const double *rho);

/* sum F.v over the members and, in *others, over all that are none; F [columns n], rows Fx Fy Fz and what is
 * not read */
double sd_sph_power(const sd_sph_members *g, int columns, const double *F, double *others);

/* sum a of numbers a [n] */
double sd_sph_sum(const sd_sph_members *g, const double *a);

/* sum m b.y of rows y [3 n], for one vector b */
double sd_sph_along(const sd_sph_members *g, const double b[3], const double *y);

SD_END_C
#endif
