#include "sd_near.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

#include "sd_cells.h"
#include "sd_linear.h"
#include "sd_room.h"

/* Pairs in the order in which they are found: row and source */
typedef struct {
  int (*pair)[2];
  long count, capacity;
} found;

static sd_status append(found *f, int row, int source)
{
  if (f->count == f->capacity) {
    const long capacity = 2 * f->capacity + 1024;
    if (!sd_grow(&f->pair, sizeof(*f->pair), (size_t) capacity)) return SD_ENOMEMORY;
    f->capacity = capacity;
  }
  f->pair[f->count][0] = row;
  f->pair[f->count++][1] = source;
  return SD_OK;
}

typedef struct {
  const sd_spheres *s;
  int begin, n;
  double reach;
  found found;
} search;

/* The rows that are asked for are those of the targets begin ... begin + n - 1. */
static sd_status take(search *q, int i, int j)
{
  const int row = i - q->begin;
  return row >= 0 && row < q->n ? append(&q->found, row, j) : SD_OK;
}

/* Sphere j against those in the cells, which are of its class or of a larger one. In its own class
 * the other sphere finds j when its turn comes; a larger one does not look for smaller ones, so its
 * pair is taken here as well. */
static sd_status look_from(search *q, const sd_cells *c, int j, int own_class, double largest)
{
  const double *x = q->s->x, *a = q->s->a, *xj = x + 3 * (long) j;
  sd_status status = SD_OK;
  for (sd_cells_walk w = sd_cells_near(c, xj, 0.5 * q->reach * (a[j] + largest));
       sd_cells_step(c, &w);)
    for (int i = w.first; i >= 0 && status == SD_OK; i = c->next[i]) {
      const double limit = 0.5 * q->reach * (a[i] + a[j]);
      if (i == j || sd_distance_squared(x + 3 * (long) i, xj) > limit * limit) continue;
      status = take(q, j, i);
      if (!own_class && status == SD_OK) status = take(q, i, j);
    }
  return status;
}

/* Rows by counting. Pairs of row r are first counted in first[r + 2]; summed up, first[r + 1] is
 * where row r begins, and moves on with every pair that is put there until it is where row r + 1
 * begins. */
static sd_status sort_rows(sd_neighbors *list, const found *f, int n)
{
  const sd_status status = sd_neighbors_reserve(list, n + 1, f->count);
  if (status != SD_OK) return status;
  long *first = list->first;
  for (int i = 0; i <= n + 1; i++) first[i] = 0;
  for (long k = 0; k < f->count; k++) first[f->pair[k][0] + 2]++;
  for (int i = 2; i <= n + 1; i++) first[i] += first[i - 1];
  for (long k = 0; k < f->count; k++) list->neighbor[first[f->pair[k][0] + 1]++] = f->pair[k][1];
  list->pairs.n = n;
  return SD_OK;
}

/* Spheres whose largest radii are alike, a factor of two at most, go into cells that are as wide as
 * their reach. All that are no larger than those look there, so a ball meets 27 cells at most, and
 * few spheres that are too far away. */
sd_status sd_near_find(sd_neighbors *list, const sd_spheres *s, int begin, int n, int n_all,
                       double reach)
{
  search q = {.s = s, .begin = begin, .n = n, .reach = reach};
  sd_cells c = {0};
  int lowest = INT_MAX, highest = INT_MIN;
  for (int i = 0; i < n_all; i++)
    if (s->a[i] > 0.0) {
      const int size = ilogb(s->a[i]);
      lowest = size < lowest ? size : lowest;
      highest = size > highest ? size : highest;
    }
  sd_status status = sd_cells_create(&c, n_all);
  for (int size = lowest; size <= highest && status == SD_OK; size++) {
    double largest = 0.0;
    for (int i = 0; i < n_all; i++)
      if (s->a[i] > largest && ilogb(s->a[i]) == size) largest = s->a[i];
    if (largest == 0.0) continue;
    sd_cells_clear(&c, (double[3]){0.0, 0.0, 0.0}, reach * largest);
    for (int i = n_all - 1; i >= 0; i--)
      if (s->a[i] > 0.0 && ilogb(s->a[i]) == size) sd_cells_add(&c, s->x, i);
    for (int j = 0; j < n_all && status == SD_OK; j++)
      if (s->a[j] > 0.0 && ilogb(s->a[j]) <= size)
        status = look_from(&q, &c, j, ilogb(s->a[j]) == size, largest);
  }
  if (status == SD_OK) status = sort_rows(list, &q.found, n);
  free(q.found.pair);
  sd_cells_free(&c);
  return status;
}
