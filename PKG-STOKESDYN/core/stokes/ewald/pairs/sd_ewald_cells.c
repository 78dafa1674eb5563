#include "sd_ewald_cells.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_room.h"

void sd_ewald_cells_free(sd_ewald_cells *c)
{
  free(c->place);
  free(c->first);
  free(c->column);
  free(c->range);
  memset(c, 0, sizeof(*c));
}

/* --- rows in order of cells --- */

static int ec_takes_part(const double *there, int i)
{
  return !there || there[i] > 0.0;
}

/* Half the reach a side, or more where the places are so far apart that most cells would be empty. */
static void cut_into_cells(sd_ewald_cells *c, const double *x, const double *there, int count)
{
  double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
  int many = 0;
  for (int i = 0; i < count; i++) {
    if (!ec_takes_part(there, i)) continue;
    many++;
    for (int d = 0; d < 3; d++) {
      const double at = x[3 * (long) i + d];
      lo[d] = at < lo[d] ? at : lo[d];
      hi[d] = at > hi[d] ? at : hi[d];
    }
  }
  c->side = 0.5 * c->reach;
  c->inverse = 0.0;
  c->n[0] = c->n[1] = c->n[2] = 1;
  if (many == 0) return;
  for (double wanted = 4.0 * many + 64.0;; c->side *= 1.5) {
    double all = 1.0;
    for (int d = 0; d < 3; d++) all *= floor((hi[d] - lo[d]) / c->side) + 1.0;
    if (all <= wanted) break;
  }
  c->inverse = 1.0 / c->side;
  for (int d = 0; d < 3; d++) {
    c->lo[d] = lo[d];
    c->n[d] = (int) floor((hi[d] - lo[d]) / c->side) + 1;
  }
}

static int ec_along(const sd_ewald_cells *c, double x, int d)
{
  const int k = (int) ((x - c->lo[d]) * c->inverse);
  return k < c->n[d] ? k : c->n[d] - 1;
}

static int ec_cell_of(const sd_ewald_cells *c, const double *x)
{
  return (ec_along(c, x[0], 0) * c->n[1] + ec_along(c, x[1], 1)) * c->n[2] + ec_along(c, x[2], 2);
}

/* Counting sort */
sd_status sd_ewald_cells_sort(sd_ewald_cells *c, const double *x, const double *there, int count,
                              double reach, double *centre)
{
  c->reach = reach;
  c->centre = centre;
  cut_into_cells(c, x, there, count);
  const int all = c->n[0] * c->n[1] * c->n[2];
  if (!sd_reserve(&c->first, sizeof(int), (size_t) all + 2, &c->first_room) ||
      !sd_reserve(&c->place, sizeof(int), (size_t) count + 1, &c->place_room))
    return SD_ENOMEMORY;
  int *first = c->first;
  memset(first, 0, sizeof(int) * ((size_t) all + 2));
  for (int i = 0; i < count; i++)
    if (ec_takes_part(there, i)) first[ec_cell_of(c, x + 3 * (long) i) + 2]++;
  for (int k = 0; k < all; k++) first[k + 2] += first[k + 1];
  for (int i = 0; i < count; i++)
    if (ec_takes_part(there, i)) c->place[first[ec_cell_of(c, x + 3 * (long) i) + 1]++] = i;
  c->rows = first[all];
  for (long k = 0; k < c->rows; k++)
    for (long d = 0; d < 3; d++) centre[d * c->rows + k] = x[3 * (long) c->place[k] + d];
  return SD_OK;
}

/* --- neighbours --- */

static int add_column(sd_ewald_cells *c, int x, int y, int z)
{
  const size_t many = (size_t) c->columns + 1;
  if (!sd_extend(&c->column, 3 * sizeof(int), many, &c->column_room) ||
      !sd_extend(&c->range, 2 * sizeof(int), many, &c->range_room))
    return 0;
  int *column = c->column + 3 * c->columns++;
  column[0] = x;
  column[1] = y;
  column[2] = z;
  return 1;
}

/* Which columns of cells, along z, may hold neighbours that come later in the order of cells; the
 * first is that of the cell itself. */
static int find_columns(sd_ewald_cells *c)
{
  int steps[2], ok = 1;
  for (int d = 0; d < 2; d++) steps[d] = (int) fmin(ceil(c->reach / c->side), c->n[d] - 1);
  c->columns = 0;
  for (int x = 0; x <= steps[0]; x++)
    for (int y = x == 0 ? 0 : -steps[1]; y <= steps[1] && ok; y++) {
      const double gap_x = x > 1 ? (x - 1) * c->side : 0.0;
      const double gap_y = abs(y) > 1 ? (abs(y) - 1) * c->side : 0.0;
      const double left = c->reach * c->reach - gap_x * gap_x - gap_y * gap_y;
      if (left < 0.0) continue;
      ok = add_column(c, x, y, (int) fmin(ceil(sqrt(left) / c->side), c->n[2] - 1));
    }
  return ok;
}

/* The rows in the columns of a cell, as ranges; those of its own column begin with its own. Returns
 * how many ranges, and in all how many rows. */
static int ranges_of(const sd_ewald_cells *c, const int *cell, long *rows)
{
  int many = 0;
  *rows = 0;
  for (int k = 0; k < c->columns; k++) {
    const int x = cell[0] + c->column[3 * k], y = cell[1] + c->column[3 * k + 1];
    if (x >= c->n[0] || y < 0 || y >= c->n[1]) continue;
    const int span = c->column[3 * k + 2], z = cell[2];
    const long column = ((long) x * c->n[1] + y) * c->n[2];
    const long from = k == 0 ? z
        : z > span           ? z - span
                             : 0,
               to = z + span < c->n[2] ? z + span : c->n[2] - 1;
    c->range[2 * many] = c->first[column + from];
    c->range[2 * many + 1] = c->first[column + to + 1];
    *rows += c->range[2 * many + 1] - c->range[2 * many];
    many++;
  }
  return many;
}

sd_status sd_ewald_cells_walk(sd_ewald_cells *c, sd_ewald_visit *visit, void *ctx)
{
  long rows;
  int cell[3], next = 0;
  sd_status status = find_columns(c) ? SD_OK : SD_ENOMEMORY;
  for (cell[0] = 0; cell[0] < c->n[0]; cell[0]++)
    for (cell[1] = 0; cell[1] < c->n[1]; cell[1]++)
      for (cell[2] = 0; cell[2] < c->n[2]; cell[2]++) {
        const int end = c->first[((long) cell[0] * c->n[1] + cell[1]) * c->n[2] + cell[2] + 1];
        if (next == end) continue;
        const int ranges = ranges_of(c, cell, &rows);
        for (; next < end && status == SD_OK; next++) {
          c->range[0] = next + 1;
          status = visit(ctx, next, ranges, rows);
        }
        if (status != SD_OK) return status;
      }
  return status;
}
