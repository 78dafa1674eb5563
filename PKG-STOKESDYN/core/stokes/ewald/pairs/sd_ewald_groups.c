#include "sd_ewald_groups.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_ewald_rows.h"
#include "sd_linear.h"
#include "sd_room.h"
#include "sd_skin.h"

enum { COLUMNS = 3 * SD_GROUP_POINTS };

void sd_ewald_groups_free(sd_ewald_groups *g)
{
  sd_ewald_cells_free(&g->cells);
  free(g->middle);
  free(g->candidate);
  free(g->from);
  free(g->first);
  free(g->near);
  free(g->range);
  free(g->begin);
  free(g->pair);
  free(g->sphere);
  free(g->form);
  free(g->end);
  free(g->block);
  memset(g, 0, sizeof(*g));
}

int sd_ewald_groups_serve(const sd_ewald_pairs *p, const sd_groups *groups)
{
  if (p->width != 3 || !groups->first) return 0;
  for (int g = 0; g < groups->n; g++)
    if (groups->first[g + 1] - groups->first[g] > SD_GROUP_POINTS) return 0;
  return 1;
}

/* --- rows --- */

/* Middle of the points of a group that there are, and their number; *farthest: of any point from a middle, squared */
static int find_middle(const sd_groups *groups, const sd_spheres *s, int group, double at[3], double *farthest)
{
  int points = 0;
  at[0] = at[1] = at[2] = 0.0;
  for (int i = groups->first[group]; i < groups->first[group + 1]; i++) {
    if (!(s->a[i] > 0.0)) continue;
    points++;
    for (int d = 0; d < 3; d++) at[d] += s->x[3 * (long) i + d];
  }
  for (int d = 0; d < 3 && points > 0; d++) at[d] /= points;
  for (int i = groups->first[group]; i < groups->first[group + 1]; i++) {
    const double far = s->a[i] > 0.0 ? sd_distance_squared(at, s->x + 3 * (long) i) : 0.0;
    *farthest = far > *farthest ? far : *farthest;
  }
  return points;
}

/* Within which middles of groups are near each other: a hair more, so that rounding of these loses no pair */
static double reach_of_middles(const sd_ewald_pairs *p)
{
  return (p->ewald.range + 2.0 * p->groups.farthest) * (1.0 + 1e-9);
}

/* Are the rows the points of these groups? Then every group has points, and each row is one that its group had. */
static int same_rows(const sd_ewald_pairs *p, const sd_groups *groups, int n)
{
  const sd_ewald_groups *g = &p->groups;
  const int all = groups->first[groups->n];
  int there = 0;
  if (!(g->reach > 0.0) || g->groups != groups->n || g->points != all || g->ours != n) return 0;
  for (int i = 0; i < all; i++) there += p->spheres.a[i] > 0.0;
  int same = there == p->rows && g->cells.rows == groups->n;
  for (int k = 0; k < g->cells.rows && same; k++) {
    const int *own = groups->first + g->cells.place[k];
    same = p->sphere[g->first[k]] >= own[0] && p->sphere[g->first[k + 1] - 1] < own[1];
  }
  for (int k = 0; k < p->rows && same && there < all; k++) same = p->spheres.a[p->sphere[k]] > 0.0;
  return same;
}

/* Middle of the rows of group k; *farthest as above */
static void middle_of_rows(const sd_ewald_pairs *p, int k, double at[3], double *farthest)
{
  const int begin = p->groups.first[k], end = p->groups.first[k + 1];
  const double *centre = sd_ewald_centres(p);
  double squares[SD_GROUP_POINTS] = {0.0};
  for (long d = 0; d < 3; d++) {
    const double *x = centre + d * p->rows;
    at[d] = 0.0;
    for (int i = begin; i < end; i++) at[d] += x[i];
    at[d] /= end - begin;
    for (int i = begin; i < end; i++) squares[i - begin] += (x[i] - at[d]) * (x[i] - at[d]);
  }
  for (int i = 0; i < SD_GROUP_POINTS; i++) *farthest = squares[i] > *farthest ? squares[i] : *farthest;
}

/* The rows and where they are now, in the order of before: do the lists hold? */
static int lists_hold(sd_ewald_pairs *p, const sd_groups *groups, int n)
{
  sd_ewald_groups *g = &p->groups;
  double moved = 0.0, farthest = 0.0, at[3];
  if (!same_rows(p, groups, n)) return 0;
  sd_ewald_pairs_gather(p);
  for (int k = 0; k < g->cells.rows; k++) {
    double square = 0.0;
    middle_of_rows(p, k, at, &farthest);
    for (long d = 0; d < 3; d++) {
      const double step = at[d] - g->middle[d * g->cells.rows + k];
      square += step * step;
      g->cells.centre[d * g->cells.rows + k] = at[d];
    }
    moved = square > moved ? square : moved;
  }
  g->farthest = sqrt(farthest);
  return reach_of_middles(p) + 2.0 * sqrt(moved) <= g->reach;
}

