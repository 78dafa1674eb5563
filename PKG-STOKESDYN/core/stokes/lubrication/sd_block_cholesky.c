#include "sd_block_cholesky.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_block_internal.h"
#include "sd_room.h"

/* The graph of what is not yet eliminated. An edge has two ends, one in the list of each node; both
 * name the one block, whose rows are those of the one: it is turned as the other sees it. */
typedef struct {
  int node, block, turned;
} end_of_edge;

typedef struct {
  /* where its list of ends is, how long it is and may become */
  int list, degree, room;
  /* neighbours in the queue of its degree; -1: none */
  int before, after;
  /* where it is in the list of the node that is looked at, if stamp says so */
  int seen, stamp;
  /* is it put off, and in no queue? Then it may be left out. */
  enum { EARLY, LATE, OUT } when;
  /* the norms of the fill that it has lost */
  float lost;
} node;

struct sd_elimination {
  const struct sd_block_kernels *kernels;
  /* lists of ends, with room behind each */
  int ends;
  end_of_edge *end;
  /* blocks between nodes: those in use are below `blocks`, less those that are free again */
  int blocks, free_blocks;
  float *block;
  int *free_block;
  size_t end_room, block_room, free_room;
  /* by node, and its block; by degree: the first node of the queue */
  int nodes;
  node *node;
  float *pivot;
  int *queue;
  /* entries of columns, and room for them; of one column: the entries, where products go, and which block
   * that is */
  long entries;
  size_t row_room, column_room, most_columns, most_targets, most_target_blocks;
  float *column;
  sd_block_target *target;
  int *target_block;
};

/* --- memory --- */

/* What was there is lost. */
static int reserve_nodes(sd_block_cholesky *f, int n)
{
  struct sd_elimination *w = f->work;
  if (n < w->nodes) return 1;
  const size_t room = (size_t) n + (size_t) n / 8 + 1;
  if (!sd_grow(&w->node, sizeof(node), room) || !sd_grow(&w->queue, sizeof(int), room) ||
      !sd_grow(&w->pivot, sizeof(float) * SD_BLOCK, room) ||
      !sd_grow(&f->first, sizeof(long), room) || !sd_grow(&f->order, sizeof(int), room) ||
      !sd_grow(&f->inverse, sizeof(float) * SD_BLOCK_KEPT, room) ||
      !sd_grow(&f->vector, sizeof(float) * SD_BLOCK_LANES, room))
    return 0;
  w->nodes = (int) room;
  return 1;
}

/* Room for so many more blocks */
static int reserve_blocks(struct sd_elimination *w, int more)
{
  const size_t blocks = (size_t) (w->blocks + more);
  return sd_extend(&w->block, sizeof(float) * SD_BLOCK, blocks, &w->block_room) &&
      sd_extend(&w->free_block, sizeof(int), blocks, &w->free_room);
}

/* Room for so many more entries of columns, all of one */
static int reserve_entries(sd_block_cholesky *f, int more)
{
  struct sd_elimination *w = f->work;
  const size_t entries = (size_t) (w->entries + more) + 1;
  return sd_extend(&f->row, sizeof(int), entries, &w->row_room) &&
      sd_extend(&f->column, sizeof(float) * SD_BLOCK_KEPT, entries, &w->column_room) &&
      sd_reserve(&w->column, sizeof(float) * SD_BLOCK, (size_t) more, &w->most_columns) &&
      sd_reserve(&w->target, sizeof(*w->target), (size_t) more, &w->most_targets) &&
      sd_reserve(&w->target_block, sizeof(int), (size_t) more, &w->most_target_blocks);
}

static float *cholesky_block_of(const struct sd_elimination *w, int b)
{
  return w->block + SD_BLOCK * (long) b;
}

static float *pivot_of(const struct sd_elimination *w, int p)
{
  return w->pivot + SD_BLOCK * (long) p;
}

/* There is room. */
static int cholesky_take_block(struct sd_elimination *w)
{
  return w->free_blocks > 0 ? w->free_block[--w->free_blocks] : w->blocks++;
}

static void cholesky_give_back(struct sd_elimination *w, int b)
{
  w->free_block[w->free_blocks++] = b;
}

/* --- queues of nodes by degree --- */

