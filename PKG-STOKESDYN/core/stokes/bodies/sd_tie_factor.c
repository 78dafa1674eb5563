#include "sd_tie_factor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_room.h"
#include "sd_tie_blocks.h"
#include "sd_tie_border.h"
#include "sd_tie_kept.h"

/* In units of the drags of the bodies: pairs whose block is smaller are left out of the factor, as
 * is such fill. */
static const double weak = 0.8, drop = 0.1;
/* Norm of its block from which a pair is stiff: too much so for different weights on its bodies, and it severs
 * where more than two ranks share them. A melt of 11 000 spheres (volume fraction 0.3, gaps counted from 1e-2
 * to 1e-6) then takes as many products with the mobility on four ranks as on one; with 400 half as many more
 * at 1e-3, whose pairs have 250. */
static const double stiff = 12.0;

/* A sphere that has a film with one of this rank: whose copy it is */
typedef struct {
  int rank, body, row, copy;
} identity;

/* In whose factor a body of this rank would be, for its pairs across borders that are not weak */
enum { NOBODYS = -1, SEVERAL = -2 };

typedef struct {
  /* [36 bodies] blocks of H_ii, scaled; [bodies and others] the square of the norm of its largest H_ij */
  double *diagonal, *largest;
  /* [bodies] a rank, or as above; is it in the factor here? */
  int *solver;
  char *here;
  /* of the spheres of this rank and of the copies [SD_PLACE] */
  int copies;
  double *mine, *place;
  /* [seen] copies with films, in ascending order, of so many bodies of other ranks */
  identity *who;
  int seen, bodies_there;
  /* of copies the body that each belongs to, among those of the factor, -1: none; does it stand for its sphere,
   * which may have more copies? Has it a pair that is not weak? */
  int *body;
  char *stands, *strong;
} assembly;

/* --- bodies of other ranks --- */

static sd_status tell_places(const sd_bodies *A, assembly *a)
{
  const sd_lubrication *L = A->tie->L;
  for (int i = 0; i < L->n; i++) {
    double *row = a->mine + SD_PLACE * (long) i;
    const long b = sd_rigid_whole(&A->spheres, i);
    row[SD_PLACE_RANK] = L->world.me;
    row[SD_PLACE_ROW] = i;
    row[SD_PLACE_BODY] = (double) b;
    memcpy(row + SD_PLACE_ARM, sd_tie_arm(A, NULL, i), 3 * sizeof(double));
    memcpy(row + SD_PLACE_SCALE, A->tie->scale + 6 * b, 6 * sizeof(double));
  }
  return L->world.refresh(L->world.ctx, a->mine, a->place, SD_PLACE);
}

static int by_identity(const void *one, const void *other)
{
  const identity *p = one, *q = other;
  if (p->rank != q->rank) return p->rank < q->rank ? -1 : 1;
  if (p->body != q->body) return p->body < q->body ? -1 : 1;
  if (p->row != q->row) return p->row < q->row ? -1 : 1;
  return (p->copy > q->copy) - (p->copy < q->copy);
}

static int rank_of_copy(const assembly *a, int copy)
{
  return (int) a->place[SD_PLACE * (long) copy + SD_PLACE_RANK];
}

static int is_above(const sd_tie *t, const assembly *a, int copy)
{
  return t->above ? t->above[copy] != 0.0 : rank_of_copy(a, copy) > t->L->world.me;
}

/* A pair of body b, of this rank, with a copy */
static void look_at_pair(const sd_bodies *A, assembly *a, long k, int b, int copy)
{
  const int me = A->tie->L->world.me, above = is_above(A->tie, a, copy);
  double block[36] = {0.0};
  const double square = sd_tie_find_block(A, a->place, k, weak, block);
  a->largest[b] = fmax(a->largest[b], square);
  if (square < weak * weak) return;
  const int solver = above ? me : rank_of_copy(a, copy);
  a->solver[b] = a->solver[b] == NOBODYS || a->solver[b] == solver ? solver : SEVERAL;
  a->here[b] = a->here[b] || above;
  a->strong[copy] = 1;
}

/* Is pair k one of a body of this rank, b, with a copy, j? */
static int is_across(const sd_bodies *A, const assembly *a, long k, int *b, int *j)
{
  const sd_lubrication *L = A->tie->L;
  *b = sd_rigid_whole(&A->spheres, L->pair[k][0]);
  *j = L->pair[k][1] - L->n;
  if (a->copies == 0 || *j < 0) return 0;
  const double *scale = a->place + SD_PLACE * (long) *j + SD_PLACE_SCALE;
  return (scale[0] != 0.0 || scale[3] != 0.0) && sd_tie_binds(A, *b);
}

