/* Who is near marked particles, and who is deep, as the inside of a fluid is below its surface: found by
 * cells, in a time that goes with the number of particles. */
#ifndef SD_SPH_DEEP_H
#define SD_SPH_DEEP_H

#include <stddef.h>
#include <stdint.h>

#include "sd_extern_c.h"

SD_BEGIN_C

/* near [n]: those of the first n that have a marked particle of x4 [4 all], one whose last number is
 * above 0, within reach > 0, in their order, and some that are further, nearly all within 1.3 reach; the
 * others are deep. Returns how many. dimension 2: cells have no z. scratch [SD_SPH_DEEP_SCRATCH(all)]: of
 * the caller. */
#define SD_SPH_DEEP_SCRATCH(all) (2 * ((size_t) (all) + 128))
int sd_sph_find_near(int dimension, int all, int n, const double *x4, double reach, uint64_t *scratch,
                     int *near);

SD_END_C
#endif
