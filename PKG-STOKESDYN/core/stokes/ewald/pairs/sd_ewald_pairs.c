#include "sd_ewald_pairs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_room.h"

/* Vectors of every instruction set are full with so many neighbours. */
enum { FULL = 8 };

void sd_ewald_pairs_create(sd_ewald_pairs *p, const sd_ewald *e,
                           const struct sd_ewald_kernels *kernels, int width)
{
  p->kernels = kernels;
  p->ewald = *e;
  p->width = width;
  p->degree = sd_near_degree(sd_radial_fit(e, width, p->coefficient[0]));
  sd_radial(e, 0.0, p->origin);
}

void sd_ewald_pairs_free(sd_ewald_pairs *p)
{
  free(p->sphere);
  free(p->target);
  free(p->first);
  free(p->neighbor);
  free(p->memory);
  free(p->cell_first);
  free(p->column);
  free(p->range);
  memset(p, 0, sizeof(*p));
}

/* --- rows in order of cells --- */

/* The last centres are read in whole vectors. */
static int ep_make_room(sd_ewald_pairs *p, int n)
{
  const size_t rows = (size_t) n + 1, doubles = (p->width == 6 ? 20 : 12) * rows + FULL;
  p->row = sd_reserve_lines(&p->memory, doubles, &p->room);
  if (!p->row || !sd_reserve(&p->sphere, sizeof(int), rows, &p->sphere_room) ||
      !sd_reserve(&p->target, sizeof(int), rows, &p->target_room) ||
      !sd_reserve(&p->first, sizeof(long), rows, &p->first_room))
    return 0;
  p->u = p->row + 8 * rows;
  p->torque_row = p->width == 6 ? p->u + 8 * rows : NULL;
  return 1;
}

/* Cells that the spheres stand in: a box around them, cut into n [3] cells of one side */
typedef struct {
  double lo[3], side, inverse;
  int n[3];
} cells;

/* Half the range a side, or more where the spheres are so far apart that most cells would be
 * empty. */
static cells cells_for(const sd_ewald_pairs *p, const sd_spheres *s, int n_all)
{
  double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
  int many = 0;
  for (int i = 0; i < n_all; i++) {
    if (!(s->a[i] > 0.0)) continue;
    many++;
    for (int d = 0; d < 3; d++) {
      lo[d] = fmin(lo[d], s->x[3 * (long) i + d]);
      hi[d] = fmax(hi[d], s->x[3 * (long) i + d]);
    }
  }
  cells c = {.side = 0.5 * p->ewald.range, .inverse = 0.0, .n = {1, 1, 1}};
  if (many == 0) return c;
  for (double wanted = 4.0 * many + 64.0;; c.side *= 1.5) {
    double all = 1.0;
    for (int d = 0; d < 3; d++) all *= floor((hi[d] - lo[d]) / c.side) + 1.0;
    if (all <= wanted) break;
  }
  c.inverse = 1.0 / c.side;
  for (int d = 0; d < 3; d++) {
    c.lo[d] = lo[d];
    c.n[d] = (int) floor((hi[d] - lo[d]) / c.side) + 1;
  }
  return c;
}

static int ep_along(const cells *c, double x, int d)
{
  const int k = (int) ((x - c->lo[d]) * c->inverse);
  return k < c->n[d] ? k : c->n[d] - 1;
}

static int ep_cell_of(const cells *c, const double *x)
{
  return (ep_along(c, x[0], 0) * c->n[1] + ep_along(c, x[1], 1)) * c->n[2] + ep_along(c, x[2], 2);
}

/* Counting sort; the targets are ours. */
static sd_status sort(sd_ewald_pairs *p, const cells *c, int n, int n_all)
{
  const sd_spheres *s = &p->spheres;
  const int all = c->n[0] * c->n[1] * c->n[2];
  if (!sd_reserve(&p->cell_first, sizeof(int), (size_t) all + 2, &p->cell_room))
    return SD_ENOMEMORY;
  int *first = p->cell_first;
  memset(first, 0, sizeof(int) * ((size_t) all + 2));
  for (int i = 0; i < n_all; i++)
    if (s->a[i] > 0.0) first[ep_cell_of(c, s->x + 3 * (long) i) + 2]++;
  for (int k = 0; k < all; k++) first[k + 2] += first[k + 1];
  for (int i = 0; i < n_all; i++)
    if (s->a[i] > 0.0) p->sphere[first[ep_cell_of(c, s->x + 3 * (long) i) + 1]++] = i;
  p->rows = first[all];
  p->n = 0;
  for (int k = 0; k < p->rows; k++)
    if (p->sphere[k] < n) p->target[p->n++] = k;
  return SD_OK;
}

