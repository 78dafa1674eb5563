#include "sd_order.h"

#include "sd_cells.h"
#include "sd_linear.h"
#include "sd_room.h"

#include <stdlib.h>

static double squared(const double *x, int i, int j)
{
  return sd_distance_squared(x + 3 * (long) i, x + 3 * (long) j);
}

/* The same to seven digits, for the order: in rigid clumps and lattices distances are equal but for rounding,
 * which is another one on other ranks, and ties go by index. */
static double key(const double *x, int i, int j)
{
  return (float) squared(x, i, j);
}

/* The distances at which spheres come only shrink, and the cells follow: whenever the reach has
 * halved they are made as wide as it is now, so that a ball never meets more than a few of them,
 * and they are filled anew once for each scale that the scene has. Returns 1 when they are new and
 * empty. `extent`, of the whole scene, bounds them from below: spheres at one point have no
 * distance, and the numbers of cells have to fit into 64 bits. */
static int shrink(sd_cells *c, const double *corner, double reach, double extent)
{
  const double least = extent > 0.0 ? 1e-9 * extent : 1.0, side = fmax(reach, least);
  if (c->side > 0.0 && !(2.0 * reach < c->side && side < c->side)) return 0;
  sd_cells_clear(c, corner, side);
  return 1;
}

/* Heap of spheres, the one with the largest key on top; equal keys: the smaller index. Keys only
 * fall, and are put right when met. */
typedef struct {
  int count;
  int *sphere;
  double *key;
} heap;

static int or_above(const heap *h, int i, int j)
{
  return h->key[i] > h->key[j] || (h->key[i] == h->key[j] && h->sphere[i] < h->sphere[j]);
}

/* Down to where both children are below */
static void sink(heap *h, int i)
{
  for (;;) {
    int top = i;
    for (int child = 2 * i + 1; child <= 2 * i + 2; child++)
      if (child < h->count && or_above(h, child, top)) top = child;
    if (top == i) return;
    const double key = h->key[i];
    const int sphere = h->sphere[i];
    h->key[i] = h->key[top];
    h->sphere[i] = h->sphere[top];
    h->key[top] = key;
    h->sphere[top] = sphere;
    i = top;
  }
}

/* All spheres but the first into a heap, by their distance from it. Any heap will do while it is
 * filled; to sink all parents from the last on makes it one. */
static void heap_from(heap *h, const double *x, int first, double *sq)
{
  for (int k = 0; k < h->count; k++) h->key[k] = sq[h->sphere[k]] = key(x, h->sphere[k], first);
  for (int k = h->count / 2; k >= 0; k--) sink(h, k);
}

/* sq [n] is the distance squared, key(), of each sphere that is left from those taken so far. When the
 * farthest is taken, at the distance `reach`, only spheres nearer to it than that can come nearer;
 * their keys in the heap stay too large until they reach the top. The cells hold all that are left
 * and some that are not, which does no harm. */
static void take_farthest_first(const double *x, heap *h, sd_cells *c, double *sq, int *order,
                                double *distance)
{
  const double *corner = x + 3 * (long) order[0];
  const double extent = h->count > 0 ? sqrt(h->key[0]) : 0.0;
  for (int found = 1; h->count > 0;) {
    const int i = h->sphere[0];
    if (h->key[0] > sq[i]) {
      h->key[0] = sq[i];
      sink(h, 0);
      continue;
    }
    const double reach = sqrt(sq[i]);
    order[found] = i;
    distance[found++] = reach;
    h->count--;
    h->sphere[0] = h->sphere[h->count];
    h->key[0] = h->key[h->count];
    sink(h, 0);
    if (shrink(c, corner, reach, extent))
      for (int k = 0; k < h->count; k++) sd_cells_add(c, x, h->sphere[k]);
    for (sd_cells_walk w = sd_cells_near(c, x + 3 * (long) i, reach); sd_cells_step(c, &w);)
      for (int j = w.first; j >= 0; j = c->next[j]) sq[j] = fmin(sq[j], key(x, i, j));
  }
}

