/* Between the parts of a field, and between those and the kernels. */
#ifndef SD_FIELD_INTERNAL_H
#define SD_FIELD_INTERNAL_H

#include "sd_field.h"
#include "sd_radial.h"

/* A row of a source: x y z a, F, T, and two numbers that are free */
enum { SD_FIELD_ROW = 12 };

/* Sources and our points; lengths scaled as in sd_packed.
 *   source [n]       rows, images among them
 *   range, ref       only points nearer than this get something; a_ref; not read by `direct`
 *   I0 J0 I1 J1 K0   of sd_radial.h, so scaled and times 8 pi, of a degree with a kernel
 *   u                [3 points], x fastest: grows by unit times the sum times 8 pi, and by mean */
typedef struct {
  int n, turns;
  const double *source;
  double lo[3], step[3];
  int points[3];
  double range, ref;
  int degree;
  double coefficient[SD_RADIALS][SD_RADIAL_TERMS];
  double unit, mean[3], *u;
} sd_field_part;

/* The near part goes by blocks of 8 x 8 x 8 points, in 4 x 4 x 4 bricks of 2 x 2 x 2. A brick is a
 * vector, and fewer of its points are beyond the range of a source than of a piece of a row; the sums
 * of a block stay in the first-level cache for all sources near it. x is fastest everywhere. */
enum { SD_FIELD_BRICKS = 4, SD_FIELD_BLOCK = 8 };

/*   u [4 4 4][3][8]   out: three components at the points of a brick
 *   lo [3]            first point
 *   bricks [3]        those with points that are asked for
 *   source [n]        those that may be near a point */
typedef struct {
  double u[SD_FIELD_BRICKS * SD_FIELD_BRICKS * SD_FIELD_BRICKS][3][8];
  double lo[3];
  int bricks[3], n;
  const int *source;
} sd_field_block;

/* Floats are enough from this tolerance on, and up to the last of these degrees. */
#define SD_FIELD_FLOAT_DEGREES(_) _(6) _(8) _(11) _(14)
#define SD_FIELD_FLOAT_MOST 14
#define SD_FIELD_FLOAT_TOLERANCE 4e-4

/* A window along one direction: its first point and its values */
typedef struct {
  int at;
  double value[SD_WINDOW_COLUMNS];
} sd_field_place;

/* A line of points that windows read, so many numbers of each; and from here to what the next call reads */
typedef struct {
  const double *from;
  int columns;
  long next;
} sd_field_line;

struct sd_field_kernels {
  /* every source with every point */
  void (*direct)(const sd_field_part *p);
  /* the tensor less its wave part in open space, within the range; u of the part is not read. Floats:
   * 3e-6 of F/(6 pi eta a), degrees of SD_FIELD_FLOAT_DEGREES */
  void (*near)(const sd_field_part *p, sd_field_block *b);
  void (*near_floats)(const sd_field_part *p, sd_field_block *b);
  /* out [apart l + 0 ... 3] = sum_k value_k line [columns (at + k) + 0 ... 3] at n places; with columns
   * of three the fourth number means nothing */
  void (*windows)(const sd_field_place *place, int n, int points, const sd_field_line *line, double *out,
                  long apart);
  /* out [n] = sum_k value_k from [n k + 0 ... n - 1] */
  void (*rows)(const double *value, int points, const double *from, long n, double *out);
};

SD_KERNEL_TABLES(struct sd_field_kernels, sd_field);

/* u of the part += the near part; its sources are those of f->cells, in their order. SD_OK or
 * SD_ENOMEMORY. */
sd_status sd_field_near(sd_field *f, const sd_field_part *p,
                        const struct sd_field_kernels *kernels);

/* u [3 sd_field_points] += what the convolved grid of the waves has at our points */
sd_status sd_field_gather(sd_field *f, const sd_field_grid *g,
                          const struct sd_field_kernels *kernels, double *u);

#endif
