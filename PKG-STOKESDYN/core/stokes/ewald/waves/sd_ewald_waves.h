/* The wave part of an Ewald sum: from the forces on this rank's spheres to what those of all ranks
 * do to them.
 *
 *   F --spread--> grid --transform, multiply, transform--> grid --interpolate--> u
 *
 * Each rank spreads and interpolates its own spheres on a brick of the grid; slabs of it are
 * transformed by turns (sd_grid.h). Slabs are planes of the first direction. Where ranks are cut
 * along another one, and the box has no tilt, all of this happens in a frame turned cyclically, so
 * that most of a brick is in the slab of its own rank. Forces and velocities keep the components of the
 * box: waves alone find them in the order of the frame (sd_grid.turn). */
#ifndef SD_EWALD_WAVES_H
#define SD_EWALD_WAVES_H

#include "sd_ewald_kernels.h"
#include "sd_ewald_runs.h"
#include "sd_grid.h"
#include "sd_random.h"
#include "sd_status.h"
#include "sd_wave.h"
#include "sd_world.h"

SD_BEGIN_C

/* Zero-initialise; sd_ewald_waves_free in the end. */
typedef struct {
  /* in the frame, whose direction d is d + turn of the box */
  sd_ewald ewald;
  int turn, width;
  const struct sd_ewald_kernels *kernels;
  sd_window window;
  sd_wave wave;
  sd_grid grid;
  sd_spreading spreading;
  /* [n] which spheres, where they stand (sd_spreading); are all radii a_ref? */
  int n;
  const int *sphere;
  int (*corner)[3];
  void *place;
  int equal;
  /* those of them that stand side by side (sd_ewald_runs.h) */
  sd_ewald_runs runs;
  size_t corner_room, place_room;
} sd_ewald_waves;

/* Tables for a splitting, in the frame of the last one. SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_waves_create(sd_ewald_waves *w, const sd_ewald *e,
                                const struct sd_ewald_kernels *kernels, int width,
                                const sd_world *world);

/* The box of the same tables may stand elsewhere now (sd_ewald_same_tables). */
void sd_ewald_waves_stand(sd_ewald_waves *w, const sd_ewald_box *box);

/* Where n of the spheres s stand on the grid: sphere [n] their numbers, which outlive the products;
 * brick [6], out: the points that they reach, for sd_grid_place, which is next. SD_OK,
 * SD_ENOMEMORY, or SD_ENOTFINITE if one is outside of an open box, or nowhere. */
sd_status sd_ewald_waves_find(sd_ewald_waves *w, const sd_spheres *s, const int *sphere, int n,
                              int *brick);

/* Bricks of all ranks [ranks][6], which are turned if the frame is. SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_waves_place(sd_ewald_waves *w, int *bricks);

/* From each rank's own brick to those of all, which are placed: on all ranks of the world together,
 * also where this one has failed before (status) and has no grid. Then all fail. */
sd_status sd_ewald_waves_meet(sd_ewald_waves *w, const int *brick, sd_status status,
                              const sd_world *world);

/* In the place of the last: the brick of every rank is the whole grid, as it is repeated, so that the
 * flow can be read anywhere. The frame must never have turned. SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_waves_place_whole(sd_ewald_waves *w);

/* Rows are [width n], in order of sphere, of the kernels' numbers, in memory of the caller. */

/* Rows of w F; F [width] a sphere */
void sd_ewald_waves_load(const sd_ewald_waves *w, const sd_spheres *s, const double *F, void *rows);

/* u [width] a sphere += w times the rows */
void sd_ewald_waves_add(const sd_ewald_waves *w, const sd_spheres *s, const void *rows, double *u);

/* Rows of w F -> velocities on the brick (spreading.brick). SD_OK or what an exchange said. */
sd_status sd_ewald_waves_convolve(sd_ewald_waves *w, void *rows);

/* Rows of w F -> rows of velocities. SD_OK or what an exchange said. */
sd_status sd_ewald_waves_apply(sd_ewald_waves *w, void *rows);

/* Rows of velocities, random, with the covariance of the wave part of a periodic box, window and
 * all: from three normal numbers at each point of the grid, by the number of the point in the frame
 * of the box (SD_RANDOM_GRID). Of doubles alone. SD_OK or what an exchange said. */
sd_status sd_ewald_waves_draw(sd_ewald_waves *w, const sd_random_key *key, void *rows);

void sd_ewald_waves_free(sd_ewald_waves *w);

SD_END_C
#endif
