#include "sd_tie_border.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "sd_room.h"

/* Blocks as they travel: numbers of two bodies of the sender, and 36 floats */
enum { FLOATS = 36 * sizeof(float) / sizeof(double), TRAVELLER = 2 + FLOATS };

typedef struct {
  const sd_bodies *A;
  /* [bodies] the rank that they are being told to, -1 at first; [others] is it known what is left? */
  int *told;
  char *known;
  /* what goes and what comes [TRAVELLER], how many numbers to and from each rank [ranks] */
  double *out, *in;
  size_t rows, room;
  int *to, *from;
} meeting;

/* --- who is in whose factor --- */

static int sum_over_ranks(const sd_world *world, const int *counts)
{
  int sum = 0;
  for (int p = 0; p < world->ranks; p++) sum += counts[p];
  return sum;
}

/* e->borrow: of so many of its bodies each rank has to be told; their numbers [others] */
static int count_others(sd_tie_border *e, size_t ranks, double *numbers)
{
  if (!numbers || !sd_reserve(&e->lend, sizeof(int), ranks, &e->most_lend) ||
      !sd_reserve(&e->borrow, sizeof(int), ranks, &e->most_borrow))
    return 0;
  memset(e->borrow, 0, sizeof(int) * ranks);
  for (int o = 0; o < e->others; o++) {
    e->borrow[e->other[o].rank]++;
    numbers[o] = e->other[o].body;
  }
  return 1;
}

static int reserve_lent(sd_tie_border *e, size_t bodies)
{
  const size_t lents = (size_t) e->lents;
  return sd_reserve(&e->lent, sizeof(int), lents, &e->most_lent) &&
      sd_reserve(&e->away, sizeof(int), bodies, &e->most_away) &&
      sd_reserve(&e->sent, sizeof(double), 6 * lents + 1, &e->most_sent);
}

sd_status sd_tie_border_lend(const sd_bodies *A, sd_status mine)
{
  sd_tie_border *e = &A->tie->border;
  const sd_world *world = &A->tie->L->world;
  double *numbers = malloc(sizeof(double) * ((size_t) e->others + 1));
  if (mine == SD_OK && !count_others(e, (size_t) world->ranks, numbers)) mine = SD_ENOMEMORY;
  sd_status status = sd_world_agree(world, mine);
  if (status == SD_OK) status = world->tell(world->ctx, e->borrow, e->lend);
  if (status == SD_OK) {
    e->lents = sum_over_ranks(world, e->lend);
    status = sd_world_agree(world, reserve_lent(e, (size_t) sd_bodies_count(A)) ? SD_OK : SD_ENOMEMORY);
  }
  if (status == SD_OK) status = world->exchange(world->ctx, numbers, e->borrow, e->sent, e->lend);
  if (status != SD_OK) e->lents = 0;
  for (int k = 0; k < e->lents; k++) e->lent[k] = (int) e->sent[k];
  for (int p = 0; p < world->ranks && status == SD_OK; p++) {
    e->lend[p] *= 6;
    e->borrow[p] *= 6;
  }
  free(numbers);
  return status;
}

static int border_reserve(meeting *b)
{
  const sd_tie *t = b->A->tie;
  const size_t ranks = (size_t) t->L->world.ranks, bodies = (size_t) sd_bodies_count(b->A);
  b->told = malloc(sizeof(int) * (bodies + 1));
  b->known = calloc((size_t) t->border.others + 1, 1);
  b->to = calloc(ranks, sizeof(int));
  b->from = calloc(ranks, sizeof(int));
  return b->told && b->known && b->to && b->from && sd_extend(&b->out, TRAVELLER * sizeof(double), 1, &b->room);
}

static void border_free(meeting *b)
{
  void *const arrays[] = {b->told, b->known, b->to, b->from, b->out, b->in};
  for (size_t k = 0; k < sizeof(arrays) / sizeof(arrays[0]); k++) free(arrays[k]);
}

/* --- what goes --- */

/* The block of two bodies that go to one rank, once */
static void tell_block(void *ctx, int p, int q, const double B[36])
{
  meeting *b = ctx;
  if (q < p || q >= sd_bodies_count(b->A) || b->told[q] != b->told[p]) return;
  double *row = b->out + TRAVELLER * b->rows++;
  float numbers[36];
  for (int e = 0; e < 36; e++) numbers[e] = (float) B[e];
  row[0] = p;
  row[1] = q;
  memcpy(row + 2, numbers, sizeof(numbers));
}

