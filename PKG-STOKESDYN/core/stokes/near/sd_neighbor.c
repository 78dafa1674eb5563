#include "sd_neighbor.h"

#include "sd_cells.h"
#include "sd_linear.h"
#include "sd_room.h"

#include <math.h>
#include <stdlib.h>

void sd_neighbors_free(sd_neighbors *list)
{
  free(list->first);
  free(list->neighbor);
  *list = (sd_neighbors){0};
}

/* A list is made again at every re-neighbouring, with about as many pairs as before. */
sd_status sd_neighbors_reserve(sd_neighbors *list, int rows, long count)
{
  if (!sd_extend(&list->first, sizeof(long), (size_t) rows + 1, &list->first_room) ||
      !sd_extend(&list->neighbor, sizeof(int), (size_t) count, &list->room))
    return SD_ENOMEMORY;
  list->pairs.first = list->first;
  list->pairs.neighbor = list->neighbor;
  return SD_OK;
}

/* One more source in the row that is being written */
static inline sd_status append(sd_neighbors *list, int rows, long *count, int j)
{
  if ((size_t) *count == list->room) {
    const sd_status status = sd_neighbors_reserve(list, rows, *count + 1);
    if (status != SD_OK) return status;
  }
  list->neighbor[(*count)++] = j;
  return SD_OK;
}

/* Cells as wide as the cut-off: a ball meets 27 of them, and holds 4 pi/3 of their volume. */
sd_status sd_neighbors_cutoff(sd_neighbors *list, const double *x, int n, int n_all, double cutoff)
{
  sd_cells c = {0};
  sd_status status = sd_neighbors_reserve(list, n, 0);
  if (status == SD_OK) status = sd_cells_fill(&c, x, n_all, cutoff);
  if (status != SD_OK) return status;
  list->pairs.n = n;

  const double cutsq = cutoff * cutoff;
  long count = 0;
  for (int i = 0; i < n && status == SD_OK; i++) {
    const double *xi = x + 3 * (long) i;
    list->first[i] = count;
    for (sd_cells_walk w = sd_cells_near(&c, xi, cutoff); sd_cells_step(&c, &w);)
      for (int j = w.first; j >= 0 && status == SD_OK; j = c.next[j])
        if (j != i && sd_distance_squared(xi, x + 3 * (long) j) <= cutsq)
          status = append(list, n, &count, j);
  }
  list->first[n] = count;
  sd_cells_free(&c);
  return status;
}

sd_status sd_smallest_gap(const double *x, const double *a, const int64_t *body, int n, int n_all,
                          double reach, double *gap)
{
  sd_neighbors list = {0};
  const sd_status status = sd_neighbors_cutoff(&list, x, n, n_all, reach);
  *gap = INFINITY;
  for (int i = 0; i < n && status == SD_OK; i++)
    for (long k = list.pairs.first[i]; k < list.pairs.first[i + 1]; k++) {
      const int j = list.pairs.neighbor[k];
      if (body && body[i] != 0 && body[i] == body[j]) continue;
      const double R = sqrt(sd_distance_squared(x + 3 * (long) i, x + 3 * (long) j));
      *gap = fmin(*gap, 2.0 * (R / (a[i] + a[j]) - 1.0));
    }
  sd_neighbors_free(&list);
  return status;
}

typedef struct {
  int64_t molecule, tag;
  int index;
} clump_key;

/* By clump, then the images of one sphere side by side, then by index, so that the order is the
 * same whatever the sorting does with equal keys. */
static int by_molecule_tag_index(const void *pa, const void *pb)
{
  const clump_key *a = pa, *b = pb;
  if (a->molecule != b->molecule) return a->molecule < b->molecule ? -1 : 1;
  if (a->tag != b->tag) return a->tag < b->tag ? -1 : 1;
  return (a->index > b->index) - (a->index < b->index);
}