static void leave_queue(struct sd_elimination *w, int p)
{
  const node *this = w->node + p;
  if (this->when != EARLY) return;
  if (this->before >= 0)
    w->node[this->before].after = this->after;
  else
    w->queue[this->degree] = this->after;
  if (this->after >= 0) w->node[this->after].before = this->before;
}

static void join_queue(struct sd_elimination *w, int p)
{
  if (w->node[p].when != EARLY) return;
  int *first = w->queue + w->node[p].degree;
  w->node[p].before = -1;
  w->node[p].after = *first;
  if (*first >= 0) w->node[*first].before = p;
  *first = p;
}

/* --- the graph --- */

/* 0: no memory */
static int put_end(struct sd_elimination *w, int at, end_of_edge e)
{
  node *this = w->node + at;
  if (this->degree == this->room) { /* to the end of all lists, with twice the room */
    const int room = 2 * this->room + 4;
    if (!sd_extend(&w->end, sizeof(e), (size_t) (w->ends + room), &w->end_room)) return 0;
    memcpy(w->end + w->ends, w->end + this->list, sizeof(e) * (size_t) this->degree);
    this->list = w->ends;
    this->room = room;
    w->ends += room;
  }
  w->end[this->list + this->degree++] = e;
  return 1;
}

/* A new edge, whose block has rows of p; 0: no memory */
static int connect(struct sd_elimination *w, int p, int q, int block)
{
  return put_end(w, p, (end_of_edge){q, block, 0}) && put_end(w, q, (end_of_edge){p, block, 1});
}

/* Marks who is next to p, and takes `gone` out of its list. */
static void cholesky_look_around(struct sd_elimination *w, int p, int gone)
{
  end_of_edge *list = w->end + w->node[p].list;
  for (int k = 0; k < w->node[p].degree; k++) {
    if (list[k].node == gone) list[k] = list[--w->node[p].degree];
    w->node[list[k].node].seen = k;
    w->node[list[k].node].stamp = p;
  }
}

/* --- the matrix --- */

sd_status sd_block_cholesky_begin(sd_block_cholesky *f, int n)
{
  if (!f->work) f->work = calloc(1, sizeof(*f->work));
  struct sd_elimination *w = f->work;
  f->n = 0;
  if (!w || !reserve_nodes(f, n) ||
      !sd_extend(&w->end, sizeof(end_of_edge), 4 * (size_t) n, &w->end_room))
    return SD_ENOMEMORY;
  f->n = n;
  w->kernels = SD_KERNELS_OF(sd_block, plain, sd_isa_of(SD_ISA_BEST));
  w->ends = w->blocks = w->free_blocks = 0;
  w->entries = 0;
  for (int p = 0; p < n; p++) {
    w->node[p] = (node){.stamp = -1};
    w->queue[p] = -1;
  }
  memset(w->pivot, 0, sizeof(float) * SD_BLOCK * (size_t) n);
  return SD_OK;
}

/* out += A or its transpose */
static void cholesky_add(const double A[36], int turned, float *out)
{
  for (int r = 0; r < 6; r++)
    for (int c = 0; c < 6; c++)
      out[SD_BLOCK_LANES * r + c] += (float) A[turned ? 6 * c + r : 6 * r + c];
}

sd_status sd_block_cholesky_add(sd_block_cholesky *f, int p, int q, const double A[36])
{
  struct sd_elimination *w = f->work;
  if (p == q) {
    cholesky_add(A, 0, pivot_of(w, p));
    return SD_OK;
  }
  const end_of_edge *list = w->end + w->node[p].list;
  for (int e = 0; e < w->node[p].degree; e++)
    if (list[e].node == q) {
      cholesky_add(A, list[e].turned, cholesky_block_of(w, list[e].block));
      return SD_OK;
    }
  if (!reserve_blocks(w, 1)) return SD_ENOMEMORY;
  const int b = cholesky_take_block(w);
  memset(cholesky_block_of(w, b), 0, sizeof(float) * SD_BLOCK);
  cholesky_add(A, 0, cholesky_block_of(w, b));
  return connect(w, p, q, b) ? SD_OK : SD_ENOMEMORY;
}

void sd_block_cholesky_put_off(sd_block_cholesky *f, int p)
{
  f->work->node[p].when = LATE;
}

/* --- elimination --- */

static void transpose(const float *A, float *out)
{
  for (int r = 0; r < 6; r++)
    for (int c = 0; c < SD_BLOCK_LANES; c++)
      out[SD_BLOCK_LANES * r + c] = c < 6 ? A[SD_BLOCK_LANES * c + r] : 0.0f;
}

