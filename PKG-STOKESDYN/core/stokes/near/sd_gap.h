/* The smallest gap between spheres that are not of one body. */
#ifndef SD_GAP_H
#define SD_GAP_H

#include <stdint.h>

#include "sd_status.h"

SD_BEGIN_C

/* xi = 2 (R - a_i - a_j) / (a_i + a_j), the least over i < n and j < n_all whose centres are within
 * reach; negative for spheres that overlap, INFINITY: there are none so near.
 *   x [3 n_all], a [n_all]; body [n_all]: spheres of one body, not 0, have no gap. NULL: all free
 * SD_OK or SD_ENOMEMORY. */
sd_status sd_smallest_gap(const double *x, const double *a, const int64_t *body, int n, int n_all,
                          double reach, double *gap);

SD_END_C
#endif
