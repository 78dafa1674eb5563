/* The close pairs of spheres, whatever engine sums the mobility: for lubrication and for
 * preconditioners. */
#ifndef SD_NEAR_H
#define SD_NEAR_H

#include "sd_neighbor.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Directed pairs with R <= reach (a_i + a_j)/2: reach is in units of the mean radius of the pair, 2
 * at contact, and lubrication up to a gap of xi mean radii wants 2 + xi. Row t is target begin + t
 * of spheres 0 ... n_all - 1, t < n; its sources are any of them but itself: this rank's spheres
 * with their ghosts (begin 0), or this rank's part of the spheres of all. Radius 0: takes no part.
 * O(n_all + pairs) for each power of two between the smallest and the largest radius. SD_OK or
 * SD_ENOMEMORY. */
sd_status sd_near_find(sd_neighbors *list, const sd_spheres *s, int begin, int n, int n_all,
                       double reach);
/* The same pairs, each once: row i < n, its sources j > i. */
sd_status sd_near_once(sd_neighbors *list, const sd_spheres *s, int n, int n_all, double reach);

#ifdef __cplusplus
}
#endif
#endif