/* A node stands anywhere in memory, its block and its list elsewhere: they are fetched before it is its turn. */
static void fetch_node(const struct sd_elimination *w, int q)
{
  enum { LINE = 16 };
  sd_fetch(w->end + w->node[q].list);
  for (int k = 0; k < SD_BLOCK; k += LINE) sd_fetch(pivot_of(w, q) + k);
}

/* Column of p: its neighbours q, which leave their queues, and A_pq. Returns their number, -1
 * without memory. */
static int take_column(sd_block_cholesky *f, int p)
{
  struct sd_elimination *w = f->work;
  const int m = w->node[p].degree;
  if (!reserve_entries(f, m)) return -1;
  const end_of_edge *list = w->end + w->node[p].list;
  for (int k = 0; k < m; k++) {
    const end_of_edge e = list[k];
    float *A = w->column + SD_BLOCK * (long) k;
    if (e.turned)
      transpose(cholesky_block_of(w, e.block), A);
    else
      memcpy(A, cholesky_block_of(w, e.block), sizeof(float) * SD_BLOCK);
    cholesky_give_back(w, e.block);
    f->row[w->entries + k] = e.node;
    leave_queue(w, e.node);
    fetch_node(w, e.node);
  }
  return m;
}

/* New blocks between q and r [count] stay if they are large; less is added to diagonals. */
static sd_status keep_or_drop(struct sd_elimination *w, int q, int count, const int *r, float drop)
{
  for (int t = 0; t < count; t++) {
    if (w->target[t].way != SD_BLOCK_NEW) continue;
    const float norm = sqrtf(w->target[t].square);
    if (norm >= drop) {
      if (!connect(w, q, r[t], w->target_block[t])) return SD_ENOMEMORY;
      continue;
    }
    cholesky_give_back(w, w->target_block[t]);
    w->node[q].lost += norm;
    w->node[r[t]].lost += norm;
  }
  return SD_OK;
}

/* What the elimination of p leaves of q, its neighbour, and between q and r [count], those behind
 * it in the column C */
static sd_status couple(struct sd_elimination *w, int p, int q, int count, const int *r,
                        const float *C, float drop)
{
  if (!reserve_blocks(w, count)) return SD_ENOMEMORY;
  cholesky_look_around(w, q, p);
  const end_of_edge *list = w->end + w->node[q].list;
  for (int t = 0; t < count; t++) {
    const node *other = w->node + r[t];
    const end_of_edge *e = other->stamp == q ? list + other->seen : NULL;
    const int b = e ? e->block : cholesky_take_block(w);
    w->target_block[t] = b;
    w->target[t].to = cholesky_block_of(w, b);
    w->target[t].way = !e ? SD_BLOCK_NEW : e->turned ? SD_BLOCK_TURNED : SD_BLOCK_AS_IT_IS;
  }
  w->kernels->subtract(C, pivot_of(w, q), count, w->target);
  return keep_or_drop(w, q, count, r, drop);
}

static sd_status eliminate(sd_block_cholesky *f, int k, int p, float drop)
{
  struct sd_elimination *w = f->work;
  leave_queue(w, p);
  if (w->node[p].after >= 0) fetch_node(w, w->node[p].after); /* most often the next */
  const long begin = w->entries;
  const int m = take_column(f, p);
  if (m < 0) return SD_ENOMEMORY;
  w->entries += m;
  f->order[k] = p;
  f->first[k + 1] = w->entries;
  float *pivot = pivot_of(w, p), inverse[SD_BLOCK];
  for (int d = 0; d < 6; d++) pivot[(SD_BLOCK_LANES + 1) * d] += w->node[p].lost;
  if (!w->kernels->divide(pivot, inverse, m, w->column)) {
    float sum = 0.0f;
    for (int e = 0; e < SD_BLOCK; e++) sum += pivot[e];
    return isfinite(sum) ? SD_ESINGULAR : SD_ENOTFINITE;
  }
  sd_block_keep(inverse, f->inverse + SD_BLOCK_KEPT * (long) k);
  for (int s = 0; s < m; s++) sd_block_keep(w->column + SD_BLOCK * (long) s, f->column + SD_BLOCK_KEPT * (begin + s));
  sd_status status = SD_OK;
  const int *row = f->row + begin;
  for (int s = 0; s < m && status == SD_OK; s++)
    status = couple(w, p, row[s], m - 1 - s, row + s + 1, w->column + SD_BLOCK * (long) s, drop);
  for (int s = 0; s < m; s++) join_queue(w, row[s]);
  return status;
}

