#include "sd_sph_deep.h"

#include <math.h>
#include <string.h>

/* Cells of one side not below the reach, around all that is marked, and a layer of cells more on each side. */
typedef struct {
  double lo[3], side;
  int size[3];
} deep_cells;

static size_t number_of_cells(deep_cells *c, const double hi[3])
{
  double number = 1.0;
  for (int d = 0; d < 3; d++) {
    const double along = floor((hi[d] - c->lo[d]) / c->side) + 3.0;
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
    const double along = (x[d] - c->lo[d]) / c->side + 1.0;
    if (!(along >= 0.0 && along < c->size[d])) return -1;
    cell = cell * c->size[d] + (long) along;
  }
  return cell;
}

static int bounds_of_marked(int all, const double *x4, const char *marked, double lo[3], double hi[3])
{
  for (int d = 0; d < 3; d++) hi[d] = -(lo[d] = HUGE_VAL);
  for (int i = 0; i < all; i++)
    for (int d = 0; d < 3 && marked[i]; d++) {
      const double x = x4[4 * (size_t) i + d];
      if (x < lo[d]) lo[d] = x;
      if (x > hi[d]) hi[d] = x;
    }
  return hi[0] >= lo[0];
}

void sd_sph_find_deep(int all, int n, const double *x4, const char *marked, double reach, char *grid, char *deep)
{
  enum { BESIDE = 1, WITHIN = 2 };
  deep_cells c = {.side = reach * (1.0 + 1e-9)};
  double hi[3];
  size_t cells;
  memset(deep, 1, (size_t) n);
  if (!bounds_of_marked(all, x4, marked, c.lo, hi)) return;
  while ((cells = number_of_cells(&c, hi)) > SD_SPH_DEEP_CELLS(all)) c.side *= 1.2;
  memset(grid, 0, cells);
  const long row = c.size[0], plane = row * c.size[1];
  for (int i = 0; i < all; i++) {
    if (!marked[i]) continue;
    char *cell = grid + deep_cell_of(&c, x4 + 4 * (size_t) i);
    if (*cell == WITHIN) continue;
    for (long z = -plane; z <= plane; z += plane)
      for (long y = -row; y <= row; y += row)
        for (long x = -1; x <= 1; x++) cell[x + y + z] |= BESIDE;
    *cell = WITHIN;
  }
  for (int i = 0; i < n; i++) {
    const long cell = deep_cell_of(&c, x4 + 4 * (size_t) i);
    deep[i] = cell < 0 || !grid[cell];
  }
}
