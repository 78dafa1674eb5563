/* What two spheres near contact resist more than the Rotne-Prager-Yamakawa model knows. */
#ifndef SD_TWO_SPHERE_H
#define SD_TWO_SPHERE_H

#include "sd_pair_resistance.h"
#include "sd_status.h"

SD_BEGIN_C

/* Largest ratio of two radii, and xi = gap over the mean radius: the smallest is below all
 * roughness, at the largest the centres are five mean diameters apart, and a pair is within a few
 * thousandths of what the model has. */
#define SD_TWO_SPHERE_LARGEST_RATIO 100.0
#define SD_TWO_SPHERE_SMALLEST_XI 1e-8
#define SD_TWO_SPHERE_LARGEST_XI 8.0

/* What the functions are read from: tables for a range of ratios, ready after create. */
typedef struct sd_two_sphere sd_two_sphere;

/* largest_ratio >= 1: of the two radii of any pair. Equal spheres are read several times as fast as
 * others; ratio 1 alone needs 40 kB, all of them 3.6 MB. SD_OK; SD_EOUTSIDE: above
 * SD_TWO_SPHERE_LARGEST_RATIO; SD_ENOMEMORY. */
sd_status sd_two_sphere_create(double largest_ratio, sd_two_sphere **out);
void sd_two_sphere_free(sd_two_sphere *t);

/* R = p D + q Q^T D Q, D = R_exact - R_rpy of two spheres alone, Q^T D Q what it does to
 * their relative motion (sd_pair_resistance.h), for a viscosity of 1. xi: the centre distance is
 * a1 + a2 + xi (a1 + a2)/2. p, q >= 0. Both parts are positive semidefinite: the flow of the RPY
 * model is the one of least dissipation among more flows than the exact one. D is the exact one
 * within 2e-8 (to ratio 10) or 1e-7 Stokes drags of the smaller sphere, or of D where that is
 * larger; what is lost of definiteness by that is less than 1e-8 of the largest eigenvalue, beyond
 * ratio 10, where all of D is small, 1e-8 Stokes drags. Q^T D Q resists no rigid motion, to
 * rounding.
 * SD_OK; SD_EOUTSIDE: a ratio larger than that created for, xi not in [SD_TWO_SPHERE_SMALLEST_XI,
 * SD_TWO_SPHERE_LARGEST_XI]. */
sd_status sd_two_sphere_correction(const sd_two_sphere *t, double a1, double a2, double xi,
                                   double p, double q, sd_pair_resistance *R);

SD_END_C
#endif
