/* Groups (sd_ewald_groups.h) that are near each other: later ones within reach and skin, kept, and of these, anew each
 * time, those that have points near. */
#include "sd_ewald_groups.h"

#include "sd_linear.h"
#include "sd_room.h"

typedef struct {
  sd_ewald_pairs *pairs;
  const sd_groups *groups;
  int n;
  /* candidates, neighbours of all rows or pairs of groups so far */
  long many;
} finder;

static int eg_is_ghost(const finder *f, int row)
{
  return sd_ewald_groups_is_ghost(f->pairs, f->groups, f->n, row);
}

/* Are its own points among its neighbours? */
static int meets_itself(const finder *f, int row)
{
  return !eg_is_ghost(f, row) && sd_ewald_groups_form(f->pairs, f->groups, f->n, row) < 0;
}

/* Rows of points in the groups near that of this row, its own first; groups side by side are one range. */
static int ranges_of_points(finder *f, int row, int found)
{
  sd_ewald_groups *g = &f->pairs->groups;
  int many = 1;
  g->range[1] = meets_itself(f, row) ? g->first[row + 1] : 0;
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
  const int ghost = eg_is_ghost(f, row);
  double x[3];
  if (!sd_extend(&g->candidate, sizeof(int), (size_t) (f->many + most + SD_FULL), &g->candidate_room))
    return SD_ENOMEMORY;
  int *found = g->candidate + f->many;
  sd_ewald_cells_at(c, row, x);
  const sd_near_ranges later = {c->centre, c->rows, c->range, ranges};
  const long all = f->pairs->doubles->search(&later, x, 1, c->reach * c->reach, found);
  g->from[row] = f->many;
  for (long k = 0; k < all; k++)
    if (!ghost || !eg_is_ghost(f, found[k])) g->candidate[f->many++] = found[k];
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
  const double reach = sd_ewald_groups_reach(p);
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

/* Of one row, point by point */
static sd_status list_row(finder *f, int row)
{
  sd_ewald_pairs *p = f->pairs;
  sd_ewald_groups *g = &p->groups;
  const size_t most = (size_t) (g->from[row + 1] - g->from[row]) + 1;
  if (!sd_reserve(&g->near, sizeof(int), most, &g->near_room) ||
      !sd_reserve(&g->range, sizeof(int), 2 * most, &g->range_room))
    return SD_ENOMEMORY;
  const int many = ranges_of_points(f, row, groups_found(p, row));
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

static sd_status list_points(finder *f)
{
  sd_ewald_pairs *p = f->pairs;
  sd_status status = SD_OK;
  for (int row = 0; row < p->groups.cells.rows && status == SD_OK; row++) status = list_row(f, row);
  p->bunches = p->begin[p->rows] = p->rows;
  p->first[p->rows] = f->many;
  return status;
}

/* As a whole. A point that is near one of a group is as near to its middle, but for how far the points of this are
 * from there. */
static sd_status list_groups(finder *f)
{
  const sd_ewald_pairs *p = f->pairs;
  sd_ewald_groups *g = &f->pairs->groups;
  const int rows = g->cells.rows;
  const sd_group_places places = {sd_ewald_groups_arms(p), g->cells.centre, rows};
  const size_t most = (size_t) g->from[rows] + (size_t) rows;
  if (!sd_reserve(&g->begin, sizeof(long), (size_t) rows + 1, &g->begin_room) ||
      !sd_reserve(&g->pair, sizeof(*g->pair), most, &g->pair_room))
    return SD_ENOMEMORY;
  for (int row = 0; row < rows; row++) {
    g->begin[row] = f->many;
    if (meets_itself(f, row)) g->pair[f->many++] = (sd_near_group){row, 0};
    f->many += p->kernels->groups_near(&places, row, g->candidate + g->from[row], g->from[row + 1] - g->from[row],
                                       p->ewald.range + g->farthest, g->pair + f->many);
  }
  g->begin[rows] = f->many;
  return SD_OK;
}

sd_status sd_ewald_groups_find(sd_ewald_pairs *p, const sd_groups *groups, int n)
{
  finder f = {.pairs = p, .groups = groups, .n = n};
  const sd_status status = p->groups.reach > 0.0 ? SD_OK : find_candidates(&f);
  f.many = 0;
  return status != SD_OK ? status : p->by_groups ? list_groups(&f) : list_points(&f);
}

sd_near_groups sd_ewald_groups_near(const sd_ewald_pairs *p)
{
  const sd_ewald_groups *g = &p->groups;
  return (sd_near_groups){g->cells.rows, g->first, g->begin, g->pair};
}
