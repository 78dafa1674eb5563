/* Preconditioners of conjugate gradients: approximations P of the inverse of the mobility matrix M, kept over many solves.
 *
 * Both are made of the matrix with unit diagonal, C = D^1/2 M D^1/2, whose blocks depend on positions, radii and the law only,
 * so that P = D^1/2 (approximation of C^-1) D^1/2. Unknowns are forces, with rotation forces and torques (width 3, 6).
 * A preconditioner changes the number of iterations, never the answer. */
#ifndef SD_PRECONDITION_H
#define SD_PRECONDITION_H

#include "sd_blocks.h"
#include "sd_sparse.h"

#endif
