/* Sums of two levels, for few spheres that are far larger than the rest: one splitting would have a
 * range of many of the small radii, and more near pairs than a sum over all.
 *
 *   M_ij = M1_ij     both small: by the first splitting, as if there were no others
 *          M2_ij     else: by the second, which is smoother and has a range of large radii
 *
 * The waves of the second are made by all spheres and felt by all, so that those of the first are
 * less by them (sd_ewald.h: taken).
 *
 * What it is worth: of 3000 spheres with two of 30 radii among them a product takes 0.18 of the time
 * of one level at 1e-3 and 0.22 at 1e-6, and placing them 0.05 (unittest/bench, three-thousand). */
#ifndef SD_EWALD_LEVELS_H
#define SD_EWALD_LEVELS_H

#include "sd_ewald.h"

SD_BEGIN_C

/* The second level. split.count: all spheres. Zero, and not read, where there is one level alone */
typedef struct {
  /* spheres of this radius and larger belong to it: so many. 0: there is no second level */
  double from, count;
  sd_ewald split;
} sd_ewald_level;

/* The rule of sd_ewald_choose, with a second level where that costs less: then `first` is of the
 * small spheres alone. Both levels are Gaussians. Octaves of the sizes that are left 0: one level.
 * As sd_ewald_choose. */
sd_status sd_ewald_levels_choose(const sd_ewald_box *box, const sd_ewald_sizes *sizes, int width,
                                 double tolerance, sd_ewald *first, sd_ewald_level *second);

/* The one that costs least of all that have two levels, whatever one level costs. SD_ENOMEMORY:
 * there is none, since octaves are 0, all spheres are in one, or the first would be as smooth. */
sd_status sd_ewald_levels_best(const sd_ewald_box *box, const sd_ewald_sizes *sizes, int width,
                               double tolerance, sd_ewald *first, sd_ewald_level *second);

/* sd_ewald_cost of both, or of the first alone */
double sd_ewald_levels_cost(const sd_ewald *first, const sd_ewald_level *second);

SD_END_C
#endif
