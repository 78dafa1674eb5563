#include "sd_block_cholesky.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The graph of what is not yet eliminated. An edge has two ends, one in the list of each node; both
 * name the one block, whose rows are those of node `rows`. */
typedef struct {
  int node, block, next;
} end_of_edge;

struct sd_elimination {
  int nodes, ends, most_ends, blocks, most_blocks, entries, most_entries;
  end_of_edge *end;
  /* by block: the node of its rows */
  int *rows;
  /* by node: its list (-1: none), its degree; neighbours in the queue of its degree (-1: none) */
  int *list, *degree, *before, *after;
  /* by degree: the first node of the queue */
  int *queue;
  /* by node: the block between it and the node that is looked at, if stamp says so */
  int *seen, *stamp;
  char *gone;
  /* room in what is applied */
  int packed_nodes, packed_entries;
};

/* The array with room for as many; NULL: no memory, and it is as it was */
static void *grow(void *array, size_t size, int *most, int wanted)
{
  if (wanted <= *most) return array;
  const int room = wanted + wanted / 2 + 64;
  void *larger = realloc(array, size * (size_t) room);
  if (larger) *most = room;
  return larger;
}

static int reserve_nodes(sd_block_cholesky *f, int n)
{
  struct sd_elimination *w = f->work;
  if (n <= w->nodes && w->list) return 1;
  const size_t room = (size_t) n + 1;
  int **const arrays[] = {&w->list,  &w->degree, &w->before, &w->after,
                          &w->queue, &w->seen,   &w->stamp,  &f->order};
  for (size_t k = 0; k < sizeof(arrays) / sizeof(arrays[0]); k++) {
    int *larger = realloc(*arrays[k], sizeof(int) * room);
    if (!larger) return 0;
    *arrays[k] = larger;
  }
  char *gone = realloc(w->gone, room);
  if (gone) w->gone = gone;
  long *first = realloc(f->first, sizeof(long) * room);
  if (first) f->first = first;
  double *pivot = realloc(f->pivot, sizeof(double) * 36 * room);
  if (pivot) f->pivot = pivot;
  if (!gone || !first || !pivot) return 0;
  w->nodes = n;
  return 1;
}

/* --- queues of nodes by degree --- */

static void leave_queue(struct sd_elimination *w, int p)
{
  if (w->before[p] >= 0)
    w->after[w->before[p]] = w->after[p];
  else
    w->queue[w->degree[p]] = w->after[p];
  if (w->after[p] >= 0) w->before[w->after[p]] = w->before[p];
}

static void join_queue(struct sd_elimination *w, int p)
{
  const int first = w->queue[w->degree[p]];
  w->before[p] = -1;
  w->after[p] = first;
  if (first >= 0) w->before[first] = p;
  w->queue[w->degree[p]] = p;
}

/* --- blocks, row-major --- */

/* Lower factor of the lower triangle of A */
static sd_status factor6(double A[36])
{
  for (int p = 0; p < 6; p++)
    for (int q = 0; q <= p; q++) {
      double sum = A[6 * p + q];
      for (int k = 0; k < q; k++) sum -= A[6 * p + k] * A[6 * q + k];
      if (p == q && !(sum > 0.0)) return isfinite(sum) ? SD_ESINGULAR : SD_ENOTFINITE;
      A[6 * p + q] = p == q ? sqrt(sum) : sum / A[6 * q + q];
    }
  return SD_OK;
}

/* B := G^-1 B, G lower, row by row */
static void divide(const double *restrict G, double *restrict B)
{
  for (int p = 0; p < 6; p++) {
    for (int k = 0; k < p; k++)
      for (int c = 0; c < 6; c++) B[6 * p + c] -= G[6 * p + k] * B[6 * k + c];
    const double part = 1.0 / G[7 * p];
    for (int c = 0; c < 6; c++) B[6 * p + c] *= part;
  }
}

static void transpose6(double B[36])
{
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < p; q++) {
      const double b = B[6 * p + q];
      B[6 * p + q] = B[6 * q + p];
      B[6 * q + p] = b;
    }
}

