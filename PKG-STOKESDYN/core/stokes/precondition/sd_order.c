#include "sd_order.h"

#include "sd_hash.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Cells of one side over some of the spheres, chained; a hash of the cell's three numbers picks the
 * chain. */
typedef struct {
  double side;
  int buckets; /* a power of two */
  int *head, *next;
} cells;

static int64_t cell_of(const cells *c, double x)
{
  return (int64_t) floor(x / c->side);
}

static int bucket(const cells *c, int64_t i, int64_t j, int64_t k)
{
  const uint64_t h = (uint64_t) i * SD_HASH_STEP ^ (uint64_t) j * 0xc2b2ae3d27d4eb4fu ^
      (uint64_t) k * 0x165667b19e3779f9u;
  return (int) ((h ^ (h >> 29)) & (uint64_t) (c->buckets - 1));
}

static void cells_clear(cells *c, double side)
{
  c->side = side;
  for (int k = 0; k < c->buckets; k++) c->head[k] = -1;
}

static void cells_add(cells *c, const double *x, int i)
{
  const double *p = x + 3 * (long) i;
  const int b = bucket(c, cell_of(c, p[0]), cell_of(c, p[1]), cell_of(c, p[2]));
  c->next[i] = c->head[b];
  c->head[b] = i;
}

static int cells_create(cells *c, int n)
{
  c->buckets = 16;
  while (c->buckets < n) c->buckets *= 2;
  c->head = malloc(sizeof(int) * (size_t) c->buckets);
  c->next = malloc(sizeof(int) * (size_t) (n + 1));
  return c->head && c->next;
}

static void cells_free(cells *c)
{
  free(c->head);
  free(c->next);
}

