/* A grid of vectors over all ranks, of doubles or of floats, and its Fourier transform: three real fields
 * forth, a multiplication at each wave vector, three fields back.
 *
 * Each rank has a brick, the grid points that its own spheres reach, three numbers per point,
 * wherever that is; bricks overlap and may hang over the faces of a periodic box. Ranks stand in
 * rows x columns: the row says which planes of x a rank has, and later which y; the column which y,
 * and later which wave numbers of z:
 *
 *   bricks --add--> pencils along z --z, turn in rows--> along y --y, turn in columns--> along x,
 *   multiply, and all of it back
 *
 * With one column pencils along z and y are slabs of whole x planes and nothing is turned in rows;
 * that is so until there are more ranks than planes, or planes that few ranks share unevenly. Ranks
 * that rows x columns leave over have a brick and no pencils.
 *
 * A plane is filled, transformed and sent while it is in the cache; rows that other ranks sent are
 * transformed where they have come in. Messages go only to ranks that something is for.
 *
 * An open grid is twice as large as the part of it that holds something; what is known to be 0, or
 * is not asked for, is not transformed. Of waves that a multiplication leaves, those of z may be fewer
 * where y is large; the others take no part in the turn in columns, nor in transforms along x. */
#ifndef SD_GRID_H
#define SD_GRID_H

#include <stddef.h>

#include "sd_status.h"
#include "sd_world.h"

SD_BEGIN_C

/* A box of a brick and its place in the pencils of a rank; where it begins in a message */
typedef struct {
  int rank, at[3], to[3], n[3];
  long message;
} sd_piece;

/* What is shared among rows and columns: planes of x and, of each, lines of y; then y and wave
 * numbers of z. */
typedef enum { SD_SHARED_X, SD_SHARED_LINES, SD_SHARED_Y, SD_SHARED_Z } sd_grid_part;

/* The lines of one y and our z along x, where y and z are wave numbers and x is a point still: forces
 * fields [3][occupied x][depth] complex -> velocities, in place, which are added to what the product at
 * each wave vector makes of the same forces. */
typedef void sd_grid_sweep(void *ctx, int y, double *const *fields);

/* Zero-initialise; sd_grid_free in the end. */
typedef struct {
  sd_world world;
  int me, ranks;
  /* of a number; pointers to void are to numbers, or to pairs of them, which are complex */
  size_t bytes;
  const struct sd_grid_fields *fields;
  const struct sd_grid_kernels *kernels;
  /* points of the transform, of its occupied part, and wave numbers along z that are not 0 at every y */
  int size[3], occupied[3], waves;
  /* a multiplication and a sweep find number d + turn of each three as their component d: directions of
   * the grid may be those of its vectors in another order */
  int turn;
  int rows, columns;
  /* [rows + 1] where the wave numbers of y of each row begin; [size y + 1] the waves of our z that are left
   * at all y before this one */
  int *first_y;
  long *before;
  /* this rank's part of each sd_grid_part: first and end */
  int own[4][2];
  /* three planes at work, of points or of wave numbers, and one beside them */
  void *plane[3], *beside;
  /* [planes of x] wave numbers of y and our z: [3][size y][depth], depth of our z; a field begins at
   * 16 bytes, as vectors of FFTW do. Each is in the
   * layer of the brick that it has been made from, which is free then; in `spare` where there is none
   * of its size */
  void **slab;
  double *spare;
  size_t spare_room;
  /* FFTW's, of lines along z, y and x forth and back; along x [our z + 1] of so many lines, NULL: of none */
  void *z_forth, *z_back, *y_forth, *y_back, **x_forth, **x_back;
  /* brick: first point and number of points; rows along z of 3 numbers a point, each of which begins with a
   * line of the cache */
  int lo[3], n[3];
  long row, layer;
  void *brick;
  double *brick_memory;
  size_t brick_room;
  /* [occupied x] of each plane of x, NULL: none; three more planes at work */
  double *height;
  void *raised[3];
  /* NULL: nothing but the product at each wave vector */
  sd_grid_sweep *sweep;
  void *sweep_ctx;
  /* from the brick to pencils, by rank of the pencils; to ours from bricks, by rank of the brick */
  sd_piece *out, *in;
  int outs, ins;
  size_t out_room, in_room;
  /* doubles to and from each rank, as which numbers travel: of pieces, of the turn in rows, of that in
   * columns; 6 [ranks] */
  int *counts;
  /* messages: what is in one goes to the other */
  double *message[2];
  size_t message_room[2];
} sd_grid;

/* Multiplies the three fields at the wave vectors of one y and the first `depth` of our z, those that are
 * left there: plane [3][size x][depth] complex. With heights three more, plane [6]: of each field times the
 * height; and of what comes of these the product with the height is added to what comes of the first
 * three. */
typedef void sd_grid_multiply(void *ctx, int y, int depth, void *const *plane);

/* Rows, columns and plans; waves [size y]: so many wave numbers 0 ... along z are left by a multiplication at
 * this y, at most half of size[2] and one more; bytes: of a double, or of a float. SD_OK; SD_ENOMEMORY, also
 * for turns of more numbers than an int counts. */
sd_status sd_grid_create(sd_grid *g, const int *size, const int *occupied, const int *waves, size_t bytes,
                         const sd_world *world);

/* From now on with heights, one for each plane of x [occupied x]. SD_OK or SD_ENOMEMORY. */
sd_status sd_grid_raise(sd_grid *g, const double *height);

/* From now on with a sweep; of doubles alone. SD_OK or SD_ENOMEMORY. */
sd_status sd_grid_add_sweep(sd_grid *g, sd_grid_sweep *sweep, void *ctx);

/* Of the points of all bricks, as below, how many would be in the pencils of their own rank if the
 * first direction were d? They need no message. */
double sd_grid_at_home(const sd_grid *g, const int *bricks, int d);

/* Bricks for the spheres as they stand: of all ranks [ranks][6] first point and number of points
 * each way, which may be 0. SD_OK; SD_ENOMEMORY as above. */
sd_status sd_grid_place(sd_grid *g, const int *bricks);

/* Numbers of the brick, with what vectors read and write beyond the last point */
size_t sd_grid_brick_numbers(const sd_grid *g);

/* Brick [points][3] of forces -> velocities. The transforms are not normalised. SD_OK or what
 * exchange said. */
sd_status sd_grid_convolve(sd_grid *g, sd_grid_multiply *multiply, void *ctx);

/* The number of point z of a line in a plane of points: two lines are a row of complex numbers, [points] */
static inline long sd_grid_number(int points, int line, int z)
{
  return 2 * ((long) (line / 2) * points + z) + line % 2;
}

/* The wave number that a transform of n points has in place m: 0, 1 ... n/2 - 1, then from -n/2 on */
static inline int sd_grid_wave(int m, int n)
{
  return m < (n + 1) / 2 ? m : m - n;
}

/* Values at the points of plane x and of its lines y ... y_end - 1: fields [3], which hold zeros and whose
 * line 0 is line y. */
typedef void sd_grid_fill(void *ctx, int x, int y, int y_end, double *const *fields);

/* The same from values that are known on the grid, in place of what bricks hold; brick out. Of doubles
 * alone */
sd_status sd_grid_convolve_values(sd_grid *g, sd_grid_fill *fill, void *fill_ctx,
                                  sd_grid_multiply *multiply, void *ctx);

void sd_grid_free(sd_grid *g);

SD_END_C
#endif