/* out -= A^T B */
static void subtract_product(const double *restrict A, const double *restrict B,
                             double *restrict out)
{
  for (int p = 0; p < 6; p++)
    for (int k = 0; k < 6; k++)
      for (int q = 0; q < 6; q++) out[6 * p + q] -= A[6 * k + p] * B[6 * k + q];
}

static double norm6(const double B[36])
{
  double sum = 0.0;
  for (int k = 0; k < 36; k++) sum += B[k] * B[k];
  return sqrt(sum);
}

/* --- the graph --- */

static void put_end(struct sd_elimination *w, int at, int node, int block)
{
  w->end[w->ends] = (end_of_edge){node, block, w->list[at]};
  w->list[at] = w->ends++;
}

/* A new edge, whose block has rows of p; 0: no memory */
static int connect(sd_block_cholesky *f, int p, int q, const double *value)
{
  struct sd_elimination *w = f->work;
  int room = w->most_blocks;
  double *blocks = grow(f->block, 36 * sizeof(double), &room, w->blocks + 1);
  if (blocks) f->block = blocks;
  int *rows = grow(w->rows, sizeof(int), &w->most_blocks, w->blocks + 1);
  if (rows) w->rows = rows;
  end_of_edge *ends = grow(w->end, sizeof(end_of_edge), &w->most_ends, w->ends + 2);
  if (ends) w->end = ends;
  if (!blocks || !rows || !ends) return 0;
  const int b = w->blocks++;
  memcpy(f->block + 36 * (long) b, value, 36 * sizeof(double));
  w->rows[b] = p;
  put_end(w, p, q, b);
  put_end(w, q, p, b);
  w->degree[p]++;
  w->degree[q]++;
  return 1;
}

/* Marks who is next to p, and takes out of its list those that are gone. */
static void look_around(struct sd_elimination *w, int p)
{
  for (int *at = &w->list[p]; *at >= 0;) {
    const end_of_edge *e = &w->end[*at];
    if (w->gone[e->node]) {
      *at = e->next;
      continue;
    }
    w->seen[e->node] = e->block;
    w->stamp[e->node] = p;
    at = &w->end[*at].next;
  }
}

static sd_status build(sd_block_cholesky *f, int n, long count, const int (*pair)[2],
                       const double *block)
{
  struct sd_elimination *w = f->work;
  w->ends = w->blocks = w->entries = 0;
  for (int p = 0; p < n; p++) {
    w->list[p] = w->queue[p] = w->stamp[p] = -1;
    w->degree[p] = 0;
    w->gone[p] = 0;
  }
  for (long k = 0; k < count; k++) {
    const int p = pair[k][0], q = pair[k][1];
    int e = w->list[p];
    while (e >= 0 && w->end[e].node != q) e = w->end[e].next;
    if (e < 0) {
      if (!connect(f, p, q, block + 36 * k)) return SD_ENOMEMORY;
      continue;
    }
    double *sum = f->block + 36 * (long) w->end[e].block;
    const int turned = w->rows[w->end[e].block] != p;
    for (int r = 0; r < 6; r++)
      for (int c = 0; c < 6; c++) sum[turned ? 6 * c + r : 6 * r + c] += block[36 * k + 6 * r + c];
  }
  for (int p = n - 1; p >= 0; p--) join_queue(w, p);
  return SD_OK;
}

/* Column of p: its neighbours and C_qp^T = G^-1 A_pq. Returns their number, -1 without memory. */
static int make_column(sd_block_cholesky *f, int p)
{
  struct sd_elimination *w = f->work;
  const int begin = w->entries;
  look_around(w, p);
  for (int e = w->list[p]; e >= 0; e = w->end[e].next) {
    const int q = w->end[e].node, b = w->end[e].block;
    double *Ct = f->block + 36 * (long) b;
    int(*entry)[2] = grow(f->entry, sizeof(*entry), &w->most_entries, w->entries + 1);
    if (!entry) return -1;
    f->entry = entry;
    f->entry[w->entries][0] = q;
    f->entry[w->entries++][1] = b;
    if (w->rows[b] == q) transpose6(Ct);
    divide(f->pivot + 36 * (long) p, Ct);
  }
  return w->entries - begin;
}