/* order [n] spheres that take part, farthest first; distance [n] of order[i] from those before it
 * (INFINITY for the first, which is the first that takes part). Returns their number, or -1 without
 * memory. O(n log n): each sphere is looked at by those taken within its present distance, which
 * are few at each scale, and a heap gives the farthest. */
static int farthest_first(const sd_spheres *s, int n, int *order, double *distance)
{
  sd_cells c = {0};
  heap h = {0};
  double *sq = malloc(sizeof(double) * (size_t) (n + 1));
  h.sphere = malloc(sizeof(int) * (size_t) (n + 1));
  h.key = malloc(sizeof(double) * (size_t) (n + 1));
  int count = -1;
  if (sq && h.sphere && h.key && sd_cells_create(&c, n) == SD_OK) {
    count = 0;
    for (int i = 0; i < n; i++) {
      if (!(s->a[i] > 0.0)) continue;
      if (count++ == 0) {
        order[0] = i;
        distance[0] = INFINITY;
      } else
        h.sphere[h.count++] = i;
    }
    if (count > 0) {
      heap_from(&h, s->x, order[0], sq);
      take_farthest_first(s->x, &h, &c, sq, order, distance);
    }
  }
  sd_cells_free(&c);
  free(sq);
  free(h.sphere);
  free(h.key);
  return count;
}

typedef struct {
  const double *x, *distance;
  const int *order;
  int count;
} ordered;

/* order[0] ... order[k - 1] are in the cells when it is the turn of order[k], which sees those
 * within rho times its distance: a little wider, so that rounding does not split the equal
 * distances of a lattice. The first sees nobody, and waits for the size of the cells. */
static sd_status find_rows(sd_rows *rows, const ordered *o, double rho, int part, int parts,
                           sd_cells *c)
{
  const double *x = o->x, extent = o->count > 1 ? o->distance[1] : 0.0;
  size_t room = 0;
  long used = 0;
  for (int k = 0; k < o->count; k++) {
    const int i = o->order[k];
    const double *xi = x + 3 * (long) i;
    const double reach = k > 0 ? (1.0 + 1e-6) * rho * o->distance[k] : 0.0;
    if (k > 0 && shrink(c, x + 3 * (long) o->order[0], reach, extent))
      for (int l = 0; l < k; l++) sd_cells_add(c, x, o->order[l]);
    if (k % parts == part) {
      const long begin = used;
      rows->first[rows->columns++] = begin;
      if (!sd_extend(&rows->row, sizeof(int), (size_t) (used + k + 1), &room)) return SD_ENOMEMORY;
      rows->row[used++] = i;
      if (k > 0)
        for (sd_cells_walk w = sd_cells_near(c, xi, reach); sd_cells_step(c, &w);)
          for (int j = w.first; j >= 0; j = c->next[j])
            if (squared(x, i, j) <= reach * reach) rows->row[used++] = j;
      if (used - begin > rows->largest) rows->largest = (int) (used - begin);
    }
    if (k > 0) sd_cells_add(c, x, i);
  }
  rows->first[rows->columns] = used;
  return SD_OK;
}

sd_status sd_rows_find(sd_rows *rows, const sd_spheres *s, int n, double rho, int part, int parts)
{
  sd_cells c = {0};
  int *order = malloc(sizeof(int) * (size_t) (n + 1));
  double *distance = malloc(sizeof(double) * (size_t) (n + 1));
  const int count = order && distance ? farthest_first(s, n, order, distance) : -1;
  *rows = (sd_rows){.first = malloc(sizeof(long) * (size_t) (n / parts + 2))};
  sd_status status = count >= 0 && rows->first ? sd_cells_create(&c, n) : SD_ENOMEMORY;
  if (status == SD_OK)
    status = find_rows(rows, &(ordered){s->x, distance, order, count}, rho, part, parts, &c);
  sd_cells_free(&c);
  free(order);
  free(distance);
  return status;
}

void sd_rows_free(sd_rows *rows)
{
  free(rows->first);
  free(rows->row);
  *rows = (sd_rows){0};
}
