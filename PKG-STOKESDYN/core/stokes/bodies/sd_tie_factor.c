#include "sd_tie_factor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_bodies_alone.h"
#include "sd_linear.h"
#include "sd_room.h"
#include "sd_tie_approach.h"
#include "sd_tie_border.h"

/* In units of the drags of the bodies: pairs whose block is smaller are left out of the factor, as
 * is such fill. */
static const double weak = 0.8, drop = 0.1;
/* Norm of its block from which a pair is stiff: too much so for different weights on its bodies, and it severs
 * where more than two ranks share them. A melt of 11 000 spheres (volume fraction 0.3, gaps counted from 1e-2
 * to 1e-6) then takes as many products with the mobility on four ranks as on one; with 400 half as many more
 * at 1e-3, whose pairs have 250. */
static const double stiff = 12.0;

typedef struct {
  /* [36 bodies] blocks of H_ii, scaled; [bodies and others] the square of the norm of its largest H_ij */
  double *diagonal, *largest;
  /* of the spheres of this rank and of the copies [SD_PLACE]; of copies the body that each belongs to, among
   * those of the factor, -1: none; does it stand for its sphere, which may have more copies? */
  int copies;
  double *mine, *place;
  int *body;
  char *stands;
} assembly;

static int layered(const sd_bodies *A)
{
  const sd_world *world = &A->tie->L->world;
  return world->ranks > 1 && world->refresh && world->tell && world->exchange && world->reduce;
}

/* --- H_ii --- */

static int has_arm(const double r[3])
{
  return r[0] != 0.0 || r[1] != 0.0 || r[2] != 0.0;
}

/* B := K_p^T B K_q for spheres at the arms r_p and r_q of their bodies: K = (1, -[r]x; 0, 1) */
static void move_to_centres(const double rp[3], const double rq[3], double B[36])
{
  for (int p = 0; p < 6; p++) { /* columns of W += columns of U, v = W x r */
    double *row = B + 6 * p, couple[3];
    sd_cross(rq, row, couple);
    for (int d = 0; d < 3; d++) row[3 + d] += couple[d];
  }
  for (int q = 0; q < 6; q++) {
    const double F[3] = {B[q], B[6 + q], B[12 + q]};
    double couple[3];
    sd_cross(rp, F, couple);
    for (int d = 0; d < 3; d++) B[6 * (3 + d) + q] += couple[d];
  }
}

static const double *arm_of(const sd_bodies *A, const assembly *a, int sphere)
{
  static const double none[3] = {0.0};
  const int n = A->spheres.n;
  if (sphere >= n) return a->place + SD_PLACE * (long) (sphere - n) + SD_PLACE_ARM;
  const double *arm = sd_bodies_films(A).arm;
  return arm ? arm + 3 * (long) sphere : none;
}

static void add_scaled(const double *B, const double *rows, const double *columns, double *out)
{
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 6; q++) out[6 * p + q] += rows[p] * B[6 * p + q] * columns[q];
}

static int is_zero(const double B[36])
{
  for (int e = 0; e < 36; e++)
    if (B[e] != 0.0) return 0;
  return 1;
}

/* H_0 of body b */
static void factor_own_block(const sd_bodies *A, int b, double H[36])
{
  const double *D = b < A->lone ? A->D + 6 * (long) A->loner[b] : NULL;
  for (int q = 0; q < 6; q++) {
    double unit[6] = {0.0}, column[6] = {0.0};
    unit[q] = 1.0;
    if (D)
      column[q] = D[q];
    else
      sd_body_resistance(A->body + b - A->lone, unit, column);
    for (int p = 0; p < 6; p++) H[6 * p + q] = column[p];
  }
}

/* L_ii + X_ii of a sphere */
static void films_on(const sd_tie *t, int i, double B[36])
{
  sd_lubrication_own_block(t->L, i, B);
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) B[6 * p + q] += t->stiff[6 * (long) i + sd_symmetric3_at(p, q)];
}

/* Films on spheres, by bodies, then all in units of the drags. A body that nobody is near to is
 * taken out by a scale of 0, and so is what is given of one's velocity. */
