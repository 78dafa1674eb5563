/* A grid of vectors over all ranks, and its Fourier transform: three real fields forth, a
 * multiplication at each wave vector, three fields back.
 *
 * Each rank has a brick, the grid points that its own spheres reach, three numbers a point,
 * wherever that is; bricks overlap and may hang over the faces of a periodic box. Transforms go
 * along z and y in slabs of whole x planes, then along x in slabs of whole y planes:
 *
 *   bricks --add--> x planes --z, y--> exchange --x, multiply, x--> exchange --y, z--> bricks
 *
 * A plane is filled, transformed and sent while it is in the cache; rows that other ranks sent are
 * transformed where they have come in.
 *
 * An open grid is twice as large as the part of it that holds something; what is known to be 0, or
 * is not asked for, is not transformed. */
#ifndef SD_GRID_H
#define SD_GRID_H

#include <fftw3.h>

#include "sd_status.h"
#include "sd_world.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A box of a brick and its place in the x slab of a rank; where it begins in a message */
typedef struct {
  int rank, at[3], to[3], n[3];
  long message;
} sd_piece;

/* Zero-initialise; sd_grid_free in the end. */
typedef struct {
  sd_world world;
  int me, ranks;
  /* points of the transform, of its occupied part, and complex numbers along z */
  int size[3], occupied[3], half;
  /* this rank's planes of the two slabs */
  int x0, x1, y0, y1;
  /* a plane [size x or y][half] at work, of points or of wave numbers, and one beside them */
  fftw_complex *plane[3], *beside;
  /* [x1 - x0] planes of the x slab, wave numbers of z and then y: [3][size y][half]. Each is in the
   * layer of the brick that it has been made from, which is free then; in `spare` where there is none
   * of its size */
  fftw_complex **slab;
  double *spare;
  size_t spare_room;
  fftw_plan z_forth, z_back, y_forth, y_back, x_forth, x_back;
  /* brick: first point and number of points; rows along z of 3 numbers a point */
  int lo[3], n[3];
  long row, layer;
  double *brick;
  size_t brick_room;
  /* from the brick to slabs, by rank of the slab; to our slab from bricks, by rank of the brick */
  sd_piece *out, *in;
  int outs, ins;
  size_t out_room, in_room;
  /* numbers to and from each rank: of pieces, and of the turn from x to y planes; 4 [ranks] */
  int *counts;
  /* messages: what is in one goes to the other */
  double *message[2];
  size_t message_room[2];
} sd_grid;

/* Multiplies the three fields at all wave vectors of one y: plane [3] [size x][half] complex. */
typedef void sd_grid_multiply(void *ctx, int y, double *const *plane);

/* Slabs and plans. SD_OK or SD_ENOMEMORY. */
sd_status sd_grid_create(sd_grid *g, const int *size, const int *occupied, const sd_world *world);

/* Of the points of all bricks, as below, how many would be in the slab of their own rank if slabs
 * were planes of direction d? They need no message. */
double sd_grid_at_home(const sd_grid *g, const int *bricks, int d);

/* Bricks for the spheres as they stand: of all ranks [ranks][6] first point and number of points
 * each way, which may be 0. SD_OK or SD_ENOMEMORY. */
sd_status sd_grid_place(sd_grid *g, const int *bricks);

/* Brick [points][3] of forces -> velocities. The transforms are not normalised. SD_OK or what
 * exchange said. */
sd_status sd_grid_convolve(sd_grid *g, sd_grid_multiply *multiply, void *ctx);

void sd_grid_free(sd_grid *g);

#ifdef __cplusplus
}
#endif
#endif
