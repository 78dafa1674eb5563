/* The window that takes forces to the grid and velocities from it (Kaiser-Bessel):
 *
 *   phi(s) = I_0(beta sqrt(1 - tau^2))/I_0(beta),   tau = 2 s/P,   |s| <= P/2 grid spacings
 *
 * in each direction, P points wide. It is evaluated as a polynomial for each point, and its derivatives are
 * those of the polynomials. Sums over a sphere's points would depend a little on where it stands: they are
 * multiplied by what is nearly 1, a constant, with which flows that are the same everywhere reach it without
 * error, or a parabola, with which linear and parabolic ones do, as that of all spheres of an open box under
 * equal forces. */
#ifndef SD_WINDOW_H
#define SD_WINDOW_H

#include "sd_extern_c.h"

SD_BEGIN_C

/* The widest window; terms of the longest polynomial; columns: points up to whole vectors */
enum {
  SD_WINDOW_MOST_POINTS = 20,
  SD_WINDOW_TERMS = 24,
  SD_WINDOW_COLUMNS = (SD_WINDOW_MOST_POINTS + 7) / 8 * 8
};

/* coefficient [m][k]: of v^m at point k; v = 2u - 1 in [-1, 1], where the sphere at grid coordinate
 * s has u = s - P/2 - floor(s - P/2), and its first point is floor(s - P/2) + 1. Points beyond P:
 * 0. With d/dv of the polynomial, d phi/ds = -2 d/dv: s is the grid's less the sphere's. */
typedef struct {
  int points, degree;
  double coefficient[SD_WINDOW_TERMS][SD_WINDOW_COLUMNS];
} sd_window;

/* Polynomials as long as the tolerance needs. order: 0, a constant; 2, a parabola, by which windows that are
 * differentiated twice would mistake short waves more. bend: phi of a sphere that stands on a point of the
 * grid has bend s^2 phi more, less a constant; half a spacing further as much less. */
void sd_window_fit(int points, double beta, int order, double bend, double tolerance, sd_window *w);

/* sum over the points of phi exp(-i theta s), theta = k h, as an integral: its transform, in grid
 * spacings */
double sd_window_transform(int points, double beta, double theta);

/* [n] 1 over it at waves 0 ... n - 1 of 2 (n - 1), less the last, which has no partner: 0. malloc'ed;
 * NULL: out of memory */
double *sd_window_inverse(int points, double beta, int n);

/* d/dtheta of its logarithm, for |theta| <= pi */
double sd_window_slope(int points, double beta, double theta);

SD_END_C
#endif