/* What the elimination of p leaves between q and r, its neighbours: C_q C_r^T less, where there is
 * a block or where this is large. */
static sd_status couple(sd_block_cholesky *f, const int q[2], const int r[2], double drop)
{
  struct sd_elimination *w = f->work;
  double fill[36] = {0.0};
  /* transposed */
  const double *Cq = f->block + 36 * (long) q[1], *Cr = f->block + 36 * (long) r[1];
  if (w->stamp[r[0]] == q[0]) {
    const int b = w->seen[r[0]], as_rows = w->rows[b] == q[0];
    subtract_product(as_rows ? Cq : Cr, as_rows ? Cr : Cq, f->block + 36 * (long) b);
    return SD_OK;
  }
  subtract_product(Cq, Cr, fill);
  const double norm = norm6(fill);
  if (norm >= drop) return connect(f, q[0], r[0], fill) ? SD_OK : SD_ENOMEMORY;
  for (int d = 0; d < 6; d++) {
    f->pivot[36 * (long) q[0] + 7 * d] += norm;
    f->pivot[36 * (long) r[0] + 7 * d] += norm;
  }
  return SD_OK;
}

static sd_status eliminate(sd_block_cholesky *f, int p, double drop)
{
  struct sd_elimination *w = f->work;
  sd_status status = factor6(f->pivot + 36 * (long) p);
  if (status != SD_OK) return status;
  const int begin = w->entries, m = make_column(f, p);
  if (m < 0) return SD_ENOMEMORY;
  w->gone[p] = 1;
  for (int s = begin; s < begin + m; s++) {
    leave_queue(w, f->entry[s][0]);
    w->degree[f->entry[s][0]]--;
  }
  for (int s = begin; s < begin + m && status == SD_OK; s++) {
    const int q = f->entry[s][0];
    const double *Ct = f->block + 36 * (long) f->entry[s][1];
    subtract_product(Ct, Ct, f->pivot + 36 * (long) q);
    look_around(w, q);
    for (int t = s + 1; t < begin + m && status == SD_OK; t++)
      status = couple(f, f->entry[s], f->entry[t], drop);
  }
  for (int s = begin; s < begin + m; s++) join_queue(w, f->entry[s][0]);
  return status;
}

/* --- to apply it --- */

enum { LANES = SD_BLOCK_LANES, PADDED = 6 * LANES };

/* out: the rows of A, zeros behind each */
static void pack(const double A[36], float *out)
{
  for (int c = 0; c < 6; c++)
    for (int r = 0; r < LANES; r++) out[LANES * c + r] = r < 6 ? (float) A[6 * c + r] : 0.0f;
}

static sd_status pack_all(sd_block_cholesky *f, int n)
{
  struct sd_elimination *w = f->work;
  if (n > w->packed_nodes || w->entries > w->packed_entries) {
    free(f->inverse);
    free(f->column);
    free(f->vector);
    w->packed_nodes = n + n / 4;
    w->packed_entries = w->entries + w->entries / 4;
    f->inverse = malloc(sizeof(float) * PADDED * ((size_t) w->packed_nodes + 1));
    f->column = malloc(sizeof(float) * PADDED * ((size_t) w->packed_entries + 1));
    f->vector = malloc(sizeof(float) * LANES * ((size_t) w->packed_nodes + 1));
    if (!f->inverse || !f->column || !f->vector) {
      w->packed_nodes = w->packed_entries = -1;
      return SD_ENOMEMORY;
    }
  }
  for (long k = 0; k < n; k++) {
    double inverse[36] = {0.0};
    for (int d = 0; d < 6; d++) inverse[7 * d] = 1.0;
    divide(f->pivot + 36 * (long) f->order[k], inverse);
    transpose6(inverse);
    pack(inverse, f->inverse + PADDED * k);
    for (long e = f->first[k]; e < f->first[k + 1]; e++)
      pack(f->block + 36 * (long) f->entry[e][1], f->column + PADDED * e);
  }
  return SD_OK;
}