/* A row that stands for nothing: no force, and far from everything. */
static const double nowhere = 1e16;

static void fill_rows(sd_ewald_pairs *p)
{
  double largest = 0.0;
  for (int k = 0; k < p->rows; k++) largest = fmax(largest, p->spheres.a[p->sphere[k]]);
  p->scale = largest > 0.0 ? ldexp(1.0, -ilogb(largest)) : 1.0;
  p->equal = 1;
  for (int k = 0; k < p->rows; k++) {
    const long i = p->sphere[k];
    double *row = p->row + 8 * (long) k;
    for (int d = 0; d < 3; d++) {
      row[d] = p->spheres.x[3 * i + d] * p->scale;
      p->u[(long) d * p->rows + k] = p->spheres.x[3 * i + d];
    }
    row[3] = p->spheres.a[i] * p->scale;
    p->equal = p->equal && p->spheres.a[i] == p->ewald.a_ref;
  }
  const double last[8] = {nowhere, nowhere, nowhere};
  memcpy(p->row + 8 * (long) p->rows, last, sizeof(last));
  if (p->width == 6) memset(p->torque_row + 4 * (long) p->rows, 0, 4 * sizeof(double));
}

/* --- neighbours --- */

static int add_column(sd_ewald_pairs *p, int x, int y, int z)
{
  const size_t many = (size_t) p->columns + 1;
  if (!sd_extend(&p->column, 3 * sizeof(int), many, &p->column_room) ||
      !sd_extend(&p->range, 2 * sizeof(int), many, &p->range_room))
    return 0;
  int *column = p->column + 3 * p->columns++;
  column[0] = x;
  column[1] = y;
  column[2] = z;
  return 1;
}

/* Which columns of cells, along z, may hold neighbours that come later in the order of cells; the
 * first is that of the cell itself. */
static int find_columns(sd_ewald_pairs *p, const cells *c)
{
  const double reach = p->ewald.range;
  int steps[2], ok = 1;
  for (int d = 0; d < 2; d++) steps[d] = (int) fmin(ceil(reach / c->side), c->n[d] - 1);
  p->columns = 0;
  for (int x = 0; x <= steps[0]; x++)
    for (int y = x == 0 ? 0 : -steps[1]; y <= steps[1] && ok; y++) {
      const double gap_x = x > 1 ? (x - 1) * c->side : 0.0;
      const double gap_y = abs(y) > 1 ? (abs(y) - 1) * c->side : 0.0;
      const double left = reach * reach - gap_x * gap_x - gap_y * gap_y;
      if (left < 0.0) continue;
      ok = add_column(p, x, y, (int) fmin(ceil(sqrt(left) / c->side), c->n[2] - 1));
    }
  return ok;
}

/* The rows in the columns of a cell, as ranges; those of its own column begin with its own. Returns
 * how many ranges, and in all how many rows. */
static int ranges_of(const sd_ewald_pairs *p, const cells *c, const int *cell, long *rows)
{
  int many = 0;
  *rows = 0;
  for (int k = 0; k < p->columns; k++) {
    const int x = cell[0] + p->column[3 * k], y = cell[1] + p->column[3 * k + 1];
    if (x >= c->n[0] || y < 0 || y >= c->n[1]) continue;
    const int span = p->column[3 * k + 2], z = cell[2];
    const long column = ((long) x * c->n[1] + y) * c->n[2];
    const long from = k == 0 ? z
        : z > span           ? z - span
                             : 0,
               to = z + span < c->n[2] ? z + span : c->n[2] - 1;
    p->range[2 * many] = p->cell_first[column + from];
    p->range[2 * many + 1] = p->cell_first[column + to + 1];
    *rows += p->range[2 * many + 1] - p->range[2 * many];
    many++;
  }
  return many;
}

static int is_ghost(const sd_ewald_pairs *p, int row, int n)
{
  return p->sphere[row] >= n;
}

/* Neighbours of a row, after the first `many` of all; returns how many there are then */
static long neighbors_of(sd_ewald_pairs *p, int row, int n, int ranges, long many)
{
  const double range2 = p->ewald.range * p->ewald.range, *centre = p->u + row;
  const double x[3] = {centre[0], centre[p->rows], centre[2 * (long) p->rows]};
  int *list = p->neighbor + many;
  long found = p->kernels->search(p->u, p->rows, p->range, ranges, x, range2, list);
  if (is_ghost(p, row, n)) {
    long ours = 0;
    for (long k = 0; k < found; k++)
      if (!is_ghost(p, list[k], n)) list[ours++] = list[k];
    found = ours;
  }
  while (found % FULL) list[found++] = p->rows;
  return many + found;
}