/* Of its first value, added to a diagonal. With 1.2e-7 tangles of stiffness 3e7 failed. */
static const float safety = 3e-7f;

/* All in the queues, as columns begin ... end - 1 */
static sd_status eliminate_all(sd_block_cholesky *f, int begin, int end, double drop)
{
  struct sd_elimination *w = f->work;
  sd_status status = SD_OK;
  for (int k = begin, degree = 0; k < end && status == SD_OK; k++) {
    while (w->queue[degree] < 0) degree++;
    status = eliminate(f, k, w->queue[degree], (float) drop);
    if (degree > 0) degree--; /* no neighbour lost more than one */
  }
  if (status != SD_OK) f->n = 0;
  return status;
}

sd_status sd_block_cholesky_factor(sd_block_cholesky *f, double drop)
{
  struct sd_elimination *w = f->work;
  f->first[0] = 0;
  f->early = 0;
  for (int p = f->n - 1; p >= 0; p--) {
    for (int d = 0; d < 6; d++) pivot_of(w, p)[(SD_BLOCK_LANES + 1) * d] *= 1.0f + safety;
    join_queue(w, p);
    f->early += w->node[p].when == EARLY;
  }
  return eliminate_all(f, 0, f->early, drop);
}

void sd_block_cholesky_leave_out(sd_block_cholesky *f, int p)
{
  struct sd_elimination *w = f->work;
  const end_of_edge *list = w->end + w->node[p].list;
  for (int e = 0; e < w->node[p].degree; e++) {
    node *other = w->node + list[e].node;
    end_of_edge *back = w->end + other->list;
    while (back->node != p) back++;
    *back = w->end[other->list + --other->degree];
    cholesky_give_back(w, list[e].block);
  }
  w->node[p].degree = 0;
  w->node[p].when = OUT;
}

sd_status sd_block_cholesky_finish(sd_block_cholesky *f, double drop)
{
  struct sd_elimination *w = f->work;
  int out = f->n;
  for (int p = f->n - 1; p >= 0; p--) {
    if (w->node[p].when == OUT) f->order[--out] = p;
    if (w->node[p].when != LATE) continue;
    w->node[p].when = EARLY;
    join_queue(w, p);
  }
  f->factored = out;
  return eliminate_all(f, f->early, f->factored, drop);
}

static void read_block(const float *A, int turned, double B[36])
{
  for (int r = 0; r < 6; r++)
    for (int c = 0; c < 6; c++) B[turned ? 6 * c + r : 6 * r + c] = A[SD_BLOCK_LANES * r + c];
}

int sd_block_cholesky_degree(const sd_block_cholesky *f, int p)
{
  return f->work->node[p].degree;
}

int sd_block_cholesky_beside(const sd_block_cholesky *f, int p, int k)
{
  return f->work->end[f->work->node[p].list + k].node;
}

void sd_block_cholesky_left(const sd_block_cholesky *f, int p, sd_block_visit *visit, void *ctx)
{
  const struct sd_elimination *w = f->work;
  const node *this = w->node + p;
  double B[36];
  read_block(pivot_of(w, p), 0, B);
  for (int d = 0; d < 6; d++) B[7 * d] += this->lost;
  visit(ctx, p, p, B);
  for (int k = 0; k < this->degree; k++) {
    const end_of_edge *e = w->end + this->list + k;
    read_block(cholesky_block_of(w, e->block), e->turned, B);
    visit(ctx, p, e->node, B);
  }
}

void sd_block_cholesky_free(sd_block_cholesky *f)
{
  struct sd_elimination *w = f->work;
  if (w) {
    void *const arrays[] = {w->end,   w->block, w->free_block, w->node,
                            w->pivot, w->queue, w->column,     w->target, w->target_block};
    for (size_t k = 0; k < sizeof(arrays) / sizeof(arrays[0]); k++) free(arrays[k]);
    free(w);
  }
  free(f->order);
  free(f->first);
  free(f->row);
  free(f->inverse);
  free(f->column);
  free(f->vector);
  memset(f, 0, sizeof(*f));
}
