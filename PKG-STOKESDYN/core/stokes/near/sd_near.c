#include "sd_neighbor.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "sd_cells.h"
#include "sd_linear.h"
#include "sd_room.h"
#include "sd_skin.h"

typedef struct {
  double x[3], a;
  int index;
} sphere;

/* A cell that holds spheres: where it is, and which of the sorted ones are its own */
typedef struct {
  int64_t at[3];
  int begin, end;
} cell;

typedef struct {
  const sd_spheres *s;
  /* a pair counts if one of the two is a target, 0 ... n - 1 */
  int n, n_all;
  double reach;
  /* hash of the cells, whose first is a number of `cell`; its next says so for each sphere */
  sd_cells hash;
  int cells;
  cell *cell;
  /* [n_all] those of a size, cell by cell */
  sphere *sorted;
  /* in the order in which they are found, each once */
  int (*pair)[2];
  long count;
  size_t room;
} search;

static sd_status create(search *q)
{
  const size_t room = (size_t) q->n_all + 1;
  q->cell = malloc(sizeof(cell) * room);
  q->sorted = malloc(sizeof(sphere) * room);
  const sd_status status = sd_cells_create(&q->hash, q->n_all);
  const int pairs = sd_extend(&q->pair, sizeof(*q->pair), 8 * room, &q->room);
  return q->cell && q->sorted && pairs ? status : SD_ENOMEMORY;
}

static void near_release(search *q)
{
  sd_cells_free(&q->hash);
  free(q->cell);
  free(q->sorted);
  free(q->pair);
}

/* One sphere against some of the sorted ones. Most are too far away, which a processor cannot
 * foresee: every pair is written, and those that count stay. */
static sd_status look_at(search *q, const sphere *one, int begin, int end)
{
  const size_t most = (size_t) (q->count + (end - begin));
  if (most > q->room && !sd_extend(&q->pair, sizeof(*q->pair), most, &q->room)) return SD_ENOMEMORY;
  const int is_target = one->index < q->n;
  const double half = 0.5 * q->reach;
  long count = q->count;
  for (int k = begin; k < end; k++) {
    const sphere *other = q->sorted + k;
    const double limit = half * (one->a + other->a);
    const int counts = is_target | (other->index < q->n);
    q->pair[count][0] = one->index;
    q->pair[count][1] = other->index;
    count += (sd_distance_squared(other->x, one->x) <= limit * limit) & counts;
  }
  q->count = count;
  return SD_OK;
}

static int near_size_of(const search *q, int i)
{
  return q->s->a[i] > 0.0 ? ilogb(q->s->a[i]) : INT_MAX;
}

static sphere sphere_of(const search *q, int i)
{
  const double *x = q->s->x + 3 * (long) i;
  return (sphere){{x[0], x[1], x[2]}, q->s->a[i], i};
}

/* All of a size, by counting */
static void sort_into_cells(search *q, int size)
{
  uint64_t number;
  int64_t at[3];
  q->cells = 0;
  for (int i = 0; i < q->n_all; i++) {
    if (near_size_of(q, i) != size) continue;
    for (int d = 0; d < 3; d++) at[d] = sd_cells_along(&q->hash, q->s->x[3 * (long) i + d]);
    sd_cell *slot = sd_cells_slot(&q->hash, at[0], at[1], at[2], &number);
    if (slot->first < 0) {
      *slot = (sd_cell){number, q->cells};
      q->cell[q->cells++] = (cell){{at[0], at[1], at[2]}, 0, 0};
    }
    q->hash.next[i] = slot->first;
    q->cell[slot->first].end++;
  }
  for (int c = 0, before = 0; c < q->cells; c++) {
    const int count = q->cell[c].end;
    q->cell[c].begin = q->cell[c].end = before;
    before += count;
  }
  for (int i = 0; i < q->n_all; i++)
    if (near_size_of(q, i) == size) q->sorted[q->cell[q->hash.next[i]].end++] = sphere_of(q, i);
}

/* Pairs of one size: those within cell c, and those with half of its neighbours, which do not look
 * at c again */
static sd_status near_look_around(search *q, int c)
{
  const cell *own = q->cell + c;
  sd_status status = SD_OK;
  for (int k = own->begin; k < own->end && status == SD_OK; k++)
    status = look_at(q, q->sorted + k, k + 1, own->end);
  for (int half = 14; half < 27; half++) {
    uint64_t number;
    const int64_t at[3] = {own->at[0] + half % 3 - 1, own->at[1] + half / 3 % 3 - 1,
                           own->at[2] + half / 9 - 1};
    const int other = sd_cells_slot(&q->hash, at[0], at[1], at[2], &number)->first;
    for (int k = own->begin; other >= 0 && k < own->end && status == SD_OK; k++)
      status = look_at(q, q->sorted + k, q->cell[other].begin, q->cell[other].end);
  }
  return status;
}