/* Of groups in order of cells the points */
static void list_rows(sd_ewald_pairs *p, const sd_groups *groups, int n)
{
  sd_ewald_groups *g = &p->groups;
  p->rows = p->n = 0;
  for (int k = 0; k < g->cells.rows; k++) {
    const int group = g->cells.place[k];
    g->first[k] = p->rows;
    for (int i = groups->first[group]; i < groups->first[group + 1]; i++)
      if (p->spheres.a[i] > 0.0) {
        if (i < n) p->target[p->n++] = p->rows;
        p->sphere[p->rows++] = i;
      }
  }
  g->first[g->cells.rows] = p->rows;
}

sd_status sd_ewald_groups_sort(sd_ewald_pairs *p, const sd_groups *groups, int n)
{
  sd_ewald_groups *g = &p->groups;
  const size_t count = (size_t) groups->n;
  if (lists_hold(p, groups, n)) return SD_OK;
  g->reach = 0.0;
  if (!sd_reserve(&g->middle, sizeof(double), 7 * count + SD_FULL, &g->middle_room) ||
      !sd_reserve(&g->first, sizeof(int), count + 1, &g->first_room))
    return SD_ENOMEMORY;
  double *points = g->middle + 3 * count, farthest = 0.0;
  for (int k = 0; k < groups->n; k++)
    points[k] = find_middle(groups, &p->spheres, k, g->middle + 3 * (long) k, &farthest);
  g->farthest = sqrt(farthest);
  const sd_status status = sd_ewald_cells_sort(&g->cells, g->middle, points, groups->n,
                                               sd_with_skin(reach_of_middles(p)), p->turn, points + count);
  if (status != SD_OK) return status;
  memcpy(g->middle, g->cells.centre, 3 * sizeof(double) * (size_t) g->cells.rows);
  list_rows(p, groups, n);
  sd_ewald_pairs_gather(p);
  return SD_OK;
}

/* --- neighbours --- */

typedef struct {
  sd_ewald_pairs *pairs;
  const sd_groups *groups;
  int n;
  /* candidates, neighbours of all rows or pairs of groups so far */
  long many;
} finder;

static int is_ghost(const finder *f, int row)
{
  return f->groups->first[f->pairs->groups.cells.place[row]] >= f->n;
}

static int form_of(const finder *f, int row)
{
  const sd_groups *all = f->groups;
  return all->form && !is_ghost(f, row) ? all->form[f->pairs->groups.cells.place[row]] : -1;
}

/* Rows of points in the groups near that of this row, its own first; groups side by side are one range. */
static int ranges_of_points(finder *f, int row, int found)
{
  sd_ewald_groups *g = &f->pairs->groups;
  int many = 1;
  g->range[1] = form_of(f, row) < 0 && !is_ghost(f, row) ? g->first[row + 1] : 0;
  for (int k = 0; k < found; k++) {
    const int other = g->near[k];
    if (many > 1 && g->range[2 * many - 1] == g->first[other]) many--;
    else g->range[2 * many] = g->first[other];
    g->range[2 * many + 1] = g->first[other + 1];
    many++;
  }
  return many;
}

/* Later groups that may get near that of a row; nobody wants pairs of ghosts. */
static sd_status visit_group(void *ctx, int row, int end, int ranges, long most)
{
  (void) end;
  finder *f = ctx;
  sd_ewald_groups *g = &f->pairs->groups;
  const sd_ewald_cells *c = &g->cells;
  const int ghost = is_ghost(f, row);
  double x[3];
  if (!sd_extend(&g->candidate, sizeof(int), (size_t) (f->many + most + SD_FULL), &g->candidate_room))
    return SD_ENOMEMORY;
  int *found = g->candidate + f->many;
  sd_ewald_cells_at(c, row, x);
  const long all = f->pairs->doubles->search(c->centre, c->rows, c->range, ranges, x, 1, c->reach * c->reach, found);
  g->from[row] = f->many;
  for (long k = 0; k < all; k++)
    if (!ghost || !is_ghost(f, found[k])) g->candidate[f->many++] = found[k];
  return SD_OK;
}

static sd_status find_candidates(finder *f)
{
  sd_ewald_groups *g = &f->pairs->groups;
  if (!sd_reserve(&g->from, sizeof(long), (size_t) g->cells.rows + 1, &g->from_room)) return SD_ENOMEMORY;
  const sd_status status = sd_ewald_cells_walk(&g->cells, 1, visit_group, f);
  if (status != SD_OK) return status;
  g->from[g->cells.rows] = f->many;
  g->groups = f->groups->n;
  g->points = f->groups->first[g->groups];
  g->ours = f->n;
  g->reach = g->cells.reach;
  return SD_OK;
}

