/* Points in cubic cells of one side, to find those near a place. Space is not bounded: only cells
 * that hold a point exist, in a hash table of their three numbers, so that two dense clouds far
 * apart cost no more than one. */
#ifndef SD_CELLS_H
#define SD_CELLS_H

#include <float.h>
#include <math.h>
#include <stdint.h>

#include "sd_status.h"
#include "sd_whole.h"

SD_BEGIN_C

/* A cell by its number, and its first point; -1: this slot of the table is empty */
typedef struct {
  uint64_t number;
  int first;
} sd_cell;

/* Zero-initialise; sd_cells_free in the end. */
typedef struct {
  double side, lo[3];
  /* [slots], a power of two */
  int slots;
  sd_cell *cell;
  /* [points] the point after it in its cell, -1: the last */
  int *next;
} sd_cells;

/* Room for points 0 ... n - 1. SD_OK or SD_ENOMEMORY. */
sd_status sd_cells_create(sd_cells *c, int n);
void sd_cells_free(sd_cells *c);

/* No points any more; from now on cells of this side > 0, one of them with its corner at lo [3]. */
void sd_cells_clear(sd_cells *c, const double *lo, double side);

/* Point i at x [3 i]. A cell gives its points in the opposite order. */
void sd_cells_add(sd_cells *c, const double *x, int i);

/* All of x [3n] at once, with cells of this side; then each cell gives its points in order of
 * index. SD_OK or SD_ENOMEMORY. */
sd_status sd_cells_fill(sd_cells *c, const double *x, int n, double side);

/* order [n]: the points x [3n] cell by cell, so that near ones stand near each other in memory; x of the
 * cells goes slowest and z fastest, and a cell has its points in order of index. A cell has eight points
 * on average, and there are at most n along an edge. SD_OK or SD_ENOMEMORY. */
sd_status sd_cells_sort(const double *x, int n, int *order);

/* A walk over the points of all cells that the cube of half side radius around a place meets:
 *
 *   for (sd_cells_walk w = sd_cells_near(&c, place, radius); sd_cells_step(&c, &w);)
 *     for (int j = w.first; j >= 0; j = c.next[j]) ...
 *
 * Each point comes once; some are farther away than radius, none that is nearer is missing. Cells
 * go with x fastest. */
typedef struct {
  int64_t from[3], to[3], at[3];
  int first;
} sd_cells_walk;

/* The slot of a cell, or the empty one where it would be. Numbers are kept to 21 bits each: cells
 * 2e6 sides apart share their points, which are too far away to be taken for near ones. Four cells
 * along x stand side by side, in one line of the cache; who finds a slot taken goes on by five, an
 * odd number, and so comes to all of them. */
static inline sd_cell *sd_cells_slot(const sd_cells *c, int64_t i, int64_t j, int64_t k,
                                     uint64_t *number)
{
  const uint64_t most = (1u << 21) - 1;
  *number = ((uint64_t) i & most) | ((uint64_t) j & most) << 21 | ((uint64_t) k & most) << 42;
  uint64_t slot = (*number >> 2) * 0x9e3779b97f4a7c15u;
  for (slot = (slot >> 32) * 4 + (*number & 3);; slot += 5) {
    sd_cell *cell = &c->cell[slot & (uint64_t) (c->slots - 1)];
    if (cell->first < 0 || cell->number == *number) return cell;
  }
}

/* What is no number, or farther than 2^50 sides away, is in one cell: a walk around it has a few, and ends.
 * Doubles that are larger do not tell one cell from the next. */
static inline int64_t sd_cells_along(const sd_cells *c, double x)
{
  const double at = x / c->side;
  return fabs(at) < 0x1p50 ? sd_whole_below(at) : -(INT64_C(1) << 50);
}

static inline sd_cells_walk sd_cells_near(const sd_cells *c, const double *place, double radius)
{
  sd_cells_walk w;
  for (int d = 0; d < 3; d++) {
    const double x = place[d] - c->lo[d], r = radius + 4.0 * DBL_EPSILON * (fabs(x) + radius);
    w.from[d] = w.at[d] = sd_cells_along(c, x - r);
    w.to[d] = sd_cells_along(c, x + r);
  }
  w.at[0]--;
  w.first = -1;
  return w;
}

/* To the next cell that holds a point; 0: there is none. */
static inline int sd_cells_step(const sd_cells *c, sd_cells_walk *w)
{
  uint64_t number;
  do {
    int d = 0;
    for (; d < 3 && ++w->at[d] > w->to[d]; d++) w->at[d] = w->from[d];
    if (d == 3) return 0;
    w->first = sd_cells_slot(c, w->at[0], w->at[1], w->at[2], &number)->first;
  } while (w->first < 0);
  return 1;
}

SD_END_C
#endif
