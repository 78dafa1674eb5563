/* Pair tensors: the velocity of sphere i from the force on the fluid at sphere j, both translational.
 *
 *   U_i = M F_j,   M = 1/(6 pi eta) [ f I + g rhat rhat^T ],   r = x_i - x_j,  R = |r|
 *
 * f and g depend on R and the two radii only and have the unit 1/length. Symmetric under exchange of i and j. */
#ifndef SD_TENSOR_H
#define SD_TENSOR_H

#include <math.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SD_PI 3.14159265358979323846

typedef enum { SD_TENSOR_RPY, SD_TENSOR_OSEEN } sd_tensor;

/* Rotne-Prager-Yamakawa for any two radii and any distance.
 *   R  >= 0   centre distance          length
 *   ai, aj    radii > 0                length
 *   f, g      out                      1/length
 * With A the larger radius, b the smaller, d = A - b:
 *   R > A + b        f = 3/(4R) [1 + (A^2 + b^2)/(3 R^2)],   g = 3/(4R) [1 - (A^2 + b^2)/R^2]
 *   d < R <= A + b   g = 3 t^2 (1+q)^2 / (32 R A b),   f = [b - t(1-q)/4]/(A b) - g/3,   t = R - d, q = d/R
 *   R <= d           f = 1/A, g = 0     (b inside A, or both at one point)
 * The middle line is the published form (16 R^3 (A+b) - (d^2 + 3R^2)^2)/(32 R^3), 3 (d^2 - R^2)^2/(32 R^3), over A b,
 * rearranged so that no term is larger than b: nothing cancels when b << A, nothing underflows when R -> 0.
 * The matrix of all pairs, with 1/a on the diagonal, is positive semidefinite for every configuration. Never fails.
 * Source: Rotne & Prager 1969; Yamakawa 1970; unequal and overlapping spheres: Zuk, Wajnryb, Mizerski & Szymczak 2014. */
static inline void sd_rpy_radial(double R, double ai, double aj, double *f, double *g)
{
  const double sum = ai + aj;
  if (R > sum) {
    const double c = 0.75 / R, m = (ai * ai + aj * aj) / (R * R);
    *f = c * (1.0 + m / 3.0);
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

/* Oseen's tensor of point forces, for comparison: f = g = 3/(4R), whatever the radii. Not positive definite when spheres
 * are closer than about 1.5 radii, and infinite at R = 0. */
static inline void sd_oseen_radial(double R, double *f, double *g)
{
  *f = *g = 0.75 / R;
}

/* The whole 3x3 block, row-major, velocity/force. r [3] = x_i - x_j; eta > 0 dynamic viscosity. Never fails for RPY. */
void sd_tensor_uf(sd_tensor kind, const double r[3], double ai, double aj, double eta, double M[9]);

#ifdef __cplusplus
}
#endif
#endif
