/* The wave part of one pair in open space, which the near part takes away from the pair's tensor,
 * in closed form. With the directions of k averaged, everything follows from eight functions of the
 * distance:
 *
 *   I_n = 1/(2 pi^2) int k^2n H (j_0 - j_1/(kr)) dk,   J_n = 1/(2 pi^2) int k^2n H j_2 dk,
 *   K_n = 1/(4 pi^2) int k^(2n+1) H j_1 dk                                      n = 0, 1, 2
 *
 *   U_i = [ (I_0 - (b_i + b_j) I_1 + b_i b_j I_2) 1 + (J_0 - (b_i + b_j) J_1 + b_i b_j J_2) hh ] F_j
 *         + (K_0 - b_i K_1) T_j x h
 *   W_i = (K_0 - b_j K_1) F_j x h + [ I_1 1 + J_1 hh ] T_j / 4
 *
 * all over eta; h = r/R, b = (a^2 - a_ref^2)/6, j_l spherical Bessel functions.
 *
 * Waves that end at a band K have the integrals themselves, with
 *
 *   H = (1 + x - a_ref^2 k^2/3) exp(-x),   x = R' (K - sqrt(K^2 - k^2)),   0 from K on,   R' = K/(2 xi^2)
 *
 * A Gaussian has x = k^2/(4 xi^2), which this is for long waves; but where R' is the range or a little less,
 * of all functions that end at K it leaves nearly the least beyond it, and K R is a little more than half
 * of what it is where a Gaussian is cut. The flow at points has b = 0 there, and a_ref is of the spheres
 * alone, which is why it has k^2/6.
 * Source: our own; the exponential is the window of Barnett, Magland & af Klinteberg 2019. */
#ifndef SD_RADIAL_H
#define SD_RADIAL_H

#include "sd_ewald.h"

SD_BEGIN_C

/* In this order everywhere; J over r^2 and K over r: smooth and even in r, as all of them are here */
enum { SD_I0, SD_J0, SD_I1, SD_J1, SD_I2, SD_J2, SD_K0, SD_K1, SD_RADIALS };

/* Terms of the longest polynomial that stands for one of them; and where sums are of floats, whose tolerances
 * are loose */
enum { SD_RADIAL_TERMS = 40, SD_RADIAL_SINGLE_TERMS = 21 };

/* H(k^2) of the wave part, less what a smoother splitting has taken */
double sd_ewald_wave_screen(const sd_ewald *e, double k2);

/* b of a radius */
static inline double sd_ewald_b(const sd_ewald *e, double a)
{
  return (a - e->a_ref) * (a + e->a_ref) / 6.0;
}

/* A filter: 1/length, length */
typedef struct {
  double xi, a_ref;
} sd_filter;

/* lap^s L, s = 0 ... 3, L = erf(xi R)/R: 1/R filtered with exp(-x). Radial functions are lists here,
 * f[n] = (1/R d/dR)^n f, so that derivatives along directions are
 *   d_k f = f[1] R_k,   d_k d_l f = f[1] delta_kl + f[2] R_k R_l   and so on. */
enum { SD_FILTERED_TERMS = 8 };
typedef struct {
  sd_filter filter;
  double R2, L[4][SD_FILTERED_TERMS];
} sd_filtered;

/* At R^2, the first `terms` of L itself; laplacians: those of its Laplacians too, as many as below
 * need. */
sd_filtered sd_filtered_at(const sd_filter *filter, double R2, int terms, int laplacians);

/* I and J of lap^s G = I 1 + J R R, s = 0, 1, 2: 8 pi times the wave part of two point forces, to
 * 1e-15 of what it is at R = 0. s > 0 has Laplacians. */
void sd_filtered_stokeslet(const sd_filtered *f, int s, double *I, double *J);

/* value [SD_RADIALS] at distance r >= 0 */
void sd_radial(const sd_ewald *e, double r, double *value);

/* Polynomials on [0, range] in t = 2 (r/range)^2 - 1:
 *   width                                       3, or 6 with torques: which functions count
 *   coefficient [SD_RADIALS][SD_RADIAL_TERMS]   of 1, t, t^2 ...
 * Returns their degree: the smallest with which what the functions add to a velocity is right to a tenth of
 * the tolerance, relative to I_0(0), and what all neighbours add to half of it, relative to 1/(6 pi a). In
 * an open box where waves end at a band, which no sd_radial_tail is added to, I_0, I_1 and I_2 have it, less
 * than they are by what it is over the ball of the range. */
int sd_radial_fit(const sd_ewald *e, int width, double *coefficient);

/* What the near part leaves out beyond its range, summed over all directions and distances:
 *   tail [3]   C_0, C_1, C_2 of  U_i += 1/V sum_j (C_0 - (b_i + b_j) C_1 + b_i b_j C_2) F_j,
 *              W_i += 1/V sum_j C_1 T_j / 4                                 times eta
 * Forces that are equal add it up, so that it would be far larger than the error of random ones. */
void sd_radial_tail(const sd_ewald *e, double *tail);

SD_END_C
#endif
