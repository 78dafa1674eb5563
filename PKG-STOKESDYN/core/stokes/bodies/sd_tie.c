#include "sd_tie.h"

#include "sd_bodies_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* In units of the drags of the bodies: pairs whose block is smaller are left out of the factor, as
 * is such fill. */
static const double weak = 0.4, drop = 0.1;
enum { MOST_PRODUCTS = 1000, VECTORS = 4 };

static long bodies_of(const sd_bodies *A)
{
  return (long) A->lone + A->clumps;
}

/* A clump of several ranks is in sums and in the factor of the one that has its first sphere. */
static int ours(const sd_bodies *A, int b)
{
  return A->member[A->first[b]] < A->n;
}

static sd_status reserve(double **array, long *most, long wanted, int numbers)
{
  if (wanted < *most) return SD_OK;
  double *larger = realloc(*array, sizeof(double) * (size_t) numbers * (size_t) (wanted + 1));
  if (!larger) return SD_ENOMEMORY;
  *array = larger;
  *most = wanted + 1;
  return SD_OK;
}

static sd_status reserve_all(const sd_bodies *A)
{
  sd_tie *t = A->tie;
  const long bodies = bodies_of(A), pairs = t->L->count;
  long most = t->most_bodies;
  sd_status status = reserve(&t->scale, &most, bodies, 6);
  if (status == SD_OK) status = reserve(&t->vectors, &t->most_bodies, bodies, 6 * VECTORS);
  /* as wide as L_ii */
  if (status == SD_OK) status = reserve(&t->ghosts, &t->most_ghosts, A->ghosts, 36);
  if (status == SD_OK && (A->n >= t->most_rows)) {
    status = reserve(&t->rows, &t->most_rows, A->n, 12);
    int *body = realloc(t->body, sizeof(int) * (size_t) (A->n + 1));
    if (body) t->body = body;
    int *place = realloc(t->place, sizeof(int) * (size_t) (A->n + 1));
    if (place) t->place = place;
    if (!body || !place) status = SD_ENOMEMORY;
  }
  if (status == SD_OK && pairs >= t->most_pairs) {
    int(*pair)[2] = realloc(t->pair, sizeof(*pair) * (size_t) (pairs + 1));
    if (pair) t->pair = pair;
    status = pair ? reserve(&t->block, &t->most_pairs, pairs, 36) : SD_ENOMEMORY;
  }
  return status;
}

/* --- K, by numbers of bodies --- */

static sd_status spread(const sd_bodies *A, const double *V, double *rows)
{
  for (int e = 0; e < A->lone; e++)
    memcpy(rows + 6 * (long) A->loner[e], V + 6 * (long) e, 6 * sizeof(double));
  for (int b = 0; b < A->clumps; b++) {
    double in_shape[6];
    for (int k = A->first[b]; k < A->first[b + 1]; k++)
      if (A->member[k] < A->n) memset(rows + 6 * (long) A->member[k], 0, 6 * sizeof(double));
    sd_bodies_to_shape(A->pose + 9 * (long) b, V + 6 * (long) (A->lone + b), in_shape);
    sd_bodies_add_rigid(A, b, in_shape, rows);
  }
  return SD_OK;
}

static sd_status collect(const sd_bodies *A, const double *rows, double *f)
{
  for (int e = 0; e < A->lone; e++)
    memcpy(f + 6 * (long) e, rows + 6 * (long) A->loner[e], 6 * sizeof(double));
  return sd_bodies_onto_clumps(A, rows, A->tie->ghosts, f + 6 * (long) A->lone);
}

/* out = H_0 V */
static void resist_alone(const sd_bodies *A, const double *V, double *out)
{
  for (int e = 0; e < A->lone; e++)
    for (int d = 0; d < 6; d++)
      out[6 * (long) e + d] = (d < 3 ? A->drag : A->spin)[A->loner[e]] * V[6 * (long) e + d];
  for (int b = 0; b < A->clumps; b++) {
    const double *R = A->pose + 9 * (long) b;
    double v[6], f[6], *to = out + 6 * (long) (A->lone + b);
    sd_bodies_to_shape(R, V + 6 * (long) (A->lone + b), v);
    sd_bodies_multiply6(A->shape[b]->resistance, v, f);
    sd_bodies_to_space(R, f, to);
    for (int d = 0; d < 6; d++) to[d] *= A->eta[b];
  }
}

/* out = K^T L K V */
static sd_status apply(const sd_bodies *A, const double *V, double *out)
{
  sd_tie *t = A->tie;
  double *v = t->rows, *f = v + 6 * (long) A->n;
  sd_status status = spread(A, V, v);
  if (status == SD_OK) status = sd_lubrication_apply(t->L, v, f);
  t->products++;
  return status == SD_OK ? collect(A, f, out) : status;
}

