#include "sd_cells.h"

#include <stdlib.h>

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
