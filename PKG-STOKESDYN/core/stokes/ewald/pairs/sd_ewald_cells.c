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
      const double at = sd_ewald_turned(x + 3 * (long) i, c->turn, d);
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

static int ec_along(const sd_ewald_cells *c, const double *x, int d)
{
  const int k = (int) ((sd_ewald_turned(x, c->turn, d) - c->lo[d]) * c->inverse);
  return k < c->n[d] ? k : c->n[d] - 1;
}

static int ec_cell_of(const sd_ewald_cells *c, const double *x)
{
  return (ec_along(c, x, 0) * c->n[1] + ec_along(c, x, 1)) * c->n[2] + ec_along(c, x, 2);
}

/* Counting sort */
sd_status sd_ewald_cells_sort(sd_ewald_cells *c, const double *x, const double *there, int count,
                              double reach, int turn, double *centre)
{
  c->reach = reach;
  c->turn = turn;
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
    for (int d = 0; d < 3; d++)
      centre[(long) d * c->rows + k] = sd_ewald_turned(x + 3 * (long) c->place[k], turn, d);
  return SD_OK;
}

/* Insertion sort: a cell has few rows. */
void sd_ewald_cells_order(sd_ewald_cells *c)
{
  const long cells = (long) c->n[0] * c->n[1] * c->n[2], rows = c->rows;
  double *z = c->centre + 2 * rows;
  for (long cell = 0; cell < cells; cell++)
    for (int k = c->first[cell] + 1; k < c->first[cell + 1]; k++) {
      const int place = c->place[k];
      double x[3];
      int to = k;
      sd_ewald_cells_at(c, k, x);
      for (; to > c->first[cell] && z[to - 1] > x[2]; to--) {
        c->place[to] = c->place[to - 1];
        for (long d = 0; d < 3; d++) c->centre[d * rows + to] = c->centre[d * rows + to - 1];
      }
      c->place[to] = place;
      for (long d = 0; d < 3; d++) c->centre[d * rows + to] = x[d];
    }
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

/* The rows in the columns of cells x, y and from z to last, as ranges; those of their own column begin with
 * their own. Returns how many ranges, and in all how many rows. */
static int ranges_of(const sd_ewald_cells *c, const int *cell, int last, long *rows)
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
               to = last + span < c->n[2] ? last + span : c->n[2] - 1;
    c->range[2 * many] = c->first[column + from];
    c->range[2 * many + 1] = c->first[column + to + 1];
    *rows += c->range[2 * many + 1] - c->range[2 * many];
    many++;
  }
  return many;
}

/* Rows from `row` on that are a bunch; ends at `end`, where its column does */
static int bunch_end(const sd_ewald_cells *c, int row, int end, int most)
{
  double first[3], x[3];
  int next = row + 1;
  sd_ewald_cells_at(c, row, first);
  for (; next < end && next < row + most; next++) {
    sd_ewald_cells_at(c, next, x);
    for (int d = 0; d < 3; d++)
      if (fabs(x[d] - first[d]) > 0.5 * (d < 2 ? 1 : 2) * c->reach) return next;
  }
  return next;
}

/* Column x, y of cells */
static sd_status walk_column(sd_ewald_cells *c, int *cell, int most, sd_ewald_visit *visit, void *ctx)
{
  const int *first = c->first + ((long) cell[0] * c->n[1] + cell[1]) * c->n[2], end = first[c->n[2]];
  int ranges = 0, known = -1;
  long room = 0;
  cell[2] = 0;
  for (int row = first[0], next; row < end; row = next) {
    next = bunch_end(c, row, end, most);
    int last = cell[2];
    while (first[last + 1] < next) last++;
    if (first[cell[2] + 1] <= row || last != known) {
      while (first[cell[2] + 1] <= row) cell[2]++;
      ranges = ranges_of(c, cell, last, &room);
      known = last;
    }
    c->range[0] = row + 1;
    const sd_status status = visit(ctx, row, next, ranges, room);
    if (status != SD_OK) return status;
  }
  return SD_OK;
}

sd_status sd_ewald_cells_walk(sd_ewald_cells *c, int most, sd_ewald_visit *visit, void *ctx)
{
  int cell[3];
  sd_status status = find_columns(c) ? SD_OK : SD_ENOMEMORY;
  for (cell[0] = 0; cell[0] < c->n[0]; cell[0]++)
    for (cell[1] = 0; cell[1] < c->n[1] && status == SD_OK; cell[1]++)
      status = walk_column(c, cell, most, visit, ctx);
  return status;
}
