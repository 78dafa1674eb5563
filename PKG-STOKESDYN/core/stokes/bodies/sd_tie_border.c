#include "sd_tie_border.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "sd_room.h"

/* A body, and the rank that it goes to or comes from */
typedef struct {
  int rank, body;
} at_border;

/* Blocks as they travel: numbers of two bodies of the sender, and 36 floats */
enum { FLOATS = 36 * sizeof(float) / sizeof(double), TRAVELLER = 2 + FLOATS };

typedef struct {
  const sd_bodies *A;
  /* [ours] of this rank, by the ranks that they go to; [others] of the others, both in ascending order */
  at_border *own, *other;
  int ours;
  /* [bodies] the rank that they are being told to, -1 at first; [others] is it known what is left? */
  int *told;
  char *known;
  /* what goes and what comes [TRAVELLER], how many numbers to and from each rank [ranks] */
  double *out, *in;
  size_t rows, room;
  int *to, *from;
} border;

void sd_tie_border_put_off(const sd_bodies *A)
{
  sd_tie *t = A->tie;
  const sd_lubrication *L = t->L;
  for (long k = 0; k < L->count; k++)
    if (L->pair[k][1] >= L->n) sd_block_cholesky_put_off(&t->factor, sd_rigid_whole(&A->spheres, L->pair[k][0]));
  for (int o = 0; o < t->others; o++) sd_block_cholesky_put_off(&t->factor, sd_bodies_count(A) + o);
}

/* --- who they are --- */

static int by_rank(const void *one, const void *other)
{
  const at_border *p = one, *q = other;
  if (p->rank != q->rank) return p->rank < q->rank ? -1 : 1;
  return (p->body > q->body) - (p->body < q->body);
}

static int border_reserve(border *b)
{
  const sd_tie *t = b->A->tie;
  const size_t ranks = (size_t) t->L->world.ranks, bodies = (size_t) sd_bodies_count(b->A);
  size_t across = 1;
  for (long k = 0; k < t->L->count; k++) across += t->L->pair[k][1] >= t->L->n;
  b->own = malloc(sizeof(at_border) * across);
  b->other = malloc(sizeof(at_border) * ((size_t) t->others + 1));
  b->told = malloc(sizeof(int) * (bodies + 1));
  b->known = calloc((size_t) t->others + 1, 1);
  b->to = calloc(ranks, sizeof(int));
  b->from = calloc(ranks, sizeof(int));
  return b->own && b->other && b->told && b->known && b->to && b->from;
}

static void border_free(border *b)
{
  void *const arrays[] = {b->own, b->other, b->told, b->known, b->to, b->from, b->out, b->in};
  for (size_t k = 0; k < sizeof(arrays) / sizeof(arrays[0]); k++) free(arrays[k]);
}

/* Those of ours that other ranks have in their factors, and the others in ours */
static void know_border(border *b, const double *place, double *ranks)
{
  const sd_tie *t = b->A->tie;
  const sd_lubrication *L = t->L;
  int many = 0;
  for (long k = 0; k < L->count; k++) {
    const int body = sd_rigid_whole(&b->A->spheres, L->pair[k][0]), copy = L->pair[k][1] - L->n;
    if (copy < 0 || t->scale[6 * (long) body] == 0.0) continue;
    b->own[many++] = (at_border){(int) place[SD_PLACE * (long) copy + SD_PLACE_RANK], body};
  }
  qsort(b->own, (size_t) many, sizeof(at_border), by_rank);
  for (int body = 0; body < sd_bodies_count(b->A); body++) ranks[body] = 1.0;
  for (int k = 0; k < many; k++) {
    if (b->ours > 0 && by_rank(b->own + b->ours - 1, b->own + k) == 0) continue;
    ranks[b->own[k].body] += 1.0;
    b->own[b->ours++] = b->own[k];
  }
  for (int o = 0; o < t->others; o++) {
    const double *row = place + SD_PLACE * (long) t->copy[o];
    b->other[o] = (at_border){(int) row[SD_PLACE_RANK], (int) row[SD_PLACE_BODY]};
  }
}

/* --- what goes --- */

/* The block of two bodies that go to one rank, once */
static void tell_block(void *ctx, int p, int q, const double B[36])
{
  border *b = ctx;
  if (q < p || q >= sd_bodies_count(b->A) || b->told[q] != b->told[p]) return;
  double *row = b->out + TRAVELLER * b->rows++;
  float numbers[36];
  for (int e = 0; e < 36; e++) numbers[e] = (float) B[e];
  row[0] = p;
  row[1] = q;
  memcpy(row + 2, numbers, sizeof(numbers));
}

/* All of ours to one rank after the other; 0: no memory, or more than an int counts */
static int pack(border *b)
{
  const sd_tie *t = b->A->tie;
  for (int body = 0; body < sd_bodies_count(b->A); body++) b->told[body] = -1;
  for (int first = 0, end; first < b->ours; first = end) {
    const int rank = b->own[first].rank;
    const size_t before = b->rows;
    for (end = first; end < b->ours && b->own[end].rank == rank; end++) b->told[b->own[end].body] = rank;
    for (int k = first; k < end; k++) {
      const int body = b->own[k].body;
      const size_t most = b->rows + 1 + (size_t) sd_block_cholesky_degree(&t->factor, body);
      if (most > INT_MAX / TRAVELLER || !sd_extend(&b->out, TRAVELLER * sizeof(double), most, &b->room)) return 0;
      sd_block_cholesky_left(&t->factor, body, tell_block, b);
    }
    b->to[rank] = TRAVELLER * (int) (b->rows - before);
  }
  return 1;
}

/* --- what comes --- */