/* Who is beyond the border */
static void look_across(const sd_bodies *A, assembly *a)
{
  const sd_lubrication *L = A->tie->L;
  int b, j;
  for (long k = 0; k < L->count; k++) {
    if (!is_across(A, a, k, &b, &j)) continue;
    const double *row = a->place + SD_PLACE * (long) j;
    look_at_pair(A, a, k, b, j);
    if (!a->stands[j])
      a->who[a->seen++] = (identity){(int) row[SD_PLACE_RANK], (int) row[SD_PLACE_BODY], (int) row[SD_PLACE_ROW], j};
    a->stands[j] = 1;
  }
  qsort(a->who, (size_t) a->seen, sizeof(identity), by_identity);
  for (int k = 0; k < a->seen; k++)
    a->bodies_there += k == 0 || a->who[k].rank != a->who[k - 1].rank || a->who[k].body != a->who[k - 1].body;
}

/* Where more than two ranks meet, weak pairs bring bodies into their factors as well, which end farther from the
 * border: spheres chained by stiff pairs then take a tenth fewer products on four ranks. On all ranks together; mine:
 * the status of this one */
static sd_status look_farther(const sd_bodies *A, assembly *a, sd_status mine)
{
  double several = 0.0;
  int b, j;
  for (b = 0; b < sd_bodies_count(A) && mine == SD_OK; b++) several += a->solver[b] == SEVERAL;
  const sd_status status = sd_world_sum(&A->tie->L->world, &several, 1);
  if (mine != SD_OK || status != SD_OK || several == 0.0) return mine != SD_OK ? mine : status;
  for (long k = 0; k < A->tie->L->count; k++) {
    if (!is_across(A, a, k, &b, &j)) continue;
    a->solver[b] = SEVERAL;
    a->strong[j] = 1;
  }
  return SD_OK;
}

/* Would two bodies that are coupled be in no factor together, or one in several? */
static int borders_meet(const sd_bodies *A, const assembly *a)
{
  const sd_block_cholesky *factor = &A->tie->factor;
  for (int b = 0; b < sd_bodies_count(A); b++) {
    const int solver = a->solver[b];
    if (solver == NOBODYS) continue;
    if (solver == SEVERAL) return 1;
    for (int k = 0; k < sd_block_cholesky_degree(factor, b); k++)
      if (a->solver[sd_block_cholesky_beside(factor, b, k)] != solver) return 1;
  }
  return 0;
}

/* Copies of one body are brought together, and the first of each sphere stands for it. */
static void take_other(const sd_bodies *A, assembly *a, const identity *who, int count, int all)
{
  sd_tie *t = A->tie;
  sd_tie_border *e = &t->border;
  const int number = sd_bodies_count(A) + e->others;
  int wanted = 0;
  for (int k = 0; k < count; k++)
    wanted = wanted || (a->strong[who[k].copy] && (all || is_above(t, a, who[k].copy)));
  for (int k = 0; k < count && wanted; k++) {
    a->stands[who[k].copy] = k == 0 || who[k - 1].row != who[k].row;
    a->body[who[k].copy] = number;
  }
  if (!wanted) return;
  const double *row = a->place + SD_PLACE * (long) who->copy;
  memcpy(t->scale + 6 * (long) number, row + SD_PLACE_SCALE, 6 * sizeof(double));
  e->other[e->others++] = (sd_tie_other){who->rank, who->body};
}

/* Those above, or all */
static void know_others(const sd_bodies *A, assembly *a, int all)
{
  const identity *who = a->who;
  for (int first = 0, end; first < a->seen; first = end) {
    for (end = first; end < a->seen && who[end].rank == who[first].rank && who[end].body == who[first].body;) end++;
    take_other(A, a, who + first, end - first, all);
  }
  for (int b = 0; b < sd_bodies_count(A) && all; b++) a->here[b] = a->solver[b] != NOBODYS;
}

/* --- the factor --- */

/* Number of the body in the factor; -1: not there */
static int number_of(const sd_bodies *A, const assembly *a, int sphere)
{
  const int n = A->spheres.n, b = sphere < n ? sd_rigid_whole(&A->spheres, sphere) : a->body[sphere - n];
  return b >= 0 && sd_tie_binds(A, b) ? b : -1;
}

/* Of a pair beyond: the spheres stand for themselves, so that each pair is there once. What two bodies of one rank
 * resist, that rank tells (sd_tie_border.h). */
static int is_ours_to_add(const sd_bodies *A, const assembly *a, int i, int j)
{
  const int n = A->tie->L->n;
  return a->stands[i - n] && a->stands[j - n];
}

