#include "sd_sph_deep.h"

#include <math.h>
#include <string.h>

/* Cells of one side, around all that is marked and LAYERS more on each side, none in two dimensions along z. So
 * many cells away nobody is in reach: the side is not below reach / LAYERS. */
enum { LAYERS = 2 };
typedef struct {
  double lo[3], side;
  int size[3], layers[3];
} deep_cells;

static size_t number_of_cells(deep_cells *c, const double hi[3])
{
  double number = 1.0;
  for (int d = 0; d < 3; d++) {
    const double along = floor((hi[d] - c->lo[d]) / c->side) + 1.0 + 2.0 * c->layers[d];
    c->size[d] = along < 1e9 ? (int) along : 1000000000;
    number *= along;
  }
  return number < 1e15 ? (size_t) number : (size_t) 1e15;
}

/* -1: outside */
static long deep_cell_of(const deep_cells *c, const double *x)
{
  long cell = 0;
  for (int d = 2; d >= 0; d--) {
    const double along = floor((x[d] - c->lo[d]) / c->side) + c->layers[d];
    if (!(along >= 0.0 && along < c->size[d])) return -1;
    cell = cell * c->size[d] + (long) along;
  }
  return cell;
}

/* A place that is no number, or infinite, is that of a run that is about to end: nobody is near it. */
static int bounds_of_marked(int all, const double *x4, const char *marked, double lo[3], double hi[3])
{
  for (int d = 0; d < 3; d++) hi[d] = -(lo[d] = HUGE_VAL);
  for (int i = 0; i < all; i++) {
    const double *x = x4 + 4 * (size_t) i;
    if (!marked[i] || !isfinite(x[0]) || !isfinite(x[1]) || !isfinite(x[2])) continue;
    for (int d = 0; d < 3; d++) {
      if (x[d] < lo[d]) lo[d] = x[d];
      if (x[d] > hi[d]) hi[d] = x[d];
    }
  }
  return hi[0] >= lo[0];
}

/* All particles, not only those that are marked: a surface may be a plane. */
static int is_flat(int all, const double *x4, int d)
{
  for (int i = 1; i < all; i++)
    if (x4[4 * (size_t) i + d] != x4[d]) return 0;
  return 1;
}

/* WITHIN: a cell of somebody who is marked, which has seen to those around it */
enum { BESIDE = 1, WITHIN = 2 };
static void mark_around(const deep_cells *c, char *cell)
{
  const long row = c->size[0], plane = row * c->size[1];
  const int *most = c->layers;
  if (*cell == WITHIN) return;
  for (long z = -most[2]; z <= most[2]; z++)
    for (long y = -most[1]; y <= most[1]; y++)
      for (long x = -most[0]; x <= most[0]; x++) cell[x + y * row + z * plane] |= BESIDE;
  *cell = WITHIN;
}

int sd_sph_find_near(int all, int n, const double *x4, const char *marked, double reach, char *grid, int *near)
{
  deep_cells c = {.side = reach / LAYERS * (1.0 + 1e-9)};
  double hi[3];
  size_t cells;
  int count = 0;
  if (!bounds_of_marked(all, x4, marked, c.lo, hi)) return 0;
  for (int d = 0; d < 3; d++) c.layers[d] = is_flat(all, x4, d) ? 0 : LAYERS;
  while ((cells = number_of_cells(&c, hi)) > SD_SPH_DEEP_CELLS(all)) c.side *= 1.2;
  memset(grid, 0, cells);
  for (int i = 0; i < all; i++) {
    const long cell = marked[i] ? deep_cell_of(&c, x4 + 4 * (size_t) i) : -1;
    if (cell >= 0) mark_around(&c, grid + cell);
  }
  for (int i = 0; i < n; i++) {
    const long cell = deep_cell_of(&c, x4 + 4 * (size_t) i);
    if (cell >= 0 && grid[cell]) near[count++] = i;
  }
  return count;
}
