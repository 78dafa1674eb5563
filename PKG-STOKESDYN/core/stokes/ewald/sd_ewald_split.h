/* A sum over periodic images, split: what sd_ewald.h chooses, and its cost (sd_ewald_cost.h) and
 * all who sum go by. */
#ifndef SD_EWALD_SPLIT_H
#define SD_EWALD_SPLIT_H

#include "sd_wall.h"

SD_BEGIN_C

/* The box with edges (lx 0 0), (xy ly 0), (xz yz lz). Spheres may stand outside of a periodic one;
 * an open one holds the centres of all and has no tilt: nothing is beyond it but fluid.
 *   edge [3]   lx ly lz      length, > 0
 *   tilt [3]   xy xz yz      length */
typedef struct {
  int periodic;
  double origin[3], edge[3], tilt[3];
} sd_ewald_box;

/* length^3 */
static inline double sd_ewald_volume(const sd_ewald_box *box)
{
  return box->edge[0] * box->edge[1] * box->edge[2];
}

/* 2 pi times the reciprocal edges, 1/length: row d is across the other two edges and has 2 pi along
 * edge d, so that the wave of numbers n has k = n_1 k[0] + n_2 k[1] + n_3 k[2]. */
void sd_ewald_reciprocal(const sd_ewald_box *box, double k[3][3]);

/* The second level: a splitting for the spheres of radius `from` and larger. They meet each other
 * and all the rest by it, the rest each other by the first. */
typedef struct {
  /* 0: there is no such level */
  double from, count;
  double xi, range, largest, spacing, beta;
  int grid[3], points;
} sd_ewald_large;

/* Images in a plane wall, of an open box: they have a smooth part of their own on the same grid
 * (sd_image_wave.h), and what it leaves of a pair ends at a range, from a sphere to an image. */
typedef struct {
  /* sign 0: there is no wall */
  sd_wall wall;
  double xi, range;
} sd_ewald_images;

/* What an engine is made from. Ready after sd_ewald_choose; all lengths as given. */
typedef struct {
  sd_ewald_box box;
  /* no spheres: 0, and the rest is not read */
  double count;
  /* splitting, 1/length; its reference radius; where the near part ends, centre to centre; the
   * largest sphere */
  double xi, a_ref, range, largest;
  /* how far ghosts must reach: range, or that of images */
  double reach;
  /* grid points of the box each way; those of an open box are an eighth of the grid, which is
   * twice as large; no spacing is larger than this one, which an open box has */
  int grid[3];
  double spacing;
  /* the window: so many grid points each way, and its parameter (Kaiser-Bessel) */
  int points;
  double beta;
  /* what was asked for: rms error of U over rms of F/(6 pi eta a) */
  double tolerance;
  /* With it all that is above, but for count and a_ref, is of the smaller spheres. H of the first
   * level is then less that of the second, whose waves all spheres make. */
  sd_ewald_large large;
  sd_ewald_images images;
} sd_ewald;

SD_END_C
#endif
