/* Who is near whom of many places, found by cells: those of the near part of an Ewald sum, which are
 * spheres, or middles of groups of them.
 *
 * Rows are the places that take part, in order of cells. Each pair is found once, by the row that comes
 * first: later rows near it stand in few ranges of rows, columns of cells along z. Rows that follow each
 * other and are close may be asked about in bunches: what is near one is near most of the others.
 *
 * Rows stand in a frame that is turned cyclically: its direction d is d + turn of the places. So they are
 * in the order of a grid in that frame. */
#ifndef SD_EWALD_CELLS_H
#define SD_EWALD_CELLS_H

#include <stddef.h>

#include "sd_status.h"

SD_BEGIN_C

/* Vectors of every instruction set are full with so many neighbours. */
enum { SD_FULL = 8 };

/* Zero-initialise; sd_ewald_cells_free in the end. */
typedef struct {
  double reach;
  int turn;
  /* [rows] which place; [3][rows] where it is in the frame, in memory of the caller */
  int rows, *place;
  double *centre;
  /* a box around them, cut into n [3] cells of one side; [cells + 1] first row of each */
  double lo[3], side, inverse;
  int n[3], *first;
  /* columns of cells near a cell: [3 columns] steps of x, of y, and along z to either side; begin and
   * end of the rows in them, [2 columns] */
  int columns, *column, *range;
  size_t place_room, first_room, column_room, range_room;
} sd_ewald_cells;

/* Of the places x [3 count] those that take part (there [count] > 0; NULL: all), for pairs within reach.
 * centre [3 count + SD_FULL]: memory that the walk needs. SD_OK or SD_ENOMEMORY. */
sd_status sd_ewald_cells_sort(sd_ewald_cells *c, const double *x, const double *there, int count,
                              double reach, int turn, double *centre);

/* A place in a frame that is turned */
static inline double sd_ewald_turned(const double *x, int turn, int d)
{
  return x[(d + turn) % 3];
}

/* The rows of each cell along z, so that bunches of them are close */
void sd_ewald_cells_order(sd_ewald_cells *c);

/* One bunch of up to `most` rows after the other: visit(ctx, row, end, ranges, room) for rows behind `row`,
 * which is its first, that may be near one of it; those of so many c->range, and at most so many rows. Two
 * rows of a bunch are no farther from each other than the reach in any direction. SD_OK, SD_ENOMEMORY or
 * what visit says. */
typedef sd_status sd_ewald_visit(void *ctx, int row, int end, int ranges, long room);
sd_status sd_ewald_cells_walk(sd_ewald_cells *c, int most, sd_ewald_visit *visit, void *ctx);

static inline void sd_ewald_cells_at(const sd_ewald_cells *c, int row, double *x)
{
  for (long d = 0; d < 3; d++) x[d] = c->centre[d * c->rows + row];
}

void sd_ewald_cells_free(sd_ewald_cells *c);

SD_END_C
#endif
