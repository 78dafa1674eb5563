#include "sd_sph_drops.h"

#include "sd_sph_tension_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Particles of other pair styles, which have no volume here, are in no drop. */
static int is_fluid(const sd_sph_film *f, int i)
{
  return !(f->wall && f->wall[i]) && f->x4[4 * (size_t) i + 3] != 0.0;
}

/* The root of the tree of i; the way there is halved for the next who asks. */
static int drops_root_of(int *parent, int i)
{
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/* Makes one tree of the points of two cells, which each are one, if any two of them are in reach: 1 if they have been
 * two. */
static int drops_join(const sd_sph_film *f, double reach, const sd_cells *c, int first, int other, int *parent)
{
  const int one = drops_root_of(parent, first), two = drops_root_of(parent, other);
  if (one == two) return 0;
  for (int i = first; i >= 0; i = c->next[i])
    for (int j = other; j >= 0; j = c->next[j]) {
      const double *x = f->x4 + 4 * (size_t) i, *y = f->x4 + 4 * (size_t) j;
      const double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
      if (!(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < reach * reach)) continue;
      parent[two] = one;
      return 1;
    }
  return 0;
}

/* Joins cells that are `ring` apart along one direction and not more along others, each pair once; returns how many
 * trees that has taken away. */
static int drops_join_ring(const sd_sph_film *f, double reach, const sd_cells *c, int ring, int *parent)
{
  const int up = f->surface->dimension == 3 ? ring : 0;
  uint64_t number;
  int joined = 0;
  for (int i = 0; i < f->all; i++) {
    if (!is_fluid(f, i) || c->next[i] >= 0) continue;    // of each cell the last one of its chain
    int64_t at[3];
    for (int d = 0; d < 3; d++) at[d] = sd_cells_along(c, f->x4[4 * (size_t) i + d] - c->lo[d]);
    const int first = sd_cells_slot(c, at[0], at[1], at[2], &number)->first;
    for (int z = 0; z <= up; z++)
      for (int y = z > 0 ? -ring : 0; y <= ring; y++)
        for (int x = z > 0 || y > 0 ? -ring : 1; x <= ring; x++) {
          if (abs(x) < ring && abs(y) < ring && z < ring) continue;
          const int other = sd_cells_slot(c, at[0] + x, at[1] + y, at[2] + z, &number)->first;
          if (other >= 0) joined += drops_join(f, reach, c, first, other, parent);
        }
  }
  return joined;
}

/* All points of a cell are in reach of each other, and no point is of one that is more than two cells away. After
 * the next cells nearly all of a drop is one tree, so that few pairs are asked for their distance; a scene that is one
 * drop is known then. */
int sd_sph_find_drops(const sd_sph_film *f, double reach, sd_cells *cells, int *parent)
{
  const double lo[3] = {0.0, 0.0, 0.0}, side = reach / sqrt(f->surface->dimension) * (1.0 - 1e-9);
  int trees = 0;
  sd_cells_clear(cells, lo, side);
  for (int i = 0; i < f->all; i++) {
    parent[i] = i;
    if (!is_fluid(f, i)) continue;
    sd_cells_add(cells, f->x4 + i, i);    // rows of four: x4[i + 3 i]
    if (cells->next[i] >= 0)
      parent[i] = parent[cells->next[i]];
    else
      trees++;
  }
  for (int ring = 1; ring <= 2 && trees > 1; ring++) trees -= drops_join_ring(f, reach, cells, ring, parent);
  return trees;
}

int sd_sph_name_drops(int all, int *parent, double *name)
{
  int changed = 0;
  for (int i = 0; i < all; i++) {
    const int root = drops_root_of(parent, i);
    if (name[i] < name[root]) name[root] = name[i];
  }
  for (int i = 0; i < all; i++) {
    const double of_drop = name[drops_root_of(parent, i)];
    changed |= of_drop < name[i];
    name[i] = of_drop;
  }
  return changed;
}

int sd_sph_list_drops(const sd_sph_film *f, int *parent, const double *name, int *of, sd_sph_drop *out)
{
  int count = 0;
  for (int i = 0; i < f->all; i++) of[i] = -1;
  for (int i = 0; i < f->list->n; i++) {
    if (!is_fluid(f, i)) continue;
    int *at = &of[drops_root_of(parent, i)];
    if (*at < 0) {
      *at = count++;
      out[*at] = (sd_sph_drop){.name = name[i]};
    }
    of[i] = *at;
    out[*at].V += fabs(f->x4[4 * (size_t) i + 3]);
  }
  return count;
}

void sd_sph_sum_drops(const sd_sph_film *f, const int *of, const char *held, const double *F, int count,
                      sd_sph_drop *drops)
{
  for (int k = 0; k < count; k++) drops[k] = (sd_sph_drop){.name = drops[k].name, .V = drops[k].V};
  for EACH_NEAR(f, row, i)
    for (int d = 0; d < 3 && of[i] >= 0; d++) drops[of[i]].F[d] += F[3 * (size_t) i + d];
  for (int i = 0; i < f->list->n && held; i++)
    if (held[i] && of[i] >= 0) drops[of[i]].held = 1.0;
}

static int by_name(const void *a, const void *b)
{
  const double one = ((const sd_sph_drop *) a)->name, two = ((const sd_sph_drop *) b)->name;
  return (one > two) - (one < two);
}

/* Parts of one drop, which stand beside each other, become one. */
static int drops_add_up(int count, sd_sph_drop *drops)
{
  int last = -1;
  for (int k = 0; k < count; k++) {
    if (last < 0 || drops[last].name != drops[k].name) {
      drops[++last] = drops[k];
      continue;
    }
    for (int d = 0; d < 3; d++) drops[last].F[d] += drops[k].F[d];
    drops[last].V += drops[k].V;
    if (drops[k].held > drops[last].held) drops[last].held = drops[k].held;
  }
  return last + 1;
}

int sd_sph_join_drops(int parts, sd_sph_drop *drops, double sum[3])
{
  qsort(drops, (size_t) parts, sizeof(sd_sph_drop), by_name);
  const int count = drops_add_up(parts, drops);
  memset(sum, 0, 3 * sizeof(double));
  for (int k = 0; k < count; k++)
    for (int d = 0; d < 3 && drops[k].held > 0.0; d++) sum[d] += drops[k].F[d];
  return count;
}

void sd_sph_find_excess(int count, const sd_sph_drop *drops, int here, sd_sph_drop *mine)
{
  for (int k = 0; k < here; k++) {
    const sd_sph_drop *whole = bsearch(&mine[k], drops, (size_t) count, sizeof(sd_sph_drop), by_name);
    for (int d = 0; d < 3; d++) mine[k].F[d] = whole->held > 0.0 ? 0.0 : whole->F[d] / whole->V;
  }
}

void sd_sph_keep_momentum(const sd_sph_film *f, const int *of, const sd_sph_drop *excess, double *F)
{
  for (int i = 0; i < f->list->n; i++)
    for (int d = 0; d < 3 && of[i] >= 0; d++)
      F[3 * (size_t) i + d] -= fabs(f->x4[4 * (size_t) i + 3]) * excess[of[i]].F[d];
}
