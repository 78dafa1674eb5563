/* Who is far from all marked particles, as the inside of a fluid is from its surface: found by cells, in a
 * time that goes with the number of particles. */
#ifndef SD_SPH_DEEP_H
#define SD_SPH_DEEP_H

#include <stddef.h>

#include "sd_extern_c.h"

SD_BEGIN_C

/* deep [n]: 1 only where no marked particle of x4 [4 all], marked [all], is within reach > 0. Some that are
 * as far are 0 too. grid [SD_SPH_DEEP_CELLS(all)]: the caller's scratch. */
#define SD_SPH_DEEP_CELLS(all) ((size_t) (all) + 64)
void sd_sph_find_deep(int all, int n, const double *x4, const char *marked, double reach,
                      char *grid, char *deep);

SD_END_C
#endif
