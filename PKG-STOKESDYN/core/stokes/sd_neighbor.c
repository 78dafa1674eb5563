#define _GNU_SOURCE /* qsort_r */
#include "sd_neighbor.h"

#include <math.h>
#include <stdlib.h>

void sd_neighbors_free(sd_neighbors *list)
{
  free(list->first);
  free(list->neighbor);
  *list = (sd_neighbors){0};
}

sd_status sd_neighbors_reserve(sd_neighbors *list, int rows, long count)
{
  if (rows > list->rows || !list->first) {
    long *first = realloc(list->first, sizeof(long) * ((size_t) rows + 1));
    if (!first) return SD_ENOMEMORY;
    list->first = first;
    list->rows = rows;
  }
  if (count > list->capacity) {
    const long capacity = count + count / 4 + 64;
    int *neighbor = realloc(list->neighbor, sizeof(int) * (size_t) capacity);
    if (!neighbor) return SD_ENOMEMORY;
    list->neighbor = neighbor;
    list->capacity = capacity;
  }
  list->pairs.first = list->first;
  list->pairs.neighbor = list->neighbor;
  return SD_OK;
}

static double distance_squared(const double *a, const double *b)
{
  const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  return x * x + y * y + z * z;
}

/* Cells as chains: head[cell] is its first sphere, next[j] the one after j, -1 the end. */
typedef struct {
  double lo[3], side;
  long n[3];
  int *head, *next;
} cells;

static long cell_along(const cells *c, const double *x, int d)
{
  return (long) ((x[d] - c->lo[d]) / c->side);
}

static void cells_free(cells *c)
{
  free(c->head);
  free(c->next);
}

/* n_all > 0 spheres. Never many more cells than spheres: a thin cloud gets wider ones than side. */
static sd_status cells_create(cells *c, const double *x, int n_all, double side)
{
  double hi[3];
  for (int d = 0; d < 3; d++) c->lo[d] = hi[d] = x[d];
  for (int j = 1; j < n_all; j++)
    for (int d = 0; d < 3; d++) {
      c->lo[d] = fmin(c->lo[d], x[3 * (long) j + d]);
      hi[d] = fmax(hi[d], x[3 * (long) j + d]);
    }
  for (c->side = side;; c->side *= 1.5) {
    double total = 1.0;
    for (int d = 0; d < 3; d++) total *= floor((hi[d] - c->lo[d]) / c->side) + 1.0;
    if (total <= 4.0 * n_all + 64.0) break;
  }
  for (int d = 0; d < 3; d++) c->n[d] = cell_along(c, hi, d) + 1;

  const long count = c->n[0] * c->n[1] * c->n[2];
  c->head = malloc(sizeof(int) * (size_t) count);
  c->next = malloc(sizeof(int) * (size_t) n_all);
  if (!c->head || !c->next) {
    cells_free(c);
    return SD_ENOMEMORY;
  }
  for (long k = 0; k < count; k++) c->head[k] = -1;
  for (int j = n_all - 1; j >= 0; j--) { /* backwards, so that each chain runs in order of index */
    const double *xj = x + 3 * (long) j;
    const long k =
        (cell_along(c, xj, 2) * c->n[1] + cell_along(c, xj, 1)) * c->n[0] + cell_along(c, xj, 0);
    c->next[j] = c->head[k];
    c->head[k] = j;
  }
  return SD_OK;
}

/* The first spheres of the cell of x and of those around it, 27 at most; returns how many cells. */
static int cells_around(const cells *c, const double *x, int first[27])
{
  long from[3], to[3];
  int count = 0;
  for (int d = 0; d < 3; d++) {
    const long k = cell_along(c, x, d);
    from[d] = k > 0 ? k - 1 : 0;
    to[d] = k + 1 < c->n[d] ? k + 1 : c->n[d] - 1;
  }
  for (long z = from[2]; z <= to[2]; z++)
    for (long y = from[1]; y <= to[1]; y++)
      for (long k = from[0]; k <= to[0]; k++)
        first[count++] = c->head[(z * c->n[1] + y) * c->n[0] + k];
  return count;
}

sd_status sd_neighbors_cutoff(sd_neighbors *list, const double *x, int n, int n_all, double cutoff)
{
  sd_status status = sd_neighbors_reserve(list, n, 0);
  if (status != SD_OK) return status;
  list->pairs.n = n;
  list->first[0] = 0;
  if (n_all == 0) return SD_OK;
  cells c;
  status = cells_create(&c, x, n_all, cutoff);
  if (status != SD_OK) return status;

  const double cutsq = cutoff * cutoff;
  long count = 0;
  for (int i = 0; i < n; i++) {
    const double *xi = x + 3 * (long) i;
    int first[27];
    const int around = cells_around(&c, xi, first);
    list->first[i] = count;
    for (int k = 0; k < around; k++)
      for (int j = first[k]; j >= 0; j = c.next[j]) {
        if (j == i || distance_squared(xi, x + 3 * (long) j) > cutsq) continue;
        if (count == list->capacity && (status = sd_neighbors_reserve(list, n, count + 1)) != SD_OK)
          goto done;
        list->neighbor[count++] = j;
      }
  }
done:
  list->first[n] = count;
  cells_free(&c);
  return status;
}