/* sums[k] = a[k].b[k] over all bodies, each once */
static sd_status dots(const sd_bodies *A, int count, const double *const *a, const double *const *b,
                      double *sums)
{
  for (int k = 0; k < count; k++) {
    sums[k] = 0.0;
    for (long j = 0; j < 6 * (long) A->lone; j++) sums[k] += a[k][j] * b[k][j];
    for (int c = 0; c < A->clumps; c++)
      for (long d = 0; d < 6 && ours(A, c); d++) {
        const long j = 6 * (long) (A->lone + c) + d;
        sums[k] += a[k][j] * b[k][j];
      }
  }
  return A->sum ? A->sum(A->sum_ctx, sums, count) : SD_OK;
}

/* --- the factor --- */

/* Which body a row belongs to (-1: another rank's, or none), and where in it */
static void find_bodies(const sd_bodies *A)
{
  sd_tie *t = A->tie;
  for (int i = 0; i < A->n; i++) t->body[i] = -1;
  for (int e = 0; e < A->lone; e++) t->body[A->loner[e]] = e;
  for (int b = 0; b < A->clumps; b++)
    for (int k = A->first[b]; k < A->first[b + 1]; k++)
      if (A->member[k] < A->n && ours(A, b)) {
        t->body[A->member[k]] = A->lone + b;
        t->place[A->member[k]] = k - A->first[b];
      }
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

/* A body that nobody is near to: scale 0 takes it out of the system, where it has V = V_0 exactly. */
static void leave_out(double scale[6], double diagonal[36])
{
  for (int d = 0; d < 6; d++) {
    scale[d] = 0.0;
    diagonal[7 * d] = 1.0;
  }
}

/* Diagonal blocks of H, scaled; sets the scale. Of clumps every sphere counts, of whatever rank. */
static sd_status make_diagonal(const sd_bodies *A, double *diagonal)
{
  const sd_tie *t = A->tie;
  const double *L = t->L->diagonal;
  const int across = A->refresh != NULL;
  const sd_status status = across ? A->refresh(A->refresh_ctx, L, t->ghosts, 36) : SD_OK;
  if (status != SD_OK) return status;
  memset(diagonal, 0, sizeof(double) * 36 * (size_t) bodies_of(A));
  for (int e = 0; e < A->lone; e++) {
    const int i = A->loner[e];
    double *scale = t->scale + 6 * (long) e, *out = diagonal + 36 * (long) e;
    for (int d = 0; d < 6; d++) scale[d] = 1.0 / sqrt((d < 3 ? A->drag : A->spin)[i]);
    add_scaled(L + 36 * (long) i, scale, scale, out);
    if (is_zero(out))
      leave_out(scale, out);
    else
      for (int d = 0; d < 6; d++) out[7 * d] += 1.0;
  }
  for (int b = 0; b < A->clumps; b++) {
    double H[36], *scale = t->scale + 6 * (long) (A->lone + b);
    double *out = diagonal + 36 * (long) (A->lone + b);
    int near = 0;
    own_block(A, b, H);
    for (int d = 0; d < 6; d++) scale[d] = 1.0 / sqrt(H[7 * d]);
    for (int k = 0; k < A->shape[b]->m; k++) {
      const int j = A->member[A->first[b] + k];
      double B[36], r[3];
      memcpy(B, j < A->n ? L + 36 * (long) j : t->ghosts + 36 * (long) (j - A->n), sizeof(B));
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
  return SD_OK;
}

/* Blocks between bodies of this rank, scaled, those that are not weak */
static long make_blocks(const sd_bodies *A)
{
  sd_tie *t = A->tie;
  long count = 0;
  for (long k = 0; k < t->L->count; k++) {
    const int i = t->L->pair[k][0], j = t->L->pair[k][1];
    const int p = t->body[i], q = j < A->n ? t->body[j] : -1;
    if (p < 0 || q < 0 || p == q) continue;
    double B[36], rp[3], rq[3], *out = t->block + 36 * count, sum = 0.0;
    memcpy(B, t->L->block + 36 * k, sizeof(B));
    if (p >= A->lone || q >= A->lone) {
      arm_of(A, p, t->place[i], rp);
      arm_of(A, q, t->place[j], rq);
      move_to_centres(rp, rq, B);
    }
    memset(out, 0, 36 * sizeof(double));
    add_scaled(B, t->scale + 6 * (long) p, t->scale + 6 * (long) q, out);
    for (int e = 0; e < 36; e++) sum += out[e] * out[e];
    if (sum < weak * weak) continue;
    t->pair[count][0] = p;
    t->pair[count++][1] = q;
  }
  return count;
}

sd_status sd_tie_make(const sd_bodies *A)
{
  sd_tie *t = A->tie;
  t->products = 0;
  double *diagonal = malloc(sizeof(double) * 36 * (size_t) (bodies_of(A) + 1));
  sd_status status = diagonal ? reserve_all(A) : SD_ENOMEMORY;
  if (status == SD_OK) status = make_diagonal(A, diagonal);
  if (status == SD_OK) {
    find_bodies(A);
    const long count = make_blocks(A);
    status = sd_block_cholesky_make(&t->factor, (int) bodies_of(A), diagonal, count,
                                    (const int(*)[2]) t->pair, t->block, drop);
  }
  free(diagonal);
  return status;
}

/* z = P^-1 r; clumps that other ranks have in their factor get theirs from there. */
static sd_status precondition(const sd_bodies *A, const double *r, double *z)
{
  const sd_tie *t = A->tie;
  const long size = 6 * bodies_of(A);
  for (long j = 0; j < size; j++) z[j] = t->scale[j] * r[j];
  sd_block_cholesky_apply(&t->factor, z);
  for (long j = 0; j < size; j++) z[j] *= t->scale[j];
  if (!A->refresh) return SD_OK;
  memset(t->rows, 0, sizeof(double) * 6 * (size_t) A->n);
  for (int b = 0; b < A->clumps; b++)
    if (ours(A, b))
      memcpy(t->rows + 6 * (long) A->member[A->first[b]], z + 6 * (long) (A->lone + b),
             6 * sizeof(double));
  const sd_status status = sd_bodies_refresh(A, t->rows, t->ghosts);
  for (int b = 0; b < A->clumps && status == SD_OK; b++)
    if (!ours(A, b))
      memcpy(z + 6 * (long) (A->lone + b), sd_bodies_row(A, t->rows, t->ghosts, b, 0),
             6 * sizeof(double));
  return status;
}

/* --- conjugate gradients --- */

/* r, z, p, w as ever: one step along p; w holds K^T L K p, z H_0 p */
static sd_status step(const sd_bodies *A, double rz, double *V, double *LV)
{
  const sd_tie *t = A->tie;
  const long size = 6 * bodies_of(A);
  double *r = t->vectors, *z = r + size, *p = z + size, *w = p + size, sums[2];
  sd_status status = apply(A, p, w);
  if (status != SD_OK) return status;
  resist_alone(A, p, z);
  status = dots(A, 2, (const double *[]){p, p}, (const double *[]){w, z}, sums);
  if (status != SD_OK) return status;
  const double pHp = sums[0] + sums[1], alpha = rz / pHp;
  if (!(pHp > 0.0)) return isfinite(pHp) ? SD_EINDEFINITE : SD_ENOTFINITE;
  for (long j = 0; j < size; j++) {
    V[j] += alpha * p[j];
    LV[j] += alpha * w[j];
    r[j] -= alpha * (w[j] + z[j]);
  }
  return SD_OK;
}

/* From V = 0. LV follows V by the same steps, so that it needs no product of its own. */
sd_status sd_tie_solve(const sd_bodies *A, const double *V_0, double tolerance, double *V,
                       double *LV)
{
  const sd_tie *t = A->tie;
  const long size = 6 * bodies_of(A);
  double *r = t->vectors, *z = r + size, *p = z + size, rz, before = 1.0, enough = 0.0;
  memset(V, 0, sizeof(double) * (size_t) size);
  memset(LV, 0, sizeof(double) * (size_t) size);
  memset(p, 0, sizeof(double) * (size_t) size);
  resist_alone(A, V_0, r);
  for (int k = 0;; k++) {
    sd_status status = precondition(A, r, z);
    if (status == SD_OK) status = dots(A, 1, (const double *[]){r}, (const double *[]){z}, &rz);
    if (status != SD_OK) return status;
    if (!isfinite(rz)) return SD_ENOTFINITE;
    if (k == 0) enough = tolerance * tolerance * rz;
    if (rz <= enough) break;
    if (k == MOST_PRODUCTS) return SD_EMAXITER;
    for (long j = 0; j < size; j++) p[j] = z[j] + rz / before * p[j];
    before = rz;
    if ((status = step(A, rz, V, LV)) != SD_OK) return status;
  }
  for (long j = 0; j < size; j++)
    if (t->scale[j] == 0.0) V[j] = V_0[j];
  return SD_OK;
}

void sd_tie_free(sd_tie *t)
{
  sd_block_cholesky_free(&t->factor);
  free(t->scale);
  free(t->vectors);
  free(t->rows);
  free(t->ghosts);
  free(t->block);
  free(t->pair);
  free(t->body);
  free(t->place);
  *t = (sd_tie){0};
}
