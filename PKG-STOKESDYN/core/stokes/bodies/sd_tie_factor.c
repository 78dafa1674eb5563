#include "sd_tie_factor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_room.h"

/* In units of the drags of the bodies: pairs whose block is smaller are left out of the factor, as
 * is such fill. */
static const double weak = 0.8, drop = 0.1;

/* Stiff pairs chain bodies of all ranks together, and a factor that ends at a rank would not know
 * how they move as one. So each rank has the whole: blocks and vectors are put where they belong
 * among zeros and summed over the ranks. */
typedef struct {
  /* bodies of all ranks; [36 total] blocks of H_ii, scaled; [6 total] 1 over the roots of the
   * diagonal of H_0, 0: nobody is near to this body */
  int total;
  double *diagonal, *scale;
  /* by rows: number of the body, from its centre to the sphere, largest scales of its U and W;
   * likewise of other ranks' rows */
  double *place, *others;
  /* [count] blocks between bodies where they go to other ranks: numbers of the two, block */
  long count;
  double (*rows)[2 + 36];
} assembly;

enum { NUMBER, ARM, SCALES = 4, PLACE = 6 };

static int ranks_of(const sd_bodies *A)
{
  return A->tie->L->world.ranks > 1 ? A->tie->L->world.ranks : 1;
}

static sd_status sum_over_ranks(const sd_bodies *A, double *values, long count)
{
  return ranks_of(A) > 1 && A->sum ? A->sum(A->sum_ctx, values, (int) count) : SD_OK;
}

/* How many there are before this rank's, and in all */
static sd_status share(const sd_bodies *A, long mine, long *before, long *all)
{
  const int ranks = ranks_of(A), me = ranks > 1 ? A->tie->L->world.me : 0;
  double *counts = calloc((size_t) ranks, sizeof(double));
  if (!counts) return SD_ENOMEMORY;
  counts[me] = (double) mine;
  const sd_status status = sum_over_ranks(A, counts, ranks);
  *before = *all = 0;
  for (int p = 0; p < ranks; p++) {
    if (p < me) *before += (long) counts[p];
    *all += (long) counts[p];
  }
  free(counts);
  return status;
}

/* Numbers of bodies among those of all ranks; a clump of several ranks learns its own from the
 * rank that counts it. */
static sd_status number_bodies(const sd_bodies *A, assembly *a)
{
  sd_tie *t = A->tie;
  const long bodies = sd_tie_bodies(A);
  long mine = A->lone, next, total;
  for (int b = 0; b < A->clumps; b++) mine += sd_tie_ours(A, b);
  sd_status status = share(A, mine, &next, &total);
  if (!sd_grow(&t->number, sizeof(int), (size_t) bodies) ||
      !sd_grow(&t->scale, 6 * sizeof(double), (size_t) bodies) ||
      !sd_grow(&t->all, 6 * sizeof(double), (size_t) total))
    return SD_ENOMEMORY;
  int *number = t->number;
  a->total = (int) total;
  for (int e = 0; e < A->lone; e++) number[e] = (int) next++;
  for (int b = 0; b < A->clumps; b++)
    if (sd_tie_ours(A, b)) number[A->lone + b] = (int) next++;
  if (status != SD_OK || !A->refresh) return status;
  memset(t->rows, 0, sizeof(double) * 6 * (size_t) A->n);
  for (int b = 0; b < A->clumps; b++)
    if (sd_tie_ours(A, b)) t->rows[6 * (long) A->member[A->first[b]]] = number[A->lone + b];
  status = sd_bodies_refresh(A, t->rows, t->ghosts);
  for (int b = 0; b < A->clumps && status == SD_OK; b++)
    number[A->lone + b] = (int) sd_bodies_row(A, t->rows, t->ghosts, b, 0)[0];
  return status;
}

/* From the centroid of body b to its sphere number k, in space axes; 0 for a free sphere */
static void arm_of(const sd_bodies *A, int body, int k, double r[3])
{
  const int b = body - A->lone;
  if (b < 0)
    memset(r, 0, 3 * sizeof(double));
  else
    sd_multiply3(A->pose + 9 * (long) b, A->shape[b]->x + 3 * k, r);
}

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

