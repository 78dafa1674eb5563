/* The mobility matrix of a few spheres scaled to unit diagonal, C = D^1/2 M D^1/2 with D = 6 pi eta a: its blocks depend on
 * positions, radii and the law only. Preconditioners are made of its parts. */
#ifndef SD_UNIT_H
#define SD_UNIT_H

#include "sd_product.h"
#include "sd_status.h"

/* Cholesky factor of C of the spheres member[0 ... m-1], in the lower triangle of A [(3m)^2], column-major. Singular within
 * rounding (spheres at one point): that of C with a small diagonal added. SD_OK; SD_EINDEFINITE; SD_ENOTFINITE. */
sd_status sd_unit_cholesky(const sd_law *law, const sd_spheres *s, const int *member, int m,
                           double *A);

/* Torques keep the diagonal: their rows of z = D r. Nothing to do for width 3. */
void sd_torques(int width, const double *drag, const double *spin, int n, const double *r,
                double *z);

#endif