sd_status sd_block_cholesky_make(sd_block_cholesky *f, int n, const double *diagonal, long count,
                                 const int (*pair)[2], const double *block, double drop)
{
  if (!f->work) f->work = calloc(1, sizeof(*f->work));
  if (!f->work || !reserve_nodes(f, n)) return SD_ENOMEMORY;
  f->n = 0;
  memcpy(f->pivot, diagonal, sizeof(double) * 36 * (size_t) n);
  sd_status status = build(f, n, count, pair, block);
  struct sd_elimination *w = f->work;
  f->first[0] = 0;
  for (int k = 0, degree = 0; k < n && status == SD_OK; k++) {
    while (w->queue[degree] < 0) degree++;
    const int p = w->queue[degree];
    leave_queue(w, p);
    status = eliminate(f, p, drop);
    f->order[k] = p;
    f->first[k + 1] = w->entries;
    if (degree > 0) degree--; /* no neighbour lost more than one */
  }
  if (status == SD_OK) status = pack_all(f, n);
  if (status == SD_OK) f->n = n;
  return status;
}

/* out += s A v, v [6], of which columns are packed */
static inline void add_product(const float *restrict A, float s, const float *restrict v,
                               float *restrict out)
{
  for (int c = 0; c < 6; c++)
    for (int r = 0; r < LANES; r++) out[r] += A[LANES * c + r] * (s * v[c]);
}

/* lanes of A^T v, to be summed up: sums[c] += A_c v, one number after the other */
static inline void add_transposed(const float *restrict A, const float *restrict v,
                                  float *restrict sums)
{
  for (int c = 0; c < 6; c++)
    for (int r = 0; r < LANES; r++) sums[LANES * c + r] += A[LANES * c + r] * v[r];
}

static inline float total(const float lanes[LANES])
{
  float sum = 0.0f;
  for (int r = 0; r < LANES; r++) sum += lanes[r];
  return sum;
}

void sd_block_cholesky_apply(const sd_block_cholesky *f, double *x)
{
  float *v = f->vector;
  for (long p = 0; p < f->n; p++)
    for (int r = 0; r < LANES; r++) v[LANES * p + r] = r < 6 ? (float) x[6 * p + r] : 0.0f;
  for (long k = 0; k < f->n; k++) {
    float *at = v + LANES * (long) f->order[k], y[LANES] = {0.0f};
    add_product(f->inverse + PADDED * k, 1.0f, at, y);
    memcpy(at, y, sizeof(y));
    for (long e = f->first[k]; e < f->first[k + 1]; e++)
      add_product(f->column + PADDED * e, -1.0f, y, v + LANES * (long) f->entry[e][0]);
  }
  for (long k = f->n - 1; k >= 0; k--) {
    float *at = v + LANES * (long) f->order[k], sums[PADDED] = {0.0f}, y[LANES];
    memcpy(y, at, sizeof(y));
    for (long e = f->first[k]; e < f->first[k + 1]; e++)
      add_transposed(f->column + PADDED * e, v + LANES * (long) f->entry[e][0], sums);
    for (int c = 0; c < 6; c++) y[c] -= total(sums + LANES * c);
    memset(sums, 0, sizeof(sums));
    add_transposed(f->inverse + PADDED * k, y, sums);
    for (int c = 0; c < 6; c++) at[c] = total(sums + LANES * c);
  }
  for (long p = 0; p < f->n; p++)
    for (int r = 0; r < 6; r++) x[6 * p + r] = v[LANES * p + r];
}

void sd_block_cholesky_free(sd_block_cholesky *f)
{
  struct sd_elimination *w = f->work;
  if (w) {
    free(w->end);
    free(w->rows);
    int *const arrays[] = {w->list, w->degree, w->before, w->after, w->queue, w->seen, w->stamp};
    for (size_t k = 0; k < sizeof(arrays) / sizeof(arrays[0]); k++) free(arrays[k]);
    free(w->gone);
    free(w);
  }
  free(f->order);
  free(f->first);
  free(f->entry);
  free(f->pivot);
  free(f->block);
  free(f->inverse);
  free(f->column);
  free(f->vector);
  memset(f, 0, sizeof(*f));
}