static void find_diagonal(const sd_bodies *A, assembly *a)
{
  const sd_tie *t = A->tie;
  for (int i = 0; i < A->spheres.n; i++) {
    const double *r = arm_of(A, a, i);
    double B[36], *to = a->diagonal + 36 * (long) sd_rigid_whole(&A->spheres, i);
    films_on(t, i, B);
    if (has_arm(r)) move_to_centres(r, r, B);
    for (int e = 0; e < 36; e++) to[e] += B[e];
  }
  for (int b = 0; b < sd_bodies_count(A); b++) {
    double *block = a->diagonal + 36 * (long) b, *scale = t->scale + 6 * (long) b, H[36];
    const int out = is_zero(block);
    factor_own_block(A, b, H);
    for (int d = 0; d < 6; d++)
      scale[d] = out || sd_bodies_velocity_known(A, b, d) ? 0.0 : 1.0 / sqrt(H[7 * d]);
    for (int e = 0; e < 36; e++) H[e] += block[e];
    memset(block, 0, 36 * sizeof(double));
    add_scaled(H, scale, scale, block);
    for (int d = 0; d < 6; d++)
      if (scale[d] == 0.0) block[7 * d] = 1.0;
  }
}

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
    memcpy(row + SD_PLACE_ARM, arm_of(A, a, i), 3 * sizeof(double));
    memcpy(row + SD_PLACE_SCALE, A->tie->scale + 6 * b, 6 * sizeof(double));
  }
  return L->world.refresh(L->world.ctx, a->mine, a->place, SD_PLACE);
}

typedef struct {
  int rank, body, row, copy;
} identity;

static int by_identity(const void *one, const void *other)
{
  const identity *p = one, *q = other;
  if (p->rank != q->rank) return p->rank < q->rank ? -1 : 1;
  if (p->body != q->body) return p->body < q->body ? -1 : 1;
  if (p->row != q->row) return p->row < q->row ? -1 : 1;
  return (p->copy > q->copy) - (p->copy < q->copy);
}

/* Those with spheres near this rank's. Copies of one body are brought together, and the first of each sphere
 * stands for it. */
static sd_status know_others(const sd_bodies *A, assembly *a)
{
  sd_tie *t = A->tie;
  const int bodies = sd_bodies_count(A);
  identity *who = malloc(sizeof(identity) * ((size_t) a->copies + 1));
  int count = 0;
  if (!who) return SD_ENOMEMORY;
  for (int j = 0; j < a->copies; j++) {
    a->body[j] = -1;
    a->stands[j] = 0;
  }
  for (long k = 0; a->copies > 0 && k < t->L->count; k++) {
    const int j = t->L->pair[k][1] - t->L->n;
    if (j < 0 || a->stands[j]) continue;
    const double *row = a->place + SD_PLACE * (long) j;
    a->stands[j] = 1; /* seen */
    if (row[SD_PLACE_SCALE] == 0.0) continue;
    who[count++] = (identity){(int) row[SD_PLACE_RANK], (int) row[SD_PLACE_BODY], (int) row[SD_PLACE_ROW], j};
  }
  qsort(who, (size_t) count, sizeof(identity), by_identity);
  for (int k = 0; k < count; k++) {
    const identity *p = who + k, *last = k > 0 ? p - 1 : NULL;
    const int known = last && last->rank == p->rank && last->body == p->body;
    if (!known) {
      const double *row = a->place + SD_PLACE * (long) p->copy;
      memcpy(t->scale + 6 * (long) (bodies + t->others), row + SD_PLACE_SCALE, 6 * sizeof(double));
      t->copy[t->others++] = p->copy;
    }
    a->body[p->copy] = bodies + t->others - 1;
    a->stands[p->copy] = !(known && last->row == p->row);
  }
  free(who);
  return SD_OK;
}

/* --- H_ij --- */

/* The square of the norm of a pair's scaled block, if its spheres are free; at least that if they
 * are the middles of clumps. p, q: largest scales of U and W */
