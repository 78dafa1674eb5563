#include "sd_cells.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

sd_status sd_cells_create(sd_cells *c, int n)
{
  if (n >= 1 << 29) return SD_ENOMEMORY;
  /* At most n cells hold a point: with twice as many slots a search meets an empty one soon. */
  c->slots = 16;
  while (c->slots < 2 * n) c->slots *= 2;
  c->cell = malloc(sizeof(*c->cell) * (size_t) c->slots);
  c->next = malloc(sizeof(*c->next) * ((size_t) n + 1));
  if (c->cell && c->next) return SD_OK;
  sd_cells_free(c);
  return SD_ENOMEMORY;
}

void sd_cells_free(sd_cells *c)
{
  free(c->cell);
  free(c->next);
  *c = (sd_cells){0};
}

void sd_cells_clear(sd_cells *c, const double *lo, double side)
{
  c->side = side;
  for (int d = 0; d < 3; d++) c->lo[d] = lo[d];
  for (int k = 0; k < c->slots; k++) c->cell[k] = (sd_cell){0, -1};
}

/* A chain through `next`: the newest point of a cell is its first, so nothing is moved and nothing
 * allocated. */
void sd_cells_add(sd_cells *c, const double *x, int i)
{
  int64_t k[3];
  uint64_t number;
  for (int d = 0; d < 3; d++) k[d] = sd_cells_along(c, x[3 * (long) i + d] - c->lo[d]);
  sd_cell *cell = sd_cells_slot(c, k[0], k[1], k[2], &number);
  cell->number = number;
  c->next[i] = cell->first;
  cell->first = i;
}

/* The corner is where no coordinate is smaller, so that cells have small numbers wherever the cloud
 * is. Points go in from the last on, because a chain gives them in the opposite order. */
sd_status sd_cells_fill(sd_cells *c, const double *x, int n, double side)
{
  double lo[3] = {0.0, 0.0, 0.0};
  for (int d = 0; d < 3 && n > 0; d++) lo[d] = x[d];
  for (long i = 1; i < n; i++)
    for (int d = 0; d < 3; d++) lo[d] = fmin(lo[d], x[3 * i + d]);
  const sd_status status = sd_cells_create(c, n);
  if (status != SD_OK) return status;
  sd_cells_clear(c, lo, side);
  for (int i = n - 1; i >= 0; i--) sd_cells_add(c, x, i);
  return SD_OK;
}

/* Along one direction: from the lowest point on, so many cells, and so many of them in a length */
typedef struct {
  double lo, inverse;
  int n;
} cells_along;

static void cut_edges(const double *x, int n, cells_along along[3])
{
  double edge[3], volume = 1.0;
  for (int d = 0; d < 3; d++) {
    double lo = INFINITY, hi = -INFINITY;
    for (long i = 0; i < n; i++) {
      lo = fmin(lo, x[3 * i + d]);
      hi = fmax(hi, x[3 * i + d]);
    }
    along[d].lo = lo;
    edge[d] = hi - lo;
    volume *= edge[d];
  }
  const double side = cbrt(8.0 * volume / n);
  for (int d = 0; d < 3; d++) {
    const double cells = edge[d] / side;
    along[d].n = cells >= n ? n : cells >= 1.0 ? (int) cells : 1;
    along[d].inverse = along[d].n / edge[d];
  }
}

/* A place that is no number is in the first */
static int cell_along(const cells_along *c, double x)
{
  const double at = (x - c->lo) * c->inverse;
  return !(at > 0.0) ? 0 : at < c->n ? (int) at : c->n - 1;
}

/* Counting sorts along z, y and x, each of which leaves the order of the one before where cells are alike */
sd_status sd_cells_sort(const double *x, int n, int *order)
{
  cells_along along[3];
  int *before = malloc(sizeof(int) * ((size_t) n + 1)), *first = malloc(sizeof(int) * ((size_t) n + 2));
  const int there = before && first;
  if (there) cut_edges(x, n, along);
  for (int i = 0; i < n; i++) order[i] = i;
  for (int d = 2; d >= 0 && there; d--) {
    memset(first, 0, sizeof(int) * ((size_t) along[d].n + 1));
    memcpy(before, order, sizeof(int) * (size_t) n);
    for (long i = 0; i < n; i++) first[cell_along(along + d, x[3 * i + d]) + 1]++;
    for (int k = 0; k < along[d].n; k++) first[k + 1] += first[k];
    for (int k = 0; k < n; k++) order[first[cell_along(along + d, x[3 * (long) before[k] + d])]++] = before[k];
  }
  free(before);
  free(first);
  return there ? SD_OK : SD_ENOMEMORY;
}
