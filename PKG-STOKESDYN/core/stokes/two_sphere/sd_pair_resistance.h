/* Resistance of two spheres: forces F and torques T that they exert on the fluid, from their
 * velocities U and angular velocities W. It knows no direction but d, the unit vector from sphere 1
 * to sphere 2:
 *
 *   F_i = sum_j [ XA_ij dd + YA_ij (1 - dd) ] U_j  +  YB_ji d x W_j
 *   T_i = sum_j YB_ij U_j x d  +  [ XC_ij dd + YC_ij (1 - dd) ] W_j
 *
 * Symmetric: XA_12 = XA_21 and so on, but YB_12 and YB_21 are two numbers. With the spheres
 * exchanged d turns round, so YB changes its sign. Names: Jeffrey & Onishi 1984 (who scale each by
 * powers of a_i + a_j; here they have their units). */
#ifndef SD_PAIR_RESISTANCE_H
#define SD_PAIR_RESISTANCE_H

#include "sd_status.h"

SD_BEGIN_C

/* For a viscosity of 1: whoever has another multiplies. */
typedef struct {
  /* 11 12 22, length */
  double XA[3], YA[3];
  /* 11 12 21 22, length^2 */
  double YB[4];
  /* 11 12 22, length^3 */
  double XC[3], YC[3];
} sd_pair_resistance;

/* The same pair with sphere 2 called 1. */
sd_pair_resistance sd_pair_resistance_exchanged(const sd_pair_resistance *R);

/* Inverse of the mobility of the Rotne-Prager-Yamakawa model with rotation (sd_tensor.h) for two
 * spheres alone, radii a1, a2 > 0 at any centre distance > 0 at which it is positive definite: all
 * but one sphere around the other's centre. Along d it falls into two 2x2, across into a 4x4. */
sd_pair_resistance sd_pair_resistance_rpy(double a1, double a2, double distance);

/* Q^T D Q: what D does to the relative motion of the pair. Q = 1 - K (K^T A K)^-1 K^T A takes out
 * the motion as one rigid body, K its six columns, A the Stokes drags 6 pi a and 8 pi a^3 of the
 * two spheres: Q K = 0. Positive semidefinite if D is. */
sd_pair_resistance sd_pair_resistance_relative(const sd_pair_resistance *D, double a1, double a2,
                                               double distance);

/* p A + q B */
sd_pair_resistance sd_pair_resistance_sum(double p, const sd_pair_resistance *A, double q,
                                          const sd_pair_resistance *B);

/* Random forces and torques of two spheres whose covariance is a resistance of the pair, in closed
 * form: it falls into forces along d (2x2), torques along d (2x2) and, across d, forces along e with
 * torques along e x d (4x4), the same for both directions e. F [12] += forces and torques on the first
 * sphere, then on the second, of covariance R from standard normal numbers g [12], four vectors in
 * space: only d and these say what comes out, no choice of axes across d, and no unit of length.
 * length: of the pair, such as its mean radius, over which torques are comparable to forces. SD_OK;
 * SD_EINDEFINITE: an eigenvalue below -1e-6 of the largest number of the pair; what is above is
 * rounding and counts as 0. */
sd_status sd_pair_noise(const sd_pair_resistance *R, const double d[3], double length,
                        const double g[12], double F[12]);

SD_END_C
#endif
