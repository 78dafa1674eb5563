/* Brownian motion of a rigid clump that no other disturbs: the point at which it may be tracked, and
 * numbers with the covariance of its mobility there.
 *
 * With N the 6x6 mobility about a point, B its block of velocity from torque and D that of angular
 * velocity from torque, the centre of mobility is at
 *   o = (tr D 1 - D)^-1 (B_zy - B_yz, B_xz - B_zx, B_yx - B_xy)
 * from that point; about it B is symmetric, and div N = 0. A clump that is moved by its noise about
 * any other point drifts. (A clump that has no mirror plane keeps a B there; for others the centre of
 * mobility is that of reaction.)
 * Source: Bernal & Garcia de la Torre, Biopolymers 19, 751 (1980). */
#ifndef SD_CLUMP_NOISE_H
#define SD_CLUMP_NOISE_H

#include "sd_clump.h"

SD_BEGIN_C

/* For eta = 1, in the axes of the shape */
typedef struct {
  /* of mobility, from the centroid */
  double centre[3];
  /* L [6 6], L L^T = N about it: (U, W) from force and torque. L is the symmetric root once rotations are
   * made comparable to translations by a length of the clump, so that other axes of the same shape give
   * the same motion from the same numbers */
  double root[36];
} sd_clump_noise;

/* What the clump cannot do (points on a line turn about it by nothing) it does not do. */
void sd_clump_noise_of(const sd_clump *clump, sd_clump_noise *out);

/* y [6] = N^1/2 w, U of the centre of mobility and W, from standard normal numbers w [6], all in space: of a
 * clump in pose R [9] in a fluid of viscosity eta. */
void sd_clump_noise_draw(const sd_clump_noise *n, const double R[9], double eta, const double w[6],
                         double y[6]);

SD_END_C
#endif