static sd_status ep_find_pairs(sd_ewald_pairs *p, const cells *c, int n)
{
  long many = 0, rows;
  int cell[3], next = 0;
  if (!find_columns(p, c)) return SD_ENOMEMORY;
  for (cell[0] = 0; cell[0] < c->n[0]; cell[0]++)
    for (cell[1] = 0; cell[1] < c->n[1]; cell[1]++)
      for (cell[2] = 0; cell[2] < c->n[2]; cell[2]++) {
        const int end = p->cell_first[((long) cell[0] * c->n[1] + cell[1]) * c->n[2] + cell[2] + 1];
        if (next == end) continue;
        const int ranges = ranges_of(p, c, cell, &rows);
        for (; next < end; next++) {
          p->range[0] = next + 1;
          p->first[next] = many;
          const size_t most = (size_t) (many + rows + 2 * FULL);
          if (!sd_extend(&p->neighbor, sizeof(int), most, &p->neighbor_room)) return SD_ENOMEMORY;
          many = neighbors_of(p, next, n, ranges, many);
        }
      }
  p->first[p->rows] = many;
  return SD_OK;
}

sd_status sd_ewald_pairs_place(sd_ewald_pairs *p, const sd_spheres *s, int n, int n_all)
{
  p->spheres = *s;
  if (!ep_make_room(p, n_all)) return SD_ENOMEMORY;
  const cells c = cells_for(p, s, n_all);
  sd_status status = sort(p, &c, n, n_all);
  if (status != SD_OK) return status;
  fill_rows(p);
  return ep_find_pairs(p, &c, n);
}

/* --- product --- */

static void ep_load(sd_ewald_pairs *p, int n, const double *F, const double *ghosts)
{
  const long m = p->width;
  for (long k = 0; k < p->rows; k++) {
    const long i = p->sphere[k];
    const double w = p->spheres.w[i], *from = i < n ? F + m * i : ghosts + m * (i - n);
    double *row = p->row + 8 * k;
    for (int d = 0; d < 3; d++) row[4 + d] = w * from[d];
    for (int d = 3; d < m; d++) p->torque_row[4 * k + d - 3] = w * p->scale * from[d];
  }
}

/* The kernels' table: lengths scaled, and times 8 pi. */
static sd_near_part near_part_of(sd_ewald_pairs *p)
{
  sd_near_part k = {.rows = p->rows,
                    .width = p->width,
                    .first = p->first,
                    .neighbor = p->neighbor,
                    .row = p->row,
                    .torque_row = p->torque_row,
                    .u = p->u,
                    .degree = p->degree};
  const double s = p->scale, range = p->ewald.range * s, ref = p->ewald.a_ref * s;
  k.range2 = range * range;
  k.ref2 = ref * ref;
  k.equal = p->equal;
  static const int power[SD_RADIALS] = {1, 3, 3, 5, 5, 7, 3, 5};
  for (int f = 0; f < SD_RADIALS; f++) {
    const double unit = 8.0 * SD_PI / pow(s, power[f]);
    for (int m = 0; m <= p->degree; m++) k.coefficient[f][m] = unit * p->coefficient[f][m];
  }
  return k;
}

void sd_ewald_pairs_apply(sd_ewald_pairs *p, int n, const double *F, const double *ghosts,
                          double *u)
{
  const long m = p->width;
  ep_load(p, n, F, ghosts);
  const sd_near_part k = near_part_of(p);
  const long step = m == 6 ? 8 : 4;
  memset(p->u, 0, sizeof(double) * (size_t) (step * (p->rows + 1)));
  p->kernels->near_part(&k);
  memset(u, 0, sizeof(double) * (size_t) m * (size_t) n);
  for (int i = 0; i < p->n; i++) {
    const long j = p->sphere[p->target[i]];
    const double *near = p->u + step * p->target[i];
    const double w = p->spheres.w[j], unit = w * p->scale / (8.0 * SD_PI);
    const double b = sd_ewald_b(&p->ewald, p->spheres.a[j]);
    const double self = p->origin[SD_I0] - 2.0 * b * p->origin[SD_I1] + b * b * p->origin[SD_I2];
    for (int d = 0; d < 3; d++) u[m * j + d] = unit * near[d] - w * w * self * F[m * j + d];
    for (int d = 3; d < m; d++)
      u[m * j + d] = unit * p->scale * near[d + 1] - 0.25 * w * w * p->origin[SD_I1] * F[m * j + d];
  }
}