/* Those of the candidates that are near that of a row now, to g->near, which has room; returns how many */
static int groups_found(const sd_ewald_pairs *p, int row)
{
  const sd_ewald_groups *g = &p->groups;
  const double reach = reach_of_middles(p);
  double x[3], y[3];
  int found = 0;
  sd_ewald_cells_at(&g->cells, row, x);
  for (long k = g->from[row]; k < g->from[row + 1]; k++) {
    sd_ewald_cells_at(&g->cells, g->candidate[k], y);
    g->near[found] = g->candidate[k];
    found += sd_distance_squared(x, y) <= reach * reach;
  }
  return found;
}

/* Point by point */
static sd_status list_points(finder *f, int row, int found)
{
  sd_ewald_pairs *p = f->pairs;
  sd_ewald_groups *g = &p->groups;
  const int many = ranges_of_points(f, row, found);
  long points = SD_GROUP_POINTS;
  for (int k = 1; k < many; k++) points += g->range[2 * k + 1] - g->range[2 * k];
  for (int k = g->first[row]; k < g->first[row + 1]; k++) {
    if (!sd_extend(&p->neighbor, sizeof(int), (size_t) (f->many + points + 3 * SD_FULL), &p->neighbor_room))
      return SD_ENOMEMORY;
    g->range[0] = k + 1 < g->range[1] ? k + 1 : g->range[1];
    p->begin[k] = k;
    p->first[k] = f->many;
    f->many = sd_ewald_pairs_near(p, k, k + 1, many, g->range, f->many);
  }
  return SD_OK;
}

/* A bit for each point of a group that is near enough to the middle of another to be near one of its points */
static unsigned group_points_near(const sd_ewald_pairs *p, int row, int other)
{
  const sd_ewald_groups *g = &p->groups;
  const double reach = (p->ewald.range + g->farthest) * (1.0 + 1e-9), *centre = sd_ewald_centres(p);
  double x[3];
  unsigned near = 0;
  sd_ewald_cells_at(&g->cells, other, x);
  for (int k = g->first[row]; k < g->first[row + 1]; k++) {
    const double dx = centre[k] - x[0], dy = centre[p->rows + k] - x[1], dz = centre[2L * p->rows + k] - x[2];
    near |= (unsigned) (dx * dx + dy * dy + dz * dz <= reach * reach) << (k - g->first[row]);
  }
  return near;
}

/* As a whole; its own points among each other too where they have no block */
static sd_status list_groups(finder *f, int row, int found)
{
  sd_ewald_groups *g = &f->pairs->groups;
  const int itself = !is_ghost(f, row) && form_of(f, row) < 0;
  if (!sd_extend(&g->pair, sizeof(*g->pair), (size_t) (f->many + found + 1), &g->pair_room)) return SD_ENOMEMORY;
  g->begin[row] = f->many;
  if (itself) g->pair[f->many++] = (sd_near_group){row, 0};
  for (int k = 0; k < found; k++) {
    const unsigned points = group_points_near(f->pairs, g->near[k], row);
    if (points) g->pair[f->many++] = (sd_near_group){g->near[k], points};
  }
  return SD_OK;
}

static sd_status list_row(finder *f, int row)
{
  sd_ewald_groups *g = &f->pairs->groups;
  const size_t most = (size_t) (g->from[row + 1] - g->from[row]) + 1;
  if (!sd_reserve(&g->near, sizeof(int), most, &g->near_room) ||
      !sd_reserve(&g->range, sizeof(int), 2 * most, &g->range_room))
    return SD_ENOMEMORY;
  const int found = groups_found(f->pairs, row);
  return f->pairs->by_groups ? list_groups(f, row, found) : list_points(f, row, found);
}

sd_near_groups sd_ewald_groups_near(const sd_ewald_pairs *p)
{
  const sd_ewald_groups *g = &p->groups;
  return (sd_near_groups){g->cells.rows, g->first, g->begin, g->pair};
}

/* --- what the points of a group do to each other --- */

