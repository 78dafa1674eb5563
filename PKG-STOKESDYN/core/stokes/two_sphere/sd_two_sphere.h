/* What two spheres near contact resist more than the Rotne-Prager-Yamakawa model knows. */
#ifndef SD_TWO_SPHERE_H
#define SD_TWO_SPHERE_H

#include "sd_pair_resistance.h"
#include "sd_status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Largest ratio of two radii, and largest xi = gap over the mean radius: there the centres are five
 * mean diameters apart, and a pair is within a few thousandths of what the model has. */
#define SD_TWO_SPHERE_LARGEST_RATIO 100.0
#define SD_TWO_SPHERE_LARGEST_XI 8.0

/* What the functions are read from: tables for a range of ratios, ready after create. */
typedef struct sd_two_sphere sd_two_sphere;

/* largest_ratio >= 1: of the two radii of any pair. One ratio, 1, needs 12 kB and is twice as fast
 * as others; all of them need 1.2 MB. SD_OK; SD_EOUTSIDE: above SD_TWO_SPHERE_LARGEST_RATIO;
 * SD_ENOMEMORY. */
sd_status sd_two_sphere_create(double largest_ratio, sd_two_sphere **out);
void sd_two_sphere_free(sd_two_sphere *t);

/* full = D = R_exact - R_rpy of two spheres alone, relative = Q^T D Q (sd_pair_resistance.h), for a
 * viscosity of 1. xi: the centre distance is a1 + a2 + xi (a1 + a2)/2. Both are positive
 * semidefinite: the flow of the RPY model is the one of least dissipation among more flows than the
 * exact one. D is the exact one within 1e-8 (to ratio 10) or 1e-7 Stokes drags of the smaller
 * sphere; what is lost of definiteness by that is less than 1e-8 of the largest eigenvalue, beyond
 * ratio 10, where all of D is small, 1e-8 Stokes drags. SD_OK; SD_EOUTSIDE: a ratio larger than that
 * created for, xi not in (0, SD_TWO_SPHERE_LARGEST_XI]. */
sd_status sd_two_sphere_correction(const sd_two_sphere *t, double a1, double a2, double xi,
                                   sd_pair_resistance *full, sd_pair_resistance *relative);

#ifdef __cplusplus
}
#endif
#endif