/* The block of pair k, scaled, if it is not weak and both of its bodies are in the factor */
static sd_status add_block(const sd_bodies *A, assembly *a, long k)
{
  sd_tie *t = A->tie;
  const int n = t->L->n, i = t->L->pair[k][0], j = t->L->pair[k][1];
  const int p = number_of(A, a, i), q = number_of(A, a, j);
  if (p < 0 || q < 0 || p == q) return SD_OK;
  if (i >= n ? !is_ours_to_add(A, a, i, j) : j >= n && !a->here[p]) return SD_OK;
  double scaled[36] = {0.0};
  const double square = sd_tie_find_block(A, a->place, k, weak, scaled);
  a->largest[p] = fmax(a->largest[p], square);
  a->largest[q] = fmax(a->largest[q], square);
  return square < weak * weak ? SD_OK : sd_block_cholesky_add(&t->factor, p, q, scaled);
}

static int assembly_reserve(const sd_bodies *A, assembly *a)
{
  const size_t bodies = (size_t) sd_bodies_count(A), copies = (size_t) a->copies, number = sizeof(double);
  a->largest = calloc(bodies + copies + 1, number);
  a->solver = malloc(sizeof(int) * (bodies + 1));
  a->here = calloc(bodies + 1, 1);
  a->mine = malloc(number * (SD_PLACE * (size_t) A->spheres.n + 1));
  a->place = malloc(number * (SD_PLACE * copies + 1));
  a->who = malloc(sizeof(identity) * (copies + 1));
  a->body = malloc(sizeof(int) * (copies + 1));
  a->stands = calloc(copies + 1, 1);
  a->strong = calloc(copies + 1, 1);
  if (!a->largest || !a->solver || !a->here || !a->mine || !a->place || !a->who || !a->body || !a->stands || !a->strong)
    return 0;
  for (size_t b = 0; b < bodies; b++) a->solver[b] = NOBODYS;
  for (size_t j = 0; j < copies; j++) a->body[j] = -1;
  return 1;
}

static void assembly_free(assembly *a)
{
  void *const arrays[] = {a->largest, a->solver, a->here, a->mine, a->place, a->who, a->body, a->stands, a->strong};
  for (size_t k = 0; k < sizeof(arrays) / sizeof(arrays[0]); k++) free(arrays[k]);
}

static int copies_of(const sd_bodies *A)
{
  return sd_tie_is_layered(A) ? A->tie->L->n_all - A->tie->L->n : 0;
}

/* For H_ii, which say whether the factor stays */
static sd_status reserve_diagonal(const sd_bodies *A)
{
  sd_tie *t = A->tie;
  const size_t bodies = (size_t) sd_bodies_count(A);
  return sd_reserve(&t->scale, sizeof(double), 6 * (bodies + (size_t) copies_of(A)), &t->most_scales) &&
          sd_extend(&t->made_of, 6 * sizeof(double), bodies + 1, &t->most_made_of)
      ? SD_OK
      : SD_ENOMEMORY;
}

static sd_status factor_reserve(const sd_bodies *A, assembly *a)
{
  sd_tie *t = A->tie;
  sd_tie_border *e = &t->border;
  a->copies = copies_of(A);
  const size_t bodies = (size_t) sd_bodies_count(A), copies = (size_t) a->copies, number = sizeof(double);
  e->others = e->lents = e->aways = e->severed = 0;
  const int there = assembly_reserve(A, a) &&
      sd_reserve(&e->weight, number, bodies, &e->most_weights) &&
      sd_reserve(&e->shared, sizeof(int), bodies, &e->most_shared) &&
      sd_reserve(&e->other, sizeof(*e->other), copies, &e->most_others) &&
      sd_reserve(&t->all, number, 6 * (bodies + copies), &t->most_all);
  return there ? SD_OK : SD_ENOMEMORY;
}

/* All that have no pair across a border are eliminated. */
static sd_status eliminate_inner(const sd_bodies *A, assembly *a)
{
  sd_tie *t = A->tie;
  const int bodies = sd_bodies_count(A), all = bodies + a->bodies_there;
  sd_status status = sd_block_cholesky_begin(&t->factor, all);
  for (int b = 0; b < bodies && status == SD_OK; b++) {
    if (a->solver[b] != NOBODYS) sd_block_cholesky_put_off(&t->factor, b);
    status = sd_block_cholesky_add(&t->factor, b, b, a->diagonal + 36 * (long) b);
  }
  for (int o = bodies; o < all && status == SD_OK; o++) sd_block_cholesky_put_off(&t->factor, o);
  for (long k = 0; k < t->L->count && status == SD_OK; k++)
    if (t->L->pair[k][1] < t->L->n) status = add_block(A, a, k);
  return status == SD_OK ? sd_block_cholesky_factor(&t->factor, drop) : status;
}