typedef struct {
  const int64_t *tag, *molecule;
} clump_keys;

static int by_molecule_tag_index(const void *pa, const void *pb, void *ctx)
{
  const clump_keys *key = ctx;
  const int a = *(const int *) pa, b = *(const int *) pb;
  if (key->molecule[a] != key->molecule[b]) return key->molecule[a] < key->molecule[b] ? -1 : 1;
  if (key->tag[a] != key->tag[b]) return key->tag[a] < key->tag[b] ? -1 : 1;
  return (a > b) - (a < b);
}

sd_status sd_neighbors_clump(sd_neighbors *list, const double *x, const int64_t *tag,
                             const int64_t *molecule, int n, int n_all, double cutoff, int one_row,
                             int *order)
{
  sd_status status = sd_neighbors_reserve(list, n, 0);
  if (status != SD_OK) return status;
  list->pairs.n = n;
  for (int j = 0; j < n_all; j++) order[j] = j;
  clump_keys keys = {tag, molecule};
  qsort_r(order, (size_t) n_all, sizeof(int), by_molecule_tag_index, &keys);

  /* begin[i], end[i]: the block of the sorted spheres that has the molecule of target i */
  int *begin = malloc(sizeof(int) * 2 * ((size_t) n + 1)), *end = begin + n;
  if (!begin) return SD_ENOMEMORY;
  for (int b = 0, e; b < n_all; b = e) {
    int rows = molecule[order[b]] != 0; /* molecule 0: a lone sphere */
    for (e = b + 1; e < n_all && molecule[order[e]] == molecule[order[b]]; e++) {}
    for (int k = b; k < e; k++)
      if (order[k] < n) {
        begin[order[k]] = b;
        end[order[k]] = rows ? e : b;
        if (one_row) rows = 0;
      }
  }

  const double cutsq = cutoff * cutoff;
  long count = 0;
  for (int i = 0; i < n; i++) {
    const double *xi = x + 3 * (long) i;
    list->first[i] = count;
    for (int k = begin[i], e; k < end[i]; k = e) {
      int closest = order[k];
      double rsq = distance_squared(xi, x + 3 * (long) closest);
      for (e = k + 1; e < end[i] && tag[order[e]] == tag[closest]; e++) {
        const double other = distance_squared(xi, x + 3 * (long) order[e]);
        if (other < rsq) {
          rsq = other;
          closest = order[e];
        }
      }
      if (tag[closest] == tag[i] || rsq > cutsq) continue;
      if (count == list->capacity && (status = sd_neighbors_reserve(list, n, count + 1)) != SD_OK)
        goto done;
      list->neighbor[count++] = closest;
    }
  }
done:
  list->first[n] = count;
  free(begin);
  return status;
}

/* The square of a pair's entry, if it is larger than that of the pairs before. A taper is at most 1, so that most pairs end
 * at the comparison. */
static double larger_oseen_entry(double largest, const sd_law *law, const sd_spheres *s, int i,
                                 int j)
{
  const double untapered = 2.25 * s->a[i] * s->a[j];
  const double R_squared = distance_squared(s->x + 3 * (long) i, s->x + 3 * (long) j);
  if (!(untapered > largest * R_squared)) return largest;
  const double R = sqrt(R_squared), t = sd_taper_factor(law, R);
  return R <= law->range ? fmax(largest, t * t * untapered / R_squared) : largest;
}

sd_status sd_oseen_coupling(const sd_law *law, const sd_spheres *s, const sd_pairs *pairs,
                            int n_all, int begin, int n, double *coupling)
{
  double largest = 0.0, a = 0.0;
  *coupling = 0.0;
  for (int i = begin; i < begin + n && pairs; i++)
    for (long k = pairs->first[i]; k < pairs->first[i + 1]; k++)
      largest = larger_oseen_entry(largest, law, s, i, pairs->neighbor[k]);
  for (int j = 0; j < n_all && !pairs; j++) a = fmax(a, s->a[j]);
  if (a > 0.0) {
    cells c;
    const sd_status status = cells_create(&c, s->x, n_all, 1.6 * a);
    if (status != SD_OK) return status;
    for (int i = begin; i < begin + n; i++) {
      int first[27];
      const int around = cells_around(&c, s->x + 3 * (long) i, first);
      for (int k = 0; k < around; k++)
        for (int j = first[k]; j >= 0; j = c.next[j])
          if (j != i) largest = larger_oseen_entry(largest, law, s, i, j);
    }
    cells_free(&c);
  }
  *coupling = sqrt(largest);
  return SD_OK;
}
