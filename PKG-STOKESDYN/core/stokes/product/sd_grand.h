/* Grand mobility times vector, the pair part only: velocity and angular velocity of every sphere from forces and torques,
 *
 *   (U_i W_i) = sum_{j != i} M_ij (F_j T_j),    M_ij the 6x6 block of sd_tensor_grand
 *
 * Vectors have 6 numbers a sphere. Otherwise as sd_product.h: diagonal left to the solver, viscosity of a pair sqrt(eta_i eta_j),
 * radius 0: takes no part. The taper of the law multiplies whole blocks; its tensor is always RPY here.
 * These are in plain C, pair by pair; the fast product is sd_packed with rotation set (sd_product.h). */
#ifndef SD_GRAND_H
#define SD_GRAND_H

#include "sd_product.h"

#ifdef __cplusplus
extern "C" {
#endif

/* F [6 * all spheres], ghosts included -> u [6n] */
void sd_product_grand_list(const sd_law *law, const sd_spheres *s, const sd_pairs *pairs,
                           const double *F, double *u);

/* Targets begin ... begin + n - 1 of n_all spheres, sources all of them. F [6 n_all] -> u [6n]. */
void sd_product_grand_all(const sd_law *law, const sd_spheres *s, int n_all, int begin, int n,
                          const double *F, double *u);

#ifdef __cplusplus
}
#endif
#endif
