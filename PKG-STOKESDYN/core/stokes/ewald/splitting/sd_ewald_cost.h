/* What a product by Ewald sums costs, so that small open clouds go without them. Counted, not
 * timed: every machine, any number of ranks and a restarted run choose alike. */
#ifndef SD_EWALD_COST_H
#define SD_EWALD_COST_H

#include "sd_ewald_chosen.h"

SD_BEGIN_C

/* In pairs of the sum over all pairs, which costs count^2 of them: near pairs, window points and
 * grid points, each weighed as it was measured (one core, AVX-512, a pair 0.44 ns): within a third
 * for 4000 and 8000 spheres in an open box, at 1e-3 and at 1e-6. Equal radii, width 3; with torques
 * both ways of summing cost about 2.5 times as much. Above a wall all pairs cost SD_PAIR_AT_WALL times
 * as much, and here the images are in. */
double sd_ewald_cost(const sd_ewald *e);

/* Of it windows and grid; and how many pairs of so many targets and sources are within a range */
double sd_ewald_grid_cost(const sd_ewald *e);
double sd_ewald_near_pairs(const sd_ewald *e, double targets, double sources, double range);

/* In a slab (sd_slab.h) with so many walls, whose centres span so much across it, in the same unit */
double sd_ewald_slab_cost(const sd_ewald *e, double span, int walls);

/* With as many spheres or fewer all pairs cost less, whatever the splitting: the smallest windows, of
 * 4^3 points, cost that much a sphere. */
enum { SD_EWALD_FEWEST = 192 };
#define SD_PAIR_AT_WALL 2.6

SD_END_C
#endif
