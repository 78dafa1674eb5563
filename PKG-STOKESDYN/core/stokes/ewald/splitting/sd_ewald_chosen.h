/* What is chosen of an Ewald sum (sd_ewald.h): the numbers that its parts are made from. */
#ifndef SD_EWALD_CHOSEN_H
#define SD_EWALD_CHOSEN_H

#include "sd_ewald_box.h"
#include "sd_wall.h"

/* Images in a plane wall, of an open box: they have a smooth part of their own on the same grid
 * (sd_image_wave.h), and what it leaves of a pair ends at a range, from a sphere to an image. */
typedef struct {
  /* sign 0: there is no wall */
  sd_wall wall;
  double xi, range;
  /* 0: the filters are those of a Gaussian; else their waves end here, 1/length (sd_image_wave.h), and xi
   * is 0 */
  double band;
} sd_ewald_images;

/* A box that is periodic in two directions alone (sd_slab.h), as a periodic one that is taller: the
 * direction that is not, and how many planes of the grid across it hold something; 0: all, and there is
 * no such direction */
typedef struct {
  int across, planes;
} sd_ewald_slab;

/* What an engine is made from. Ready after sd_ewald_choose; all lengths as given. */
typedef struct {
  sd_ewald_box box;
  /* no spheres: 0, and the rest is not read */
  double count;
  /* splitting, 1/length; its reference radius; where the near part ends, centre to centre; the
   * largest sphere */
  double xi, a_ref, range, largest;
  /* 0: H is a Gaussian's; else waves end here, 1/length (sd_radial.h), and velocities are wanted of spheres
   * (sized) or at points, where a_ref is of the sources alone */
  double band;
  int sized;
  /* near pairs, windows, grid and its transforms are of floats (SD_EWALD_SINGLE) */
  int single;
  /* how far ghosts must reach: range, or that of images */
  double reach;
  /* grid points of the box each way; those of an open box are an eighth of the grid, which is
   * twice as large; no spacing is larger than this one, which an open box has */
  int grid[3];
  double spacing;
  /* the window: so many grid points each way, its parameter (Kaiser-Bessel) and its bend (sd_window.h) */
  int points;
  double beta, bend;
  /* what was asked for: rms error of U over rms of F/(6 pi eta a) */
  double tolerance;
  /* xi of a smoother splitting, whose waves these spheres have too: this one's are less by them
   * (sd_ewald_levels.h). 0: there is none */
  double taken;
  /* both parts are positive: xi times the largest radius is at most this. 0: nobody asked for that */
  double positive;
  sd_ewald_images images;
  sd_ewald_slab slab;
} sd_ewald;

#endif