/* Column by column what the kernel of pairs makes of the rows of a group for unit forces, in doubles. */
static void make_block(const sd_ewald_pairs *p, int first, int points, double *block)
{
  sd_near_part part = sd_ewald_pairs_part(p);
  double row[8 * (SD_GROUP_POINTS + 1)], u[4 * (SD_GROUP_POINTS + 1)];
  int begin[SD_GROUP_POINTS + 1] = {0};
  long start[SD_GROUP_POINTS + 1] = {0};
  int neighbor[2 * SD_FULL * SD_GROUP_POINTS];
  for (int k = 0; k < points; k++) {
    begin[k + 1] = k + 1;
    start[k + 1] = start[k];
    for (int j = k + 1; j < points; j++) neighbor[start[k + 1]++] = j;
    while (start[k + 1] % SD_FULL) neighbor[start[k + 1]++] = points;
  }
  memset(row, 0, sizeof(row));
  for (int k = 0; k <= points; k++) {
    const long i = k < points ? p->sphere[first + k] : -1;
    for (int d = 0; d < 3; d++) row[8 * k + d] = i < 0 ? SD_NOWHERE : p->scale * p->spheres.x[3 * i + d];
    row[8 * k + 3] = i < 0 ? 0.0 : p->scale * p->spheres.a[i];
  }
  part.bunches = points;
  part.begin = begin;
  part.first = start;
  part.neighbor = neighbor;
  part.row = row;
  part.u = u;
  memset(block, 0, sizeof(double) * COLUMNS * SD_GROUP_ROW);
  for (int j = 0; j < 3 * points; j++) {
    for (int k = 0; k < points; k++)
      for (int d = 0; d < 3; d++) row[8 * k + 4 + d] = 3 * k + d == j;
    memset(u, 0, sizeof(u));
    p->doubles->near_part(&part);
    for (int k = 0; k < points; k++)
      for (int d = 0; d < 3; d++)
        block[SD_GROUP_ROW * j + 3 * k + d] = p->scale / (8.0 * SD_PI) * u[4 * k + d];
  }
}

/* Of the first group of each form; a form of which there is no group of ours has none. */
static sd_status make_blocks(finder *f)
{
  sd_ewald_groups *g = &f->pairs->groups;
  int forms = 0;
  g->own = 0;
  for (int k = 0; k < g->cells.rows; k++) forms = form_of(f, k) < forms ? forms : form_of(f, k) + 1;
  if (forms == 0) return SD_OK;
  const size_t most = (size_t) g->cells.rows;
  if (!sd_reserve(&g->sphere, sizeof(int), most, &g->sphere_room) ||
      !sd_reserve(&g->form, sizeof(int), most, &g->form_room) ||
      !sd_reserve(&g->end, sizeof(int), most, &g->end_room) ||
      !sd_reserve(&g->block, sizeof(double) * COLUMNS * SD_GROUP_ROW, (size_t) forms, &g->block_room))
    return SD_ENOMEMORY;
  unsigned made = 0;
  int targets = 0;
  for (int k = 0; k < g->cells.rows; k++) {
    const int form = form_of(f, k), first = g->first[k];
    if (!is_ghost(f, k)) targets += g->first[k + 1] - first;
    if (form < 0) continue;
    if (!(made >> form & 1))
      make_block(f->pairs, first, g->first[k + 1] - first, g->block + COLUMNS * SD_GROUP_ROW * (long) form);
    made |= 1u << form;
    g->sphere[g->own] = f->pairs->sphere[first];
    g->end[g->own] = targets;
    g->form[g->own++] = form;
  }
  return SD_OK;
}

sd_status sd_ewald_groups_find(sd_ewald_pairs *p, const sd_groups *groups, int n)
{
  sd_ewald_groups *g = &p->groups;
  finder f = {.pairs = p, .groups = groups, .n = n};
  if (p->by_groups && !sd_reserve(&g->begin, sizeof(long), (size_t) g->cells.rows + 1, &g->begin_room))
    return SD_ENOMEMORY;
  sd_status status = g->reach > 0.0 ? SD_OK : find_candidates(&f);
  f.many = 0;
  for (int row = 0; row < g->cells.rows && status == SD_OK; row++) status = list_row(&f, row);
  if (p->by_groups) g->begin[g->cells.rows] = f.many;
  else {
    p->bunches = p->begin[p->rows] = p->rows;
    p->first[p->rows] = f.many;
  }
  return status == SD_OK ? make_blocks(&f) : status;
}

/* Groups are in order of cells, and their points anywhere in memory. */
static void fetch_forces(const double *F)
{
  enum { LINE = 8 };
  for (int d = 0; d < COLUMNS; d += LINE) sd_fetch(F + d);
}

void sd_ewald_groups_apply(const sd_ewald_pairs *p, int begin, int end, const double *F, double *u)
{
  enum { AHEAD = 3 };
  const sd_ewald_groups *g = &p->groups;
  for (int k = begin; k < end; k++) {
    const long i = g->sphere[k];
    fetch_forces(F + 3 * (long) g->sphere[k + AHEAD < g->own ? k + AHEAD : k]);
    const double w = p->spheres.w[i];
    p->doubles->own_block(g->block + COLUMNS * SD_GROUP_ROW * (long) g->form[k], w * w, F + 3 * i, u + 3 * i);
  }
}
