/* How a body follows random velocities y at its points, without a solve: v = A^T y, K^T A = 1. For a step
 * whose points are placed half a step along v, so that the mean of one solve there has the drift of the
 * mobility (sd_drifter.h). A [numbers 6], in the frame of the shape and its lengths as sd_body_shape.h has
 * them: A(a) = A diag(1, 1/a).
 *
 * The drift is right if sum_k (d_k M') A_k = 0 over the coordinates k by which bodies move. A point of
 * another body sees at point b of this one a tensor without divergence, so that
 *   free spheres     whose shells do not turn: any A with one row of K for all points; the mean,
 *                    A = K (K^T K)^-1
 *   bodies that turn K_b A_b^T, 3 x 3, must be a multiple of 1 at each point b, for forces and for torques.
 *                    Of all A that obey this and K^T A = 1 the one with the least v: the trace of A^T M_b' A,
 *                    U and W each over the mean of N's diagonal, so that it does not depend on the axes
 * What is left then is the body's own, constant in its axes, with e_q the axes:
 *   slip = sum_q [e_q x, M_b'] A_(3 + q),   torque = sum_q sum_b (e_q x r_b) x A_b,(3 + q)
 * Not every shape has such an A: then A = M_b'^-1 K N, and the caller takes the sum by differences.
 * Source: own derivation. */
#ifndef SD_BODY_FOLLOW_H
#define SD_BODY_FOLLOW_H

#include "sd_body_shape.h"

SD_BEGIN_C

typedef struct {
  /* width m; is nothing left but slip and torque? */
  int n, exact;
  /* [6 n], row-major */
  double *A;
  /* [n] over viscosity, NULL: 0; about the centre */
  double *slip, torque[3];
} sd_body_follow;

/* Bodies of more numbers have no A that is exact: finding it would take longer than what it saves. */
enum { SD_BODY_FOLLOW_MOST = 600 };

/* Of the kind that its points ask for (shape->turns): of those that turn in a way of their own no A is exact.
 * The owner frees. SD_OK; SD_ENOMEMORY; SD_ENOTFINITE. */
sd_status sd_body_follow_create(const sd_body_shape *shape, sd_body_follow *out);
void sd_body_follow_free(sd_body_follow *f);

SD_END_C
#endif
