/* Two rigid spheres in unbounded fluid, exactly: sums over the modes of bispherical coordinates.
 * For the table of sd_two_sphere.h and for tests: milliseconds, seconds at gaps of 1e-6. */
#ifndef SD_TWO_SPHERE_EXACT_H
#define SD_TWO_SPHERE_EXACT_H

#include "sd_pair_resistance.h"

/* a1, a2 > 0; gap = centre distance - a1 - a2 > 0. Never fails; needs no memory. Where long double
 * has 64 bits: 1e-10 of each function (or of 1e-3 of its scale) for gaps from 1e-4 of the smaller
 * radius on and 1e-8 below, ratios to 100. Symmetry is not put in: asymmetry, if not NULL, is the
 * largest difference between two numbers that reciprocity makes equal, over the larger of all those
 * of its kind. */
sd_pair_resistance sd_two_sphere_exact(double a1, double a2, double gap, double *asymmetry);

#endif
