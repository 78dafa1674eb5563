/* Pair tensors: velocity U and angular velocity W of sphere i from the force F and the torque T on
 * the fluid at sphere j, r = x_i - x_j, R = |r|, rhat = r/R.
 *
 *   U_i = 1/(6 pi eta) [ f I + g rhat rhat^T ] F_j  +  1/(8 pi eta) c_ji T_j x rhat
 *   W_i = 1/(8 pi eta) c_ij F_j x rhat  +  1/(8 pi eta) [ f' I + g' rhat rhat^T ] T_j
 *
 * f, g (1/length), f', g' (1/length^3), c (1/length^2) depend on R and the two radii only. f, g,
 * f', g' are the same when i and j are exchanged, c is not: c_ij stands for the sphere i that turns
 * and the sphere j on which the force acts. */
#ifndef SD_TENSOR_H
#define SD_TENSOR_H

#include <math.h>

#include "sd_constants.h"
#include "sd_extern_c.h"

SD_BEGIN_C

typedef enum { SD_TENSOR_RPY, SD_TENSOR_OSEEN } sd_tensor;

/* Rotne-Prager-Yamakawa for any two radii and any distance.
 *   R  >= 0   centre distance          length
 *   ai, aj    radii > 0                length
 *   f, g      out                      1/length
 * With A the larger radius, b the smaller, d = A - b:
 *   R > A + b        f = 3/(4R) [1 + (A^2 + b^2)/(3 R^2)],   g = 3/(4R) [1 - (A^2 + b^2)/R^2]
 *   d < R <= A + b   g = 3 t^2 (1+q)^2 / (32 R A b),   f = [b - t(1-q)/4]/(A b) - g/3,
 *                    t = R - d,   q = d/R
 *   R <= d           f = 1/A, g = 0     (b inside A, or both at one point)
 * The middle line is the published form, over A b,
 *   f = (16 R^3 (A+b) - (d^2 + 3R^2)^2)/(32 R^3),   g = 3 (d^2 - R^2)^2/(32 R^3)
 * rearranged so that no term is larger than b: nothing cancels when b << A, nothing underflows when
 * R -> 0.
 * The matrix of all pairs, with 1/a on the diagonal, is positive semidefinite for every
 * configuration. Never fails.
 * Source: Rotne & Prager 1969; Yamakawa 1970; unequal and overlapping spheres: Zuk, Wajnryb,
 * Mizerski & Szymczak 2014. */
static inline void sd_rpy_radial(double R, double ai, double aj, double *f, double *g)
{
  const double sum = ai + aj;
  if (R > sum) {
    const double inv = 1.0 / R, c = 0.75 * inv, m = (ai * ai + aj * aj) * (inv * inv);
    *f = c * (1.0 + m * (1.0 / 3.0));
    *g = c * (1.0 - m);
    return;
  }
  const double A = ai > aj ? ai : aj, b = ai > aj ? aj : ai, d = A - b;
  if (R <= d || R == 0.0) {
    *f = 1.0 / A;
    *g = 0.0;
    return;
  }
  const double t = R - d, q = d / R, s = t * (1.0 + q);
  *g = 3.0 * s * (s / R) / (32.0 * A * b);
  *f = (b - 0.25 * t * (1.0 - q)) / (A * b) - *g / 3.0;
}

/* What two spheres resist of their approach by the model, beyond their drags:
 *   6 pi eta [ 1/(1/ai + 1/aj - 2 (f + g)) - 1/(1/ai + 1/aj) ]   force over relative velocity, >= 0
 * R  >= ai + aj. */
static inline double sd_rpy_approach(double R, double ai, double aj, double eta)
{
  double f, g;
  sd_rpy_radial(R, ai, aj, &f, &g);
  const double apart = 1.0 / ai + 1.0 / aj, both = apart - 2.0 * (f + g);
  return 6.0 * SD_PI * eta * (1.0 / both - 1.0 / apart);
}

