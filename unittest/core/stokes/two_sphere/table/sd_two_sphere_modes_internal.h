/* The three problems of two spheres in bispherical coordinates,
 *
 *   z = c sinh xi / (cosh xi - cos t),   rho = c sin t / (cosh xi - cos t),   m = cos t
 *
 * sphere 1 at xi = alpha (z > 0) is the smaller one, sphere 2 at xi = -beta. c is the unit of
 * length here, alpha >= beta > 0. Harmonic functions are
 *
 *   (cosh xi - m)^(1/2) sum_n [ f+_n e^(k (xi - alpha)) + f-_n e^(-k (xi + beta)) ] P_n(m)
 *
 * with k = n + 1/2. The part + is singular inside sphere 1 only, - inside sphere 2 only. All modes
 * feel the other sphere like e^(-k (alpha + beta)): SD_TWO_SPHERE_DEPTH/(alpha + beta) of them are
 * enough, if the motion of the larger sphere alone, which goes like e^(-k beta), is put in as it is
 * known. */
#ifndef SD_TWO_SPHERE_MODES_INTERNAL_H
#define SD_TWO_SPHERE_MODES_INTERNAL_H

#include "sd_constants.h"

#define SD_TWO_SPHERE_DEPTH 45.0L
#define SD_PI_LONG 3.14159265358979323846264338327950288L
#define SD_ROOT2_LONG 1.41421356237309504880168872420969808L

/* Sums cancel over many modes: 64 bits of mantissa where the machine has them. */
typedef long double sd_real;

/* Resistance along d and across it, by columns of the motion, in units of c: forces F1 F2 over
 * velocities U1 U2, torques T1 T2 over spins W1 W2. */
void sd_two_sphere_axial_translation(sd_real alpha, sd_real beta, sd_real XA[2][2]);
void sd_two_sphere_axial_rotation(sd_real alpha, sd_real beta, sd_real XC[2][2]);

/* rows F1 F2 along x and T1 T2 along y, columns U1 U2 W1 W2; d is along -z */
void sd_two_sphere_across(sd_real alpha, sd_real beta, sd_real Y[4][4]);

#endif