/* H_0 of clump b in space axes */
static void own_block(const sd_bodies *A, int b, double *out)
{
  const double *R = A->pose + 9 * (long) b;
  for (int q = 0; q < 6; q++) {
    double unit[6] = {0.0}, v[6], f[6], column[6];
    unit[q] = 1.0;
    sd_bodies_to_shape(R, unit, v);
    sd_bodies_multiply6(A->shape[b]->resistance, v, f);
    sd_bodies_to_space(R, f, column);
    for (int p = 0; p < 6; p++) out[6 * p + q] = A->eta[b] * column[p];
  }
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

/* A body that nobody is near to: scale 0 takes it out of the system, and it has V = V_0 exactly. */
static void leave_out(double scale[6], double diagonal[36])
{
  for (int d = 0; d < 6; d++) {
    scale[d] = 0.0;
    diagonal[7 * d] = 1.0;
  }
}

/* A lone sphere, scaled; sets the scale */
static void lone_block(const sd_bodies *A, int i, const double *L, double *scale, double *out)
{
  for (int d = 0; d < 6; d++) scale[d] = 1.0 / sqrt(sd_bodies_drag(A, i, d));
  add_scaled(L, scale, scale, out);
  if (is_zero(out))
    leave_out(scale, out);
  else
    for (int d = 0; d < 6; d++) out[7 * d] += 1.0;
}

/* Of a clump every sphere counts, of whatever rank: ghosts [36 ghosts] have their L_ii. */
static void clump_block(const sd_bodies *A, int b, const double *ghosts, double *scale, double *out)
{
  const double *L = A->tie->stiff;
  double H[36];
  int near = 0;
  own_block(A, b, H);
  for (int d = 0; d < 6; d++) scale[d] = 1.0 / sqrt(H[7 * d]);
  for (int k = 0; k < A->shape[b]->m; k++) {
    const int j = A->member[A->first[b] + k];
    double B[36], r[3];
    memcpy(B, j < A->n ? L + 36 * (long) j : ghosts + 36 * (long) (j - A->n), sizeof(B));
    near = near || !is_zero(B);
    arm_of(A, A->lone + b, k, r);
    move_to_centres(r, r, B);
    for (int e = 0; e < 36; e++) H[e] += B[e];
  }
  if (near)
    add_scaled(H, scale, scale, out);
  else
    leave_out(scale, out);
}

static sd_status find_diagonal(const sd_bodies *A, assembly *a)
{
  sd_tie *t = A->tie;
  const double *L = t->stiff;
  sd_status status = A->refresh ? A->refresh(A->refresh_ctx, L, t->ghosts, 36) : SD_OK;
  a->diagonal = calloc(36 * ((size_t) a->total + 1), sizeof(double));
  a->scale = calloc(6 * ((size_t) a->total + 1), sizeof(double));
  if (!a->diagonal || !a->scale) return SD_ENOMEMORY;
  for (int e = 0; e < A->lone; e++) {
    const long to = t->number[e];
    lone_block(A, A->loner[e], L + 36 * (long) A->loner[e], a->scale + 6 * to,
               a->diagonal + 36 * to);
  }
  for (int b = 0; b < A->clumps; b++) {
    const long to = t->number[A->lone + b];
    if (sd_tie_ours(A, b)) clump_block(A, b, t->ghosts, a->scale + 6 * to, a->diagonal + 36 * to);
  }
  if (status == SD_OK) status = sum_over_ranks(A, a->scale, 6 * (long) a->total);
  if (status == SD_OK) status = sum_over_ranks(A, a->diagonal, 36 * (long) a->total);
  if (status == SD_OK) status = sd_block_cholesky_begin(&t->factor, a->total);
  for (int p = 0; p < a->total && status == SD_OK; p++)
    status = sd_block_cholesky_add(&t->factor, p, p, a->diagonal + 36 * (long) p);
  for (long p = 0; p < sd_tie_bodies(A); p++)
    memcpy(t->scale + 6 * p, a->scale + 6 * (long) t->number[p], 6 * sizeof(double));
  return status;
}

/* A sphere of body p of this rank; arm [3] set by the caller */
static void place_sphere(const sd_tie *t, int p, double place[PLACE])
{
  const double *s = t->scale + 6 * (long) p;
  place[NUMBER] = t->number[p];
  place[SCALES] = fmax(fmax(s[0], s[1]), s[2]);
  place[SCALES + 1] = fmax(fmax(s[3], s[4]), s[5]);
}

/* Where the spheres are in their bodies; of other ranks' too */
static sd_status find_places(const sd_bodies *A, assembly *a)
{
  const sd_lubrication *L = A->tie->L;
  a->place = calloc(PLACE * ((size_t) A->n + 1), sizeof(double));
  a->others = malloc(sizeof(double) * PLACE * ((size_t) (L->n_all - L->n) + 1));
  if (!a->place || !a->others) return SD_ENOMEMORY;
  for (int e = 0; e < A->lone; e++) place_sphere(A->tie, e, a->place + PLACE * (long) A->loner[e]);
  for (int b = 0; b < A->clumps; b++)
    for (int k = 0; k < A->shape[b]->m; k++) {
      const int i = A->member[A->first[b] + k];
      if (i >= A->n) continue;
      place_sphere(A->tie, A->lone + b, a->place + PLACE * (long) i);
      arm_of(A, A->lone + b, k, a->place + PLACE * (long) i + ARM);
    }
  return L->world.refresh && ranks_of(A) > 1
      ? L->world.refresh(L->world.ctx, a->place, a->others, PLACE)
      : SD_OK;
}

/* The square of the norm of a pair's scaled block, if its spheres are free; at least that if they
 * are the middles of clumps */
static double strength(const sd_lubrication_link *l, const double p[2], const double q[2])
{
  const double UU = p[0] * q[0], UW = p[0] * q[1], WU = p[1] * q[0], WW = p[1] * q[1];
  return UU * UU * (l->XA * l->XA + 2.0 * l->YA * l->YA) +
      2.0 * (UW * UW * l->YB21 * l->YB21 + WU * WU * l->YB12 * l->YB12) +
      WW * WW * (l->XC * l->XC + 2.0 * l->YC * l->YC);
}

/* Keeps B, by numbers of bodies: in the factor, or for all ranks. */
static sd_status keep(const sd_bodies *A, assembly *a, int p, int q, const double B[36])
{
  if (ranks_of(A) == 1) return sd_block_cholesky_add(&A->tie->factor, p, q, B);
  double *row = a->rows[a->count++];
  row[0] = p;
  row[1] = q;
  memcpy(row + 2, B, 36 * sizeof(double));
  return SD_OK;
}

/* The blocks of this rank, scaled, those that are not weak. A pair of two ranks is known to both:
 * it is that one's whose own body has the lower number. */
static sd_status find_blocks(const sd_bodies *A, assembly *a)
{
  const sd_lubrication *L = A->tie->L;
  sd_status status = SD_OK;
  if (ranks_of(A) > 1 && !sd_grow(&a->rows, sizeof(*a->rows), (size_t) L->count))
    return SD_ENOMEMORY;
  for (long k = 0; k < L->count && status == SD_OK; k++) {
    const int i = L->pair[k][0], j = L->pair[k][1];
    const double *first = a->place + PLACE * (long) i;
    const double *second = j < A->n ? a->place + PLACE * (long) j
                                    : a->others + PLACE * (long) (j - A->n);
    const int p = (int) first[NUMBER], q = (int) second[NUMBER];
    if (p == q || (j >= A->n && p > q)) continue;
    const int arms = has_arm(first + ARM) || has_arm(second + ARM);
    sd_lubrication_link both = L->link[k];
    both.XA -= L->model[k]; /* L_12 + X_12 */
    if (!arms && strength(&both, first + SCALES, second + SCALES) < weak * weak) continue;
    double B[36], scaled[36] = {0.0}, sum = 0.0;
    sd_lubrication_block(&both, B);
    if (arms) move_to_centres(first + ARM, second + ARM, B);
    add_scaled(B, a->scale + 6 * (long) p, a->scale + 6 * (long) q, scaled);
    for (int e = 0; e < 36; e++) sum += scaled[e] * scaled[e];
    if (sum >= weak * weak) status = keep(A, a, p, q, scaled);
  }
  return status;
}

/* Those of all ranks on each */
static sd_status gather_blocks(const sd_bodies *A, assembly *a)
{
  long before, all;
  if (ranks_of(A) == 1) return SD_OK;
  const size_t row = sizeof(*a->rows);
  sd_status status = share(A, a->count, &before, &all);
  if (status == SD_OK && !sd_grow(&a->rows, row, (size_t) all)) status = SD_ENOMEMORY;
  if (status != SD_OK) return status;
  memmove(a->rows + before, a->rows, row * (size_t) a->count);
  memset(a->rows, 0, row * (size_t) before);
  memset(a->rows + before + a->count, 0, row * (size_t) (all - before - a->count));
  status = sum_over_ranks(A, a->rows[0], (long) (row / sizeof(double)) * all);
  for (long k = 0; k < all && status == SD_OK; k++)
    status = sd_block_cholesky_add(&A->tie->factor, (int) a->rows[k][0], (int) a->rows[k][1],
                                   a->rows[k] + 2);
  return status;
}

sd_status sd_tie_factor(const sd_bodies *A)
{
  assembly a = {0};
  sd_status status = number_bodies(A, &a);
  if (status == SD_OK) status = find_diagonal(A, &a);
  if (status == SD_OK) status = find_places(A, &a);
  if (status == SD_OK) status = find_blocks(A, &a);
  if (status == SD_OK) status = gather_blocks(A, &a);
  if (status == SD_OK) status = sd_block_cholesky_factor(&A->tie->factor, drop);
  double *const arrays[] = {a.diagonal, a.scale, a.place, a.others};
  for (size_t k = 0; k < sizeof(arrays) / sizeof(arrays[0]); k++) free(arrays[k]);
  free(a.rows);
  return status;
}

sd_status sd_tie_precondition(const sd_bodies *A, const double *r, double *z)
{
  const sd_tie *t = A->tie;
  const long bodies = sd_tie_bodies(A), total = t->factor.n;
  memset(t->all, 0, sizeof(double) * 6 * (size_t) total);
  for (long p = 0; p < bodies; p++) {
    if (p >= A->lone && !sd_tie_ours(A, (int) (p - A->lone))) continue;
    for (int d = 0; d < 6; d++)
      t->all[6 * (long) t->number[p] + d] = t->scale[6 * p + d] * r[6 * p + d];
  }
  const sd_status status = sum_over_ranks(A, t->all, 6 * total);
  if (status != SD_OK) return status;
  sd_block_cholesky_apply(&t->factor, t->all);
  for (long p = 0; p < bodies; p++)
    for (int d = 0; d < 6; d++)
      z[6 * p + d] = t->scale[6 * p + d] * t->all[6 * (long) t->number[p] + d];
  return SD_OK;
}