/* Angular velocity from torque: f' and g' of the Rotne-Prager-Yamakawa model, any two radii, any
 * distance. A, b, d, t, q as above, u = A + b - R:
 *   R > A + b        f' = -1/(2 R^3),   g' = 3/(2 R^3)
 *   d < R <= A + b   g' = 3 t^2 (1+q)^2 [6Ab - t(R+d)] / (64 R A^3 b^3)
 *                    3f' + g' = 3 u^2 [4q(b+t) + (1-q)(4b+t)] / (16 A^3 b^3)
 *   R <= d           f' = 1/A^3, g' = 0
 * The published overlap form is, over 64 R^3 A^3 b^3,
 *   f' = 5R^6 - 27R^4 (A^2+b^2) + 32R^3 (A^3+b^3) - 9R^2 (A^2-b^2)^2 - d^4 (A^2+4Ab+b^2)
 *   g' = 3 (d^2-R^2)^2 (A^2+4Ab+b^2-R^2)
 * Its trace 3f' + g' is 9/(4 pi A^3 b^3) times the volume of the lens that the spheres share, u^2
 * (R^2 + 2R(A+b) - 3d^2) pi/(12R). With R = d + t and A = d + b this lens and g' have only terms of
 * the size of b and of one sign (6Ab against at most 4Ab). Source: Wajnryb, Mizerski, Zuk &
 * Szymczak 2013; Zuk, Wajnryb, Mizerski & Szymczak 2014. */
static inline void sd_rpy_radial_wt(double R, double ai, double aj, double *f, double *g)
{
  const double A = ai > aj ? ai : aj, b = ai > aj ? aj : ai, d = A - b;
  if (R > ai + aj) {
    *g = 1.5 / (R * R * R);
    *f = -*g / 3.0;
    return;
  }
  if (R <= d || R == 0.0) {
    *f = 1.0 / (A * A * A);
    *g = 0.0;
    return;
  }
  const double t = R - d, q = d / R, p = t / R, s = t * (1.0 + q), u = 2.0 * b - t; /* p = 1 - q */
  const double A3b3 = (A * b) * (A * b) * (A * b);
  *g = 3.0 * s * p * (1.0 + q) * (6.0 * A * b - t * (R + d)) / (64.0 * A3b3);
  *f = u * u * (4.0 * q * (b + t) + p * (4.0 * b + t)) / (16.0 * A3b3) - *g / 3.0;
}

/* Angular velocity of i from the force at j: c_ij of the Rotne-Prager-Yamakawa model. A, b, d, t, q
 * as above.
 *   R > A + b            c = 1/R^2, half the curl of the Stokeslet
 *   overlap, ai >= aj    c = (1+q)^2 [4bd + t(8b-3t)] / (16 A^3 b)
 *   overlap, ai < aj     c = (1-q)^2 [4d(3b-t) + t(8b-3t)] / (16 A b^3)
 *   j inside i           c = R/A^3        i inside j: c = 0
 * The overlap lines are the published (ai-aj+R)^2 [aj^2 + 2aj(ai+R) - 3(ai-R)^2] / (16 ai^3 aj R^2)
 * with R = d + t and A = d + b, so that every term is positive (t <= 2b). Sources as above. */
static inline double sd_rpy_radial_wf(double R, double ai, double aj)
{
  const double A = ai > aj ? ai : aj, b = ai > aj ? aj : ai, d = A - b;
  if (R > ai + aj) return 1.0 / (R * R);
  if (R <= d || R == 0.0) return ai > aj ? R / (A * A * A) : 0.0;
  const double t = R - d, q = d / R, p = t / R;
  if (ai >= aj)
    return (1.0 + q) * (1.0 + q) * (4.0 * b * d + t * (8.0 * b - 3.0 * t)) / (16.0 * A * A * A * b);
  return p * p * (4.0 * d * (3.0 * b - t) + t * (8.0 * b - 3.0 * t)) / (16.0 * A * b * b * b);
}

/* Oseen's tensor of point forces, for comparison: f = g = 3/(4R), whatever the radii. Not positive
 * definite when spheres are closer than about 1.5 radii, and infinite at R = 0. */
static inline void sd_oseen_radial(double R, double *f, double *g)
{
  *f = *g = 0.75 / R;
}

/* Of either */
static inline void sd_tensor_radial(sd_tensor kind, double R, double ai, double aj, double *f, double *g)
{
  if (kind == SD_TENSOR_RPY)
    sd_rpy_radial(R, ai, aj, f, g);
  else
    sd_oseen_radial(R, f, g);
}

/* The whole 3x3 block, row-major, velocity/force. r [3] = x_i - x_j; eta > 0 dynamic viscosity.
 * Never fails for RPY. */
void sd_tensor_uf(sd_tensor kind, const double r[3], double ai, double aj, double eta, double M[9]);

/* The whole 6x6 block of the Rotne-Prager-Yamakawa model, row-major: rows U_i W_i, columns F_j T_j.
 * M(j,i) = M(i,j)^T, and the matrix of all pairs, with r = 0 and ai = aj on the diagonal, is
 * positive semidefinite for every configuration. Never fails. */
void sd_tensor_grand(const double r[3], double ai, double aj, double eta, double M[36]);

SD_END_C
#endif