/* All that are lent, to one rank after the other; 0: no memory, or more than an int counts */
static int pack(meeting *b)
{
  const sd_tie *t = b->A->tie;
  const int *body = t->border.lent;
  for (int p = 0; p < sd_bodies_count(b->A); p++) b->told[p] = -1;
  for (int rank = 0; rank < t->L->world.ranks; rank++) {
    const size_t before = b->rows;
    const int many = t->border.lend[rank] / 6;
    for (int k = 0; k < many; k++)
      if (body[k] >= 0) b->told[body[k]] = rank;
    for (int k = 0; k < many; k++) {
      if (body[k] < 0) continue;
      const size_t most = b->rows + 1 + (size_t) sd_block_cholesky_degree(&t->factor, body[k]);
      if (most > INT_MAX / TRAVELLER || !sd_extend(&b->out, TRAVELLER * sizeof(double), most, &b->room)) return 0;
      sd_block_cholesky_left(&t->factor, body[k], tell_block, b);
    }
    body += many;
    b->to[rank] = TRAVELLER * (int) (b->rows - before);
  }
  return 1;
}

/* --- what comes --- */

static int by_rank(const void *one, const void *other)
{
  const sd_tie_other *p = one, *q = other;
  if (p->rank != q->rank) return p->rank < q->rank ? -1 : 1;
  return (p->body > q->body) - (p->body < q->body);
}

/* Which of the others it is */
static int number_there(const meeting *b, int rank, double body)
{
  const sd_tie_border *e = &b->A->tie->border;
  const sd_tie_other key = {rank, (int) body};
  const sd_tie_other *found = bsearch(&key, e->other, (size_t) e->others, sizeof(key), by_rank);
  return (int) (found - e->other);
}

static sd_status take_block(meeting *b, int rank, const double *row)
{
  sd_block_cholesky *factor = &b->A->tie->factor;
  const int p = number_there(b, rank, row[0]), q = number_there(b, rank, row[1]), bodies = sd_bodies_count(b->A);
  float numbers[36];
  double B[36];
  memcpy(numbers, row + 2, sizeof(numbers));
  for (int e = 0; e < 36; e++) B[e] = numbers[e];
  if (p == q) b->known[p] = 1;
  return sd_block_cholesky_add(factor, bodies + p, bodies + q, B);
}

static sd_status unpack(meeting *b)
{
  sd_tie *t = b->A->tie;
  const double *row = b->in;
  double unit[36] = {0.0};
  sd_status status = SD_OK;
  for (int d = 0; d < 6; d++) unit[7 * d] = 1.0;
  for (int p = 0; p < t->L->world.ranks; p++)
    for (int k = 0; k < b->from[p] && status == SD_OK; k += TRAVELLER, row += TRAVELLER)
      status = take_block(b, p, row);
  for (int o = 0; o < t->border.others && status == SD_OK; o++) {
    const int node = sd_bodies_count(b->A) + o;
    if (!b->known[o]) status = sd_block_cholesky_add(&t->factor, node, node, unit);
  }
  return status;
}

static int make_room(meeting *b)
{
  size_t numbers = 1;
  for (int p = 0; p < b->A->tie->L->world.ranks; p++) numbers += (size_t) b->from[p];
  b->in = malloc(sizeof(double) * numbers);
  return b->in != NULL;
}

sd_status sd_tie_border_share(const sd_bodies *A)
{
  const sd_world *world = &A->tie->L->world;
  meeting b = {.A = A};
  sd_status status = sd_world_agree(world, border_reserve(&b) && pack(&b) ? SD_OK : SD_ENOMEMORY);
  if (status == SD_OK) status = world->tell(world->ctx, b.to, b.from);
  if (status == SD_OK) status = sd_world_agree(world, make_room(&b) ? SD_OK : SD_ENOMEMORY);
  if (status == SD_OK) status = world->exchange(world->ctx, b.out, b.to, b.in, b.from);
  if (status == SD_OK) status = unpack(&b);
  border_free(&b);
  return status;
}