static sd_status sort_by_clump(const sd_named *s, int n, int *order)
{
  clump_key *key = malloc(sizeof(clump_key) * ((size_t) n + 1));
  if (!key) return SD_ENOMEMORY;
  for (int j = 0; j < n; j++) key[j] = (clump_key){s->molecule[j], s->tag[j], j};
  qsort(key, (size_t) n, sizeof(clump_key), by_molecule_tag_index);
  for (int j = 0; j < n; j++) order[j] = key[j].index;
  free(key);
  return SD_OK;
}

/* Of the sorted spheres, those of the molecule of each target: begin ... end - 1; none for molecule
 * 0, which are lone spheres */
typedef struct {
  int begin, end;
} block;

static void blocks_of_targets(const sd_named *s, const int *order, int n, int n_all, block *of)
{
  for (int b = 0, e; b < n_all; b = e) {
    for (e = b + 1; e < n_all && s->molecule[order[e]] == s->molecule[order[b]]; e++) {}
    for (int k = b; k < e; k++)
      if (order[k] < n) of[order[k]] = (block){b, s->molecule[order[b]] ? e : b};
  }
}

/* The images of one sphere stand side by side in the block, from *k on: the one that is closest to
 * x. *k goes on to the next sphere. */
static int closest_image(const sd_named *s, const int *order, int end, const double *x, int *k,
                         double *rsq)
{
  int closest = order[*k];
  *rsq = sd_distance_squared(x, s->x + 3 * (long) closest);
  for (++*k; *k < end && s->tag[order[*k]] == s->tag[closest]; ++*k) {
    const double other = sd_distance_squared(x, s->x + 3 * (long) order[*k]);
    if (other < *rsq) {
      *rsq = other;
      closest = order[*k];
    }
  }
  return closest;
}

sd_status sd_neighbors_clump(sd_neighbors *list, const sd_named *s, int n, int n_all, double cutoff,
                             int *order)
{
  block *of = malloc(sizeof(block) * ((size_t) n + 1));
  sd_status status = of ? sd_neighbors_reserve(list, n, 0) : SD_ENOMEMORY;
  if (status == SD_OK) status = sort_by_clump(s, n_all, order);
  if (status == SD_OK) {
    long count = 0;
    list->pairs.n = n;
    blocks_of_targets(s, order, n, n_all, of);
    for (int i = 0; i < n && status == SD_OK; i++) {
      list->first[i] = count;
      for (int k = of[i].begin; k < of[i].end && status == SD_OK;) {
        double rsq;
        const int j = closest_image(s, order, of[i].end, s->x + 3 * (long) i, &k, &rsq);
        if (s->tag[j] != s->tag[i] && rsq <= cutoff * cutoff) status = append(list, n, &count, j);
      }
    }
    list->first[n] = count;
  }
  free(of);
  return status;
}

/* The square of a pair's entry, if it is larger than that of the pairs before. A taper is at most
 * 1, so that most pairs end at the comparison. */
static double larger_oseen_entry(double largest, const sd_law *law, const sd_spheres *s, int i,
                                 int j)
{
  const double untapered = 2.25 * s->a[i] * s->a[j];
  const double R_squared = sd_distance_squared(s->x + 3 * (long) i, s->x + 3 * (long) j);
  if (!(untapered > largest * R_squared)) return largest;
  const double R = sqrt(R_squared), t = sd_taper_factor(law, R);
  return R <= law->range ? fmax(largest, t * t * untapered / R_squared) : largest;
}

/* All pairs: entries fall as 1/R, so a pair farther apart than 1.6 radii of the largest sphere has
 * less than 1.5/1.6 and decides nothing; only near ones are looked at. */
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
    sd_cells c = {0};
    const sd_status status = sd_cells_fill(&c, s->x, n_all, 1.6 * a);
    if (status != SD_OK) return status;
    for (int i = begin; i < begin + n; i++) {
      sd_cells_walk w = sd_cells_near(&c, s->x + 3 * (long) i, 1.6 * a);
      while (sd_cells_step(&c, &w))
        for (int j = w.first; j >= 0; j = c.next[j])
          if (j != i) largest = larger_oseen_entry(largest, law, s, i, j);
    }
    sd_cells_free(&c);
  }
  *coupling = sqrt(largest);
  return SD_OK;
}
