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
sd_status sd_neighbors_cutoff(sd_neighbors *list, const double *x, int n, int n_all, double cutoff)
{
  sd_status status = sd_neighbors_reserve(list, n, 0);
  if (status != SD_OK) return status;
  list->pairs.n = n;
  list->first[0] = 0;
  if (n_all == 0) return SD_OK;

  double lo[3], hi[3];
  for (int d = 0; d < 3; d++) lo[d] = hi[d] = x[d];
  for (int j = 1; j < n_all; j++)
    for (int d = 0; d < 3; d++) {
      lo[d] = fmin(lo[d], x[3 * (long) j + d]);
      hi[d] = fmax(hi[d], x[3 * (long) j + d]);
    }
  /* Never many more cells than spheres: a thin cloud gets wider cells. */
  double side = cutoff;
  long cells[3];
  for (;; side *= 1.5) {
    double total = 1.0;
    for (int d = 0; d < 3; d++) total *= floor((hi[d] - lo[d]) / side) + 1.0;
    if (total <= 4.0 * n_all + 64.0) break;
  }
  for (int d = 0; d < 3; d++) cells[d] = (long) floor((hi[d] - lo[d]) / side) + 1;

  const long n_cells = cells[0] * cells[1] * cells[2];
  int *head = malloc(sizeof(int) * (size_t) n_cells), *next = malloc(sizeof(int) * (size_t) n_all);
  if (!head || !next) {
    free(head);
    free(next);
    return SD_ENOMEMORY;
  }
  for (long c = 0; c < n_cells; c++) head[c] = -1;
  for (int j = n_all - 1; j >= 0; j--) { /* backwards, so that each chain runs in order of index */
    long c[3];
    for (int d = 0; d < 3; d++) c[d] = (long) floor((x[3 * (long) j + d] - lo[d]) / side);
    const long cell = (c[2] * cells[1] + c[1]) * cells[0] + c[0];
    next[j] = head[cell];
    head[cell] = j;
  }

  const double cutsq = cutoff * cutoff;
  long count = 0;
  for (int i = 0; i < n && status == SD_OK; i++) {
    const double *xi = x + 3 * (long) i;
    long from[3], to[3];
    list->first[i] = count;
    for (int d = 0; d < 3; d++) {
      const long c = (long) floor((xi[d] - lo[d]) / side);
      from[d] = c > 0 ? c - 1 : 0;
      to[d] = c + 1 < cells[d] ? c + 1 : cells[d] - 1;
    }
    for (long cz = from[2]; cz <= to[2]; cz++)
      for (long cy = from[1]; cy <= to[1]; cy++)
        for (long cx = from[0]; cx <= to[0]; cx++)
          for (int j = head[(cz * cells[1] + cy) * cells[0] + cx]; j >= 0; j = next[j]) {
            if (j == i || distance_squared(xi, x + 3 * (long) j) > cutsq) continue;
            if (count == list->capacity &&
                (status = sd_neighbors_reserve(list, n, count + 1)) != SD_OK)
              goto done;
            list->neighbor[count++] = j;
          }
  }
done:
  list->first[n] = count;
  free(head);
  free(next);
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

static double oseen_entry(const sd_law *law, const sd_spheres *s, int i, int j)
{
  const double product = s->a[i] * s->a[j];
  const double R = sqrt(distance_squared(s->x + 3 * (long) i, s->x + 3 * (long) j));
  return product > 0.0 ? sd_taper_factor(law, R) * 1.5 * sqrt(product) / R : 0.0;
}

double sd_oseen_coupling(const sd_law *law, const sd_spheres *s, const sd_pairs *pairs, int n_all,
                         int begin, int n)
{
  double largest = 0.0;
  if (pairs) {
    for (int i = 0; i < pairs->n; i++)
      for (long k = pairs->first[i]; k < pairs->first[i + 1]; k++)
        largest = fmax(largest, oseen_entry(law, s, i, pairs->neighbor[k]));
  } else
    for (int i = begin; i < begin + n; i++)
      for (int j = 0; j < n_all; j++)
        if (j != i) largest = fmax(largest, oseen_entry(law, s, i, j));
  return largest;
}
