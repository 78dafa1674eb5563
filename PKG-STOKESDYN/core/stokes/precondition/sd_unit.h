/* The mobility matrix of a few spheres scaled to unit diagonal, C = D^1/2 M D^1/2, D = 6 pi eta a
 * in the rows of forces and 8 pi eta a^3 in those of torques: its blocks depend on positions, radii
 * and the law only. Above a wall the diagonal has the sphere's own image besides. Preconditioners
 * are made of its parts. width: 3 (forces), or 6 (forces and
 * torques, sd_tensor_grand; not with SD_TENSOR_OSEEN). */
#ifndef SD_UNIT_H
#define SD_UNIT_H

#include "sd_product.h"
#include "sd_status.h"

/* Roots of D [2n]: (6 pi eta a)^1/2 and (8 pi eta a^3)^1/2 of each sphere; 0 for those that take no
 * part. */
void sd_unit_roots(const sd_spheres *s, int n, double *root);

/* Cholesky factor of C of the spheres member[0 ... m-1], in the lower triangle of A [(width m)^2],
 * column-major. Singular within rounding (spheres at one point): that of C with a small diagonal
 * added. SD_OK; SD_EINDEFINITE; SD_ENOTFINITE. */
sd_status sd_unit_cholesky(const sd_law *law, const sd_spheres *s, const int *member, int m,
                           int width, double *A);

/* The same in single precision, which is enough for an approximation of the inverse and takes two
 * thirds of the time. Also SD_ESINGULAR: too near to singular for it, as spheres nearly at one
 * point are. */
sd_status sd_unit_cholesky_single(const sd_law *law, const sd_spheres *s, const int *member, int m,
                                  int width, float *A);

#endif