static double squared(const double *x, int i, int j)
{
  const double *p = x + 3 * (long) i, *q = x + 3 * (long) j;
  const double d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
  return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

/* for (j: the spheres in the cells that the ball around sphere i meets) */
#define FOR_EACH_NEAR(c, x, i, radius, j)                                                         \
  for (int64_t cx_ = cell_of(c, (x)[3 * (long) (i)] - (radius)),                                  \
               cx1_ = cell_of(c, (x)[3 * (long) (i)] + (radius));                                 \
       cx_ <= cx1_; cx_++)                                                                        \
    for (int64_t cy_ = cell_of(c, (x)[3 * (long) (i) + 1] - (radius)),                            \
                 cy1_ = cell_of(c, (x)[3 * (long) (i) + 1] + (radius));                           \
         cy_ <= cy1_; cy_++)                                                                      \
      for (int64_t cz_ = cell_of(c, (x)[3 * (long) (i) + 2] - (radius)),                          \
                   cz1_ = cell_of(c, (x)[3 * (long) (i) + 2] + (radius));                         \
           cz_ <= cz1_; cz_++)                                                                    \
        for (int j = (c)->head[bucket(c, cx_, cy_, cz_)]; j >= 0; j = (c)->next[j])               \
          if (cell_of(c, (x)[3 * (long) j]) == cx_ && cell_of(c, (x)[3 * (long) j + 1]) == cy_ && \
              cell_of(c, (x)[3 * (long) j + 2]) == cz_)

/* Heap of spheres, the one with the largest key on top; equal keys: the smaller index. Keys only
 * fall, and are put right when met. */
typedef struct {
  int count;
  int *sphere;
  double *key;
} heap;

static int above(const heap *h, int i, int j)
{
  return h->key[i] > h->key[j] || (h->key[i] == h->key[j] && h->sphere[i] < h->sphere[j]);
}

static void sink(heap *h, int i)
{
  for (;;) {
    int top = i;
    for (int child = 2 * i + 1; child <= 2 * i + 2; child++)
      if (child < h->count && above(h, child, top)) top = child;
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

static int gather_active(const sd_spheres *s, int n, int *list, double *extent)
{
  double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
  int count = 0;
  *extent = 0.0;
  for (int i = 0; i < n; i++) {
    if (!(s->a[i] > 0.0)) continue;
    list[count++] = i;
    for (int d = 0; d < 3; d++) {
      lo[d] = fmin(lo[d], s->x[3 * (long) i + d]);
      hi[d] = fmax(hi[d], s->x[3 * (long) i + d]);
    }
  }
  for (int d = 0; d < 3 && count > 0; d++) *extent = fmax(*extent, hi[d] - lo[d]);
  return count;
}

/* Cells small enough to find few, and not so small that their numbers overflow. */
static double cell_side(double reach, double extent)
{
  const double least = 1e-9 * extent;
  return reach > least ? reach : least > 0.0 ? least : 1.0;
}

int sd_farthest_first(const sd_spheres *s, int n, int *order, double *distance)
{
  const double *x = s->x;
  double extent;
  cells c = {0};
  heap h = {0};
  double *sq = malloc(sizeof(double) * (size_t) (n + 1));
  h.sphere = malloc(sizeof(int) * (size_t) (n + 1));
  h.key = malloc(sizeof(double) * (size_t) (n + 1));
  int count = -1;
  if (!cells_create(&c, n) || !sq || !h.sphere || !h.key) goto end;

  count = gather_active(s, n, h.sphere, &extent);
  if (count == 0) goto end;
  order[0] = h.sphere[0];
  distance[0] = INFINITY;
  h.count = count - 1;
  for (int k = 0; k < h.count; k++) {
    h.sphere[k] = h.sphere[k + 1];
    h.key[k] = sq[h.sphere[k]] = squared(x, h.sphere[k], order[0]);
  }
  for (int k = h.count / 2; k >= 0; k--) sink(&h, k);

  c.side = INFINITY;
  for (int found = 1; found < count;) {
    const int i = h.sphere[0];
    if (h.key[0] > sq[i]) {
      h.key[0] = sq[i];
      sink(&h, 0);
      continue;
    }
    const double reach = sqrt(sq[i]);
    order[found] = i;
    distance[found++] = reach;
    h.count--;
    h.sphere[0] = h.sphere[h.count];
    h.key[0] = h.key[h.count];
    sink(&h, 0);
    if (2.0 * reach < c.side) { /* the spheres that are left, in cells of the new size */
      const double side = cell_side(reach, extent);
      if (side < c.side) {
        cells_clear(&c, side);
        for (int k = 0; k < h.count; k++) cells_add(&c, x, h.sphere[k]);
      }
    }
    FOR_EACH_NEAR(&c, x, i, reach, j)
    {
      const double d = squared(x, i, j);
      if (d < sq[j]) sq[j] = d;
    }
  }
end:
  cells_free(&c);
  free(sq);
  free(h.sphere);
  free(h.key);
  return count;
}

static sd_status find_rows(sd_rows *rows, const sd_spheres *s, int n, const int *order,
                           const double *distance, int count, double rho, int part, int parts)
{
  const double *x = s->x;
  double extent;
  cells c = {0};
  long capacity = 0, used = 0;
  sd_status status = SD_ENOMEMORY;
  int *list = malloc(sizeof(int) * (size_t) (n + 1));
  rows->first = malloc(sizeof(long) * (size_t) (count / parts + 2));
  if (!cells_create(&c, n) || !list || !rows->first) goto end;
  gather_active(s, n, list, &extent);

  c.side = INFINITY;
  rows->largest = 0;
  for (int k = 0; k < count; k++) {
    const int i = order[k];
    /* a little wider, so that rounding does not split the equal distances of a lattice */
    const double reach = k > 0 ? (1.0 + 1e-6) * rho * distance[k] : 0.0, reach_sq = reach * reach;
    if (k > 0 && 2.0 * reach < c.side) {
      const double side = cell_side(reach, extent);
      if (side < c.side) {
        cells_clear(&c, side);
        for (int l = 0; l < k; l++) cells_add(&c, x, order[l]);
      }
    }
    if (k % parts == part) {
      rows->first[rows->columns++] = used;
      if (used + k + 1 > capacity) {
        capacity = 2 * (used + k + 1);
        int *more = realloc(rows->row, sizeof(int) * (size_t) capacity);
        if (!more) goto end;
        rows->row = more;
      }
      rows->row[used++] = i;
      const long begin = used;
      if (k > 0) FOR_EACH_NEAR(&c, x, i, reach, j)
        {
          if (squared(x, i, j) <= reach_sq) rows->row[used++] = j;
        }
      if (used - begin + 1 > rows->largest) rows->largest = (int) (used - begin + 1);
    }
    if (k > 0) cells_add(&c, x, i); /* the first waits for the size of the cells */
  }
  rows->first[rows->columns] = used;
  status = SD_OK;
end:
  cells_free(&c);
  free(list);
  return status;
}

sd_status sd_rows_find(sd_rows *rows, const sd_spheres *s, int n, double rho, int part, int parts)
{
  int *order = malloc(sizeof(int) * (size_t) (n + 1));
  double *distance = malloc(sizeof(double) * (size_t) (n + 1));
  const int count = order && distance ? sd_farthest_first(s, n, order, distance) : -1;
  const sd_status status =
      count < 0 ? SD_ENOMEMORY : find_rows(rows, s, n, order, distance, count, rho, part, parts);
  free(order);
  free(distance);
  return status;
}

void sd_rows_free(sd_rows *rows)
{
  free(rows->first);
  free(rows->row);
  memset(rows, 0, sizeof(*rows));
}
