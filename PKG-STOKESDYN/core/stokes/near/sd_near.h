/* The close pairs of spheres, for lubrication. */
#ifndef SD_NEAR_H
#define SD_NEAR_H

#include "sd_neighbor.h"

SD_BEGIN_C

/* Pairs with R <= reach (a_i + a_j)/2, each once: in row i < n its partners j > i among spheres
 * 0 ... n_all - 1, the n of this rank and their ghosts. reach is in units of the mean radius of the
 * pair, 2 at contact, and lubrication up to a gap of xi mean radii wants 2 + xi. Radius 0: takes no
 * part. O(n_all + pairs) for each power of two between the smallest and the largest radius. SD_OK
 * or SD_ENOMEMORY. */
sd_status sd_near_once(sd_neighbors *list, const sd_spheres *s, int n, int n_all, double reach);

SD_END_C
#endif