/* A smaller sphere against those in the cells */
static sd_status look_from(search *q, int i, double largest)
{
  const sphere one = sphere_of(q, i);
  sd_status status = SD_OK;
  for (sd_cells_walk w = sd_cells_near(&q->hash, one.x, 0.5 * q->reach * (one.a + largest));
       status == SD_OK && sd_cells_step(&q->hash, &w);)
    status = look_at(q, &one, q->cell[w.first].begin, q->cell[w.first].end);
  return status;
}

/* Spheres whose largest radii are alike, a factor of two at most, go into cells that are as wide as
 * their reach, and a hair more, so that rounding loses none. All that are smaller look there, so a
 * ball meets 27 cells at most, and few spheres that are too far away. */
static sd_status find(search *q)
{
  int lowest = INT_MAX, highest = INT_MIN;
  for (int i = 0; i < q->n_all; i++)
    if (q->s->a[i] > 0.0) {
      const int size = near_size_of(q, i);
      lowest = size < lowest ? size : lowest;
      highest = size > highest ? size : highest;
    }
  sd_status status = create(q);
  for (int size = lowest; size <= highest && status == SD_OK; size++) {
    double largest = 0.0;
    for (int i = 0; i < q->n_all; i++)
      if (q->s->a[i] > largest && near_size_of(q, i) == size) largest = q->s->a[i];
    if (largest == 0.0) continue;
    sd_cells_clear(&q->hash, (double[3]){0.0, 0.0, 0.0}, (1.0 + 1e-6) * q->reach * largest);
    sort_into_cells(q, size);
    for (int c = 0; c < q->cells && status == SD_OK; c++) status = near_look_around(q, c);
    for (int i = 0; i < q->n_all && status == SD_OK && lowest < size; i++)
      if (near_size_of(q, i) < size) status = look_from(q, i, largest);
  }
  return status;
}

/* Rows by counting, each pair in that of its lower sphere. Pairs of row r are first counted in
 * first[r + 2]; summed up, first[r + 1] is where row r begins, and moves on with every pair that is
 * put there until it is where row r + 1 begins. */
static sd_status sort_rows(sd_neighbors *list, const search *q)
{
  const sd_status status = sd_neighbors_reserve(list, q->n + 1, q->count);
  if (status != SD_OK) return status;
  long *first = list->first;
  memset(first, 0, sizeof(long) * ((size_t) q->n + 2));
  for (int put = 0; put < 2; put++) {
    for (long k = 0; k < q->count; k++) {
      const int i = q->pair[k][0], j = q->pair[k][1], row = i < j ? i : j;
      if (put)
        list->neighbor[first[row + 1]++] = i < j ? j : i;
      else
        first[row + 2]++;
    }
    for (int i = 2; !put && i <= q->n + 1; i++) first[i] += first[i - 1];
  }
  list->pairs.n = q->n;
  return SD_OK;
}

sd_status sd_near_once(sd_neighbors *list, const sd_spheres *s, int n, int n_all, double reach)
{
  search q = {.s = s, .n = n, .n_all = n_all, .reach = reach};
  sd_status status = find(&q);
  if (status == SD_OK) status = sort_rows(list, &q);
  near_release(&q);
  return status;
}

/* --- kept --- */

/* A pair within reach now was within reach and a skin then, as each of the two has moved by its part of the skin of
 * this pair at most. Of places that are no numbers it is not known. */
static int near_holds(const sd_near *near, const sd_spheres *s, int n, int n_all, double reach)
{
  const double part = 0.5 * (near->reach - reach);
  int all = near->n == n && near->n_all == n_all && part >= 0.0;
  for (long i = 0; i < n_all && all; i++) {
    const double *then = near->stood + 4 * i, spare = part * s->a[i];
    const int stays = s->a[i] == 0.0 || sd_distance_squared(then, s->x + 3 * i) <= spare * spare;
    all = then[3] == s->a[i] && stays;
  }
  return all;
}

sd_status sd_near_keep(sd_near *near, const sd_spheres *s, int n, int n_all, double reach)
{
  if (near_holds(near, s, n, n_all, reach)) return SD_OK;
  near->reach = 0.0;
  if (!sd_reserve(&near->stood, sizeof(double), 4 * (size_t) n_all, &near->stood_room)) return SD_ENOMEMORY;
  const double wide = sd_with_skin(reach);
  const sd_status status = sd_near_once(&near->list, s, n, n_all, wide);
  if (status != SD_OK) return status;
  near->n = n;
  near->n_all = n_all;
  near->reach = wide;
  for (long i = 0; i < n_all; i++) {
    memcpy(near->stood + 4 * i, s->x + 3 * i, 3 * sizeof(double));
    near->stood[4 * i + 3] = s->a[i];
  }
  return SD_OK;
}

void sd_near_free(sd_near *near)
{
  sd_neighbors_free(&near->list);
  free(near->stood);
  memset(near, 0, sizeof(*near));
}
