/* What two spheres near contact resist more than the Rotne-Prager-Yamakawa model knows. */
#ifndef SD_TWO_SPHERE_H
#define SD_TWO_SPHERE_H

#include "sd_pair_resistance.h"
#include "sd_status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What the functions are read from; ready after create. */
typedef struct sd_two_sphere sd_two_sphere;

/* largest_ratio >= 1: of the two radii of any pair. SD_OK; SD_EOUTSIDE: above 100; SD_ENOMEMORY. */
sd_status sd_two_sphere_create(double largest_ratio, sd_two_sphere **out);
void sd_two_sphere_free(sd_two_sphere *t);

/* full = D = R_exact - R_rpy of two spheres alone, relative = Q^T D Q (sd_pair_resistance.h), for a
 * viscosity of 1. xi > 0: gap over the mean radius, the centre distance is a1 + a2 + xi (a1 + a2)/2.
 * Both are positive semidefinite: the flow of the RPY model is the one of least dissipation among
 * more flows than the exact one. SD_OK; SD_EOUTSIDE: radii or gap are not what was created for. */
sd_status sd_two_sphere_correction(const sd_two_sphere *t, double a1, double a2, double xi,
                                   sd_pair_resistance *full, sd_pair_resistance *relative);

#ifdef __cplusplus
}
#endif
#endif