static double strength(const sd_lubrication_link *l, const double p[2], const double q[2])
{
  const double UU = p[0] * q[0], UW = p[0] * q[1], WU = p[1] * q[0], WW = p[1] * q[1];
  return UU * UU * (l->XA * l->XA + 2.0 * l->YA * l->YA) +
      2.0 * (UW * UW * l->YB21 * l->YB21 + WU * WU * l->YB12 * l->YB12) +
      WW * WW * (l->XC * l->XC + 2.0 * l->YC * l->YC);
}

static void largest_scales(const double s[6], double of[2])
{
  of[0] = fmax(fmax(s[0], s[1]), s[2]);
  of[1] = fmax(fmax(s[3], s[4]), s[5]);
}

/* Number of the body in the factor; -1: not there */
static int number_of(const sd_bodies *A, const assembly *a, int sphere)
{
  const int n = A->spheres.n, b = sphere < n ? sd_rigid_whole(&A->spheres, sphere) : a->body[sphere - n];
  return b >= 0 && sd_tie_binds(A, b) ? b : -1;
}

/* Of a pair beyond: what two bodies of one rank resist, that rank tells (sd_tie_border.h). The spheres
 * stand for themselves, so that each pair is there once. */
static int is_ours_to_add(const sd_bodies *A, const assembly *a, int i, int j)
{
  const int p = i - A->tie->L->n, q = j - A->tie->L->n;
  return a->stands[p] && a->stands[q] &&
      a->place[SD_PLACE * (long) p + SD_PLACE_RANK] != a->place[SD_PLACE * (long) q + SD_PLACE_RANK];
}

/* The block of pair k, scaled, if it is not weak */
static sd_status add_block(const sd_bodies *A, assembly *a, long k)
{
  sd_tie *t = A->tie;
  const sd_lubrication *L = t->L;
  const int i = L->pair[k][0], j = L->pair[k][1];
  const int p = number_of(A, a, i), q = number_of(A, a, j);
  if (p < 0 || q < 0 || p == q) return SD_OK;
  if (i >= L->n && !is_ours_to_add(A, a, i, j)) return SD_OK;
  const double *rp = arm_of(A, a, i), *rq = arm_of(A, a, j);
  const double *sp = t->scale + 6 * (long) p, *sq = t->scale + 6 * (long) q;
  const int arms = has_arm(rp) || has_arm(rq);
  sd_lubrication_link both = L->link[k];
  double of_p[2], of_q[2], B[36] = {0.0}, scaled[36] = {0.0}, sum = 0.0;
  both.XA -= t->spring[k]; /* L_12 + X_12 */
  largest_scales(sp, of_p);
  largest_scales(sq, of_q);
  if (!arms && strength(&both, of_p, of_q) < weak * weak) return SD_OK;
  sd_lubrication_add_block(&both, B);
  if (arms) move_to_centres(rp, rq, B);
  add_scaled(B, sp, sq, scaled);
  for (int e = 0; e < 36; e++) sum += scaled[e] * scaled[e];
  a->largest[p] = fmax(a->largest[p], sum);
  a->largest[q] = fmax(a->largest[q], sum);
  return sum < weak * weak ? SD_OK : sd_block_cholesky_add(&t->factor, p, q, scaled);
}

static sd_status factor_reserve(const sd_bodies *A, assembly *a)
{
  sd_tie *t = A->tie;
  const size_t bodies = (size_t) sd_bodies_count(A), number = sizeof(double);
  a->copies = layered(A) ? t->L->n_all - t->L->n : 0;
  const size_t all = bodies + (size_t) a->copies, copies = (size_t) a->copies;
  memset(a->diagonal, 0, 36 * bodies * number);
  a->largest = calloc(all + 1, number);
  a->mine = malloc(number * (SD_PLACE * (size_t) A->spheres.n + 1));
  a->place = malloc(number * (SD_PLACE * copies + 1));
  a->body = malloc(sizeof(int) * (copies + 1));
  a->stands = malloc(copies + 1);
  t->others = t->severed = 0;
  const int there = a->largest && a->mine && a->place && a->body && a->stands &&
      sd_reserve(&t->scale, number, 6 * all, &t->most_scales) &&
      sd_reserve(&t->weight, number, bodies, &t->most_weights) &&
      sd_reserve(&t->shared, sizeof(int), bodies, &t->most_shared) &&
      sd_reserve(&t->edge, sizeof(int), (size_t) A->spheres.n, &t->most_edges) &&
      sd_reserve(&t->all, number, 6 * all, &t->most_all) &&
      sd_reserve(&t->copy, sizeof(int), copies, &t->most_copies) &&
      sd_reserve(&t->copies, number, 6 * copies, &t->most_rows_there);
  return there ? SD_OK : SD_ENOMEMORY;
}

