/* Who is near marked particles, and who is deep, as the inside of a fluid is below its surface: found by
 * cells, in a time that goes with the number of particles. */
#ifndef SD_SPH_DEEP_H
#define SD_SPH_DEEP_H

#include <stddef.h>

#include "sd_extern_c.h"

SD_BEGIN_C

/* near [n]: those of the first n that have a marked particle of x4 [4 all], marked [all], within reach > 0,
 * in their order, and some that are further; the others are deep. Returns how many.
 * grid [SD_SPH_DEEP_CELLS(all)]: the caller's scratch. */
#define SD_SPH_DEEP_CELLS(all) ((size_t) (all) + 128)
int sd_sph_find_near(int all, int n, const double *x4, const char *marked, double reach, char *grid,
                     int *near);

SD_END_C
#endif