/* weight of bodies of this rank: in how many factors each is; away. One that nobody wants stays here. */
static void know_lent(const sd_bodies *A, assembly *a)
{
  sd_tie_border *e = &A->tie->border;
  memset(e->weight, 0, sizeof(double) * (size_t) sd_bodies_count(A));
  for (int k = 0; k < e->lents; k++)
    if (e->lent[k] >= 0) e->weight[e->lent[k]] += 1.0;
  for (int b = 0; b < sd_bodies_count(A); b++) {
    if (a->solver[b] == NOBODYS) continue;
    if (e->weight[b] == 0.0) a->here[b] = 1;
    if (a->here[b]) e->weight[b] += 1.0;
    else e->away[e->aways++] = b;
  }
}

/* What is left of all at borders, and pairs across these */
static sd_status assemble_border(const sd_bodies *A, assembly *a)
{
  sd_tie *t = A->tie;
  const int all = sd_bodies_count(A) + a->bodies_there;
  sd_status status = SD_OK;
  know_lent(A, a);
  for (int k = 0; k < t->border.aways; k++) sd_block_cholesky_leave_out(&t->factor, t->border.away[k]);
  for (int o = sd_bodies_count(A) + t->border.others; o < all; o++) sd_block_cholesky_leave_out(&t->factor, o);
  for (long k = 0; k < t->L->count + t->L->beyond && status == SD_OK; k++)
    if (t->L->pair[k][1] >= t->L->n) status = add_block(A, a, k);
  return status;
}

/* W of this rank's bodies by how many factors each is in; and who is severed */
static sd_status weigh(const sd_bodies *A, const assembly *a)
{
  sd_tie_border *e = &A->tie->border;
  const sd_world *world = &A->tie->L->world;
  double severed = 0.0;
  e->shares = 0;
  for (int b = 0; b < sd_bodies_count(A); b++) {
    const double factors = e->weight[b];
    const int tight = a->largest[b] >= stiff * stiff;
    if (factors <= 1.0) continue;
    e->weight[b] = 1.0 / sqrt(tight ? 2.0 : factors);
    e->shared[e->shares++] = b;
    if (tight) severed = 1.0;
  }
  const sd_status status = sd_world_sum(world, &severed, 1);
  e->severed = world->ranks > 2 && severed > 0.0;
  return status;
}

/* On all ranks together */
static sd_status share_border(const sd_bodies *A, assembly *a, sd_status mine)
{
  const sd_tie_border *e = &A->tie->border;
  double meeting = mine == SD_OK && borders_meet(A, a);
  sd_status status = sd_world_sum(&A->tie->L->world, &meeting, 1);
  if (mine == SD_OK) know_others(A, a, meeting > 0.0);
  status = sd_tie_border_lend(A, mine == SD_OK ? status : mine);
  for (int k = 0; k < e->lents; k++)
    if (a->solver[e->lent[k]] == NOBODYS) e->lent[k] = -1;
  if (status == SD_OK) status = sd_tie_border_share(A);
  return status == SD_OK ? assemble_border(A, a) : status;
}

static sd_status make_anew(const sd_bodies *A, double *blocks, sd_status mine)
{
  const sd_world *world = &A->tie->L->world;
  const int layered = sd_tie_is_layered(A);
  assembly a = {.diagonal = blocks};
  A->tie->made_for = -1;
  sd_status status = sd_world_agree(world, mine == SD_OK ? factor_reserve(A, &a) : mine);
  if (status == SD_OK) sd_tie_note(A, blocks);
  if (status == SD_OK && layered) status = tell_places(A, &a);
  if (status == SD_OK) look_across(A, &a);
  if (layered && world->ranks > 2) status = look_farther(A, &a, status);
  if (status == SD_OK) status = eliminate_inner(A, &a);
  if (layered) status = share_border(A, &a, status);
  if (status == SD_OK) status = sd_block_cholesky_finish(&A->tie->factor, drop);
  status = sd_world_agree(world, status);
  if (status == SD_OK && layered) status = weigh(A, &a);
  if (status != SD_OK) A->tie->made_for = -1;
  assembly_free(&a);
  return status;
}

sd_status sd_tie_factor(const sd_bodies *A, double *blocks)
{
  int stays = 0;
  const sd_status mine = reserve_diagonal(A);
  if (mine == SD_OK) sd_tie_find_diagonal(A, blocks);
  const sd_status status = A->tie->keep ? sd_tie_kept(A, blocks, mine, &stays) : SD_OK;
  A->tie->anew = !stays;
  return stays || status != SD_OK ? status : make_anew(A, blocks, mine);
}