/* All that no other rank knows of is eliminated. */
static sd_status assemble(const sd_bodies *A, assembly *a)
{
  sd_tie *t = A->tie;
  const int bodies = sd_bodies_count(A);
  sd_status status = know_others(A, a);
  if (status == SD_OK) status = sd_block_cholesky_begin(&t->factor, bodies + t->others);
  for (int b = 0; b < bodies && status == SD_OK; b++)
    status = sd_block_cholesky_add(&t->factor, b, b, a->diagonal + 36 * (long) b);
  const long pairs = t->L->count + (a->copies > 0 ? t->L->beyond : 0);
  for (long k = 0; k < pairs && status == SD_OK; k++) status = add_block(A, a, k);
  if (status == SD_OK && a->copies > 0) sd_tie_border_put_off(A);
  return status == SD_OK ? sd_block_cholesky_factor(&t->factor, drop) : status;
}

/* W of this rank's bodies by how many ranks have each; and who is severed */
static sd_status weigh(const sd_bodies *A, const assembly *a)
{
  sd_tie *t = A->tie;
  double severed = 0.0;
  t->shares = t->edges = 0;
  for (int b = 0; b < sd_bodies_count(A); b++) {
    const double ranks = t->weight[b];
    const int tight = a->largest[b] >= stiff * stiff;
    t->weight[b] = 1.0 / sqrt(tight ? fmin(ranks, 2.0) : ranks);
    if (ranks > 1.0) t->shared[t->shares++] = b;
    if (tight && ranks > 1.0) severed = 1.0;
  }
  for (int i = 0; i < A->spheres.n; i++)
    if (t->weight[sd_rigid_whole(&A->spheres, i)] < 1.0) t->edge[t->edges++] = i;
  const sd_status status = sd_world_sum(&t->L->world, &severed, 1);
  t->severed = t->L->world.ranks > 2 && severed > 0.0;
  return status;
}

sd_status sd_tie_factor(const sd_bodies *A, double *blocks)
{
  const sd_world *world = &A->tie->L->world;
  assembly a = {.diagonal = blocks};
  sd_status status = sd_world_agree(world, factor_reserve(A, &a));
  if (status == SD_OK) find_diagonal(A, &a);
  if (status == SD_OK && layered(A)) status = tell_places(A, &a);
  if (status == SD_OK) status = assemble(A, &a);
  if (layered(A)) status = sd_tie_border_share(A, a.place, A->tie->weight, status);
  if (status == SD_OK) status = sd_block_cholesky_finish(&A->tie->factor, drop);
  status = sd_world_agree(world, status);
  if (status == SD_OK && layered(A)) status = weigh(A, &a);
  free(a.largest);
  free(a.mine);
  free(a.place);
  free(a.body);
  free(a.stands);
  return status;
}

/* --- P^-1 --- */

sd_status sd_tie_precondition(const sd_bodies *A, const double *r, double *rows, double *z)
{
  const sd_tie *t = A->tie;
  const long size = 6 * (long) sd_bodies_count(A);
  sd_status status = SD_OK;
  for (long j = 0; j < size; j++) t->all[j] = t->scale[j] * r[j];
  if (layered(A)) {
    memset(t->all + size, 0, sizeof(double) * 6 * (size_t) t->others);
    sd_block_cholesky_forth(&t->factor, t->all);
    status = sd_tie_border_meet(A, rows);
    sd_block_cholesky_back(&t->factor, t->all);
  } else
    sd_block_cholesky_apply(&t->factor, t->all);
  for (long j = 0; j < size; j++) z[j] = t->scale[j] * t->all[j];
  return status;
}
