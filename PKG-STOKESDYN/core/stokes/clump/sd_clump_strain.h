/* Strains in the axes of a clump. */
#ifndef SD_CLUMP_STRAIN_H
#define SD_CLUMP_STRAIN_H

#include "sd_extern_c.h"

SD_BEGIN_C

/* A gradient of the fluid velocity, G y = W x y + E y: W [3] in space, E_xx E_yy E_zz E_yz E_xz E_xy
 * in the axes of the shape in pose R */
void sd_clump_split_gradient(const double R[9], const double G[9], double W[3], double E[6]);
/* A = E from these six numbers; and v = E y for the unit number c of them */
void sd_clump_strain_matrix(const double E[6], double A[9]);
void sd_clump_unit_strain(int c, const double y[3], double v[3]);

SD_END_C
#endif