/* Its number in the factor; -1: it is not there */
static int number_there(const border *b, int rank, double body)
{
  const at_border key = {rank, (int) body};
  const at_border *found = bsearch(&key, b->other, (size_t) b->A->tie->others, sizeof(key), by_rank);
  return found ? (int) (found - b->other) : -1;
}

static sd_status take_block(border *b, int rank, const double *row)
{
  sd_block_cholesky *factor = &b->A->tie->factor;
  const int p = number_there(b, rank, row[0]), q = number_there(b, rank, row[1]), bodies = sd_bodies_count(b->A);
  float numbers[36];
  double B[36];
  if (p < 0 || q < 0) return SD_OK;
  memcpy(numbers, row + 2, sizeof(numbers));
  for (int e = 0; e < 36; e++) B[e] = numbers[e];
  if (p == q) b->known[p] = 1;
  return sd_block_cholesky_add(factor, bodies + p, bodies + q, B);
}

/* A body of which nothing came is one whose film ends there: for its rank, by rounding, beyond the range. */
static sd_status unpack(border *b)
{
  sd_tie *t = b->A->tie;
  const double *row = b->in;
  double unit[36] = {0.0};
  sd_status status = SD_OK;
  for (int d = 0; d < 6; d++) unit[7 * d] = 1.0;
  for (int p = 0; p < t->L->world.ranks; p++)
    for (int k = 0; k < b->from[p] && status == SD_OK; k += TRAVELLER, row += TRAVELLER)
      status = take_block(b, p, row);
  for (int o = 0; o < t->others && status == SD_OK; o++) {
    const int node = sd_bodies_count(b->A) + o;
    if (!b->known[o]) status = sd_block_cholesky_add(&t->factor, node, node, unit);
  }
  return status;
}

static int make_room(border *b)
{
  size_t numbers = 1;
  for (int p = 0; p < b->A->tie->L->world.ranks; p++) numbers += (size_t) b->from[p];
  b->in = malloc(sizeof(double) * numbers);
  return b->in != NULL;
}

sd_status sd_tie_border_share(const sd_bodies *A, const double *place, double *ranks, sd_status mine)
{
  const sd_world *world = &A->tie->L->world;
  border b = {.A = A};
  if (mine == SD_OK && !border_reserve(&b)) mine = SD_ENOMEMORY;
  if (mine == SD_OK) {
    know_border(&b, place, ranks);
    if (!pack(&b)) mine = SD_ENOMEMORY;
  }
  sd_status status = sd_world_agree(world, mine);
  if (status == SD_OK) status = world->tell(world->ctx, b.to, b.from);
  if (status == SD_OK) status = sd_world_agree(world, make_room(&b) ? SD_OK : SD_ENOMEMORY);
  if (status == SD_OK) status = world->exchange(world->ctx, b.out, b.to, b.in, b.from);
  if (status == SD_OK) status = unpack(&b);
  border_free(&b);
  return status;
}

/* --- of the factor --- */

static double *row_of_edge(const sd_bodies *A, double *rows, int k)
{
  return rows + 6 * (long) A->tie->edge[k];
}

static double *body_of_edge(const sd_bodies *A, int k)
{
  return A->tie->all + 6 * (long) sd_rigid_whole(&A->spheres, A->tie->edge[k]);
}

/* Of the other ranks' bodies, what the factor is applied to. A body that, by rounding, is near for one of two
 * ranks alone is 0 there, and nothing is taken back. */
static sd_status fetch_others(const sd_bodies *A, double *rows)
{
  const sd_tie *t = A->tie;
  const sd_world *world = &t->L->world;
  const long bodies = sd_bodies_count(A);
  memset(rows, 0, sizeof(double) * 6 * (size_t) t->L->n);
  for (int k = 0; k < t->edges; k++) memcpy(row_of_edge(A, rows, k), body_of_edge(A, k), 6 * sizeof(double));
  const sd_status status = world->refresh(world->ctx, rows, t->copies, 6);
  for (long o = 0; o < t->others; o++)
    memcpy(t->all + 6 * (bodies + o), t->copies + 6 * (long) t->copy[o], 6 * sizeof(double));
  return status;
}

/* And back what it gives them, to be added to theirs */
static sd_status give_back(const sd_bodies *A, double *rows)
{
  const sd_tie *t = A->tie;
  const sd_lubrication *L = t->L;
  const long bodies = sd_bodies_count(A);
  memset(t->copies, 0, sizeof(double) * 6 * (size_t) (L->n_all - L->n));
  for (int k = 0; k < t->edges; k++) memset(row_of_edge(A, rows, k), 0, 6 * sizeof(double));
  for (long o = 0; o < t->others; o++)
    memcpy(t->copies + 6 * (long) t->copy[o], t->all + 6 * (bodies + o), 6 * sizeof(double));
  const sd_status status = L->world.reduce(L->world.ctx, t->copies, rows, 6);
  for (int k = 0; k < t->edges; k++)
    for (int d = 0; d < 6; d++) body_of_edge(A, k)[d] += row_of_edge(A, rows, k)[d];
  return status;
}

static void weigh_shared(const sd_bodies *A)
{
  const sd_tie *t = A->tie;
  for (int k = 0; k < t->shares; k++)
    for (int d = 0; d < 6; d++) t->all[6 * (long) t->shared[k] + d] *= t->weight[t->shared[k]];
}

sd_status sd_tie_border_meet(const sd_bodies *A, double *rows)
{
  weigh_shared(A);
  sd_status status = fetch_others(A, rows);
  if (status != SD_OK) return status;
  sd_block_cholesky_middle(&A->tie->factor, A->tie->all);
  status = give_back(A, rows);
  weigh_shared(A);
  return status;
}
