/* The loops over pairs that the kernels of the product share. For sources only. */
#ifndef SD_PRODUCT_LOOPS_H
#define SD_PRODUCT_LOOPS_H

#include "sd_lanes.h"
#include "sd_product_internal.h"

/* Adds what the target i (and, for some kernels, those after it) gets from the vectors of sources
 * j0 ... j1 - 1; both: and these from it */
typedef void tile_sum(int both, const sd_packed *p, int i, int j0, int j1);

/* Sources are taken in chunks that stay in the first-level cache while all targets pass. With
 * torques: sixteen columns of so many spheres are 16 KiB, half of it. */
enum { CHUNK = 256, GRAND_CHUNK = 128 };

/* Groups of LANES columns: does the pair of a group with any later one belong to this part? In
 * turn, there and back, so that the sums of (groups - I) over a part's groups are equal. */
INLINE int mine(int group, int part, int parts)
{
  const int turn = group % (2 * parts);
  return turn == part || turn == 2 * parts - 1 - part;
}

/* All pairs of this part, `targets` at a time. A group of LANES targets meets itself one-sidedly, as
 * its own lanes are among the sources, and every later group once for both: a block serves two
 * spheres, which is what makes this about 1.4 times as fast as a loop over all targets. */
INLINE void share_of_pairs(const sd_packed *p, int part, int parts, int chunk, int targets,
                           tile_sum *tile)
{
  for (int c = 0; c < p->padded; c += chunk) {
    const int end = c + chunk < p->padded ? c + chunk : p->padded;
    for (int i = 0; i < end; i += LANES) {
      if (!mine(i / LANES, part, parts)) continue;
      const int from = i + LANES > c ? i + LANES : c;
      for (int t = i; t < i + LANES; t += targets) {
        if (i >= c) tile(0, p, t, i, i + LANES);
        if (from < end) tile(1, p, t, from, end);
      }
    }
  }
}

/* The next LANES neighbours from k on; what is missing before end is the row that stands for
 * nothing. */
INLINE const int *neighbors(const sd_pairs *pairs, long k, long end, int nothing, int *rest)
{
  const int *j = pairs->neighbor + k;
  if (end - k >= LANES) return j;
  for (int l = 0; l < LANES; l++) rest[l] = k + l < end ? j[l] : nothing;
  return rest;
}

/* One vector of nothing but the sphere itself */
INLINE const int *itself(int i, int nothing, int *rest)
{
  for (int l = 0; l < LANES; l++) rest[l] = l == 0 ? i : nothing;
  return rest;
}

#endif
