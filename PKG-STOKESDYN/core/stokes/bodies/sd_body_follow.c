#include "sd_body_follow.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_linear.h"

void sd_body_follow_free(sd_body_follow *f)
{
  free(f->A);
  free(f->slip);
  *f = (sd_body_follow){0};
}

/* Row i of K: number i % width of point i / width from (U, W) */
static void follow_rigid_row(const sd_body_shape *s, int i, double row[6])
{
  const int d = i % s->width;
  memset(row, 0, 6 * sizeof(double));
  row[d] = 1.0;
  if (d >= 3) return;
  const double e[3] = {d == 0, d == 1, d == 2};
  sd_cross(s->x + 3 * (long) (i / s->width), e, row + 3);
}

/* A sphere whose points do not turn */
static void take_mean(const sd_body_shape *s, sd_body_follow *out)
{
  double square[36] = {0.0}, inverse[36], K[6];
  for (int i = 0; i < out->n; i++) {
    follow_rigid_row(s, i, K);
    for (int e = 0; e < 36; e++) square[e] += K[e / 6] * K[e % 6];
  }
  sd_pseudo_inverse6(square, inverse);
  for (int i = 0; i < out->n; i++) {
    follow_rigid_row(s, i, K);
    for (int c = 0; c < 6; c++)
      for (int p = 0; p < 6; p++) out->A[6 * (long) i + c] += K[p] * inverse[6 * p + c];
  }
  out->exact = 1;
}

/* --- the conditions --- */

/* Row z of condition k has at most two terms, coefficient times
 *   of_body   sum over i of K[i][g] A[i][h]                     k < 36: K^T A
 *   else      sum over c of K[first of point + g][c] A[i][c]    i: number h of a force or torque of the
 *                                                               point: element gh of K_b A_b^T */
typedef struct {
  int of_body, g, h, first, i;
  double coefficient;
} term;

enum { OF_BODY = 36, OF_PART = 8 };

static int conditions(const sd_body_shape *s)
{
  return OF_BODY + OF_PART * s->m * (s->width / 3);
}

/* Returns how many terms */
static int condition(const sd_body_shape *s, int k, term t[2])
{
  static const int row[OF_PART] = {0, 0, 1, 1, 2, 2, 0, 1}, column[OF_PART] = {1, 2, 0, 2, 0, 1, 0, 1};
  if (k < OF_BODY) {
    t[0] = (term){.of_body = 1, .g = k / 6, .h = k % 6, .coefficient = 1.0};
    return 1;
  }
  const int part = (k - OF_BODY) / OF_PART, which = (k - OF_BODY) % OF_PART, parts = s->width / 3;
  const int first = s->width * (part / parts), at = first + 3 * (part % parts);
  t[0] = (term){0, row[which], column[which], first, at + column[which], 1.0};
  if (which < 6) return 1;
  t[1] = (term){0, which - 5, which - 5, first, at + which - 5, -1.0};
  return 2;
}

/* What column c counts, the mean of N's diagonal over its translations or rotations: the same in all axes */
static double weight_of(const sd_body_shape *s, int c)
{
  const double *N = s->mobility;
  return c < 3 ? (N[0] + N[7] + N[14]) / 3.0 : (N[21] + N[28] + N[35]) / 3.0;
}

/* z H^-1 z'^T of two terms, H^-1 = weight_of(c) M_b'^-1 in column c */
static double follow_meet(const sd_body_shape *s, const term *a, const term *b)
{
  const long n = (long) s->width * s->m;
  double K[6], other[6], sum = 0.0;
  if (a->of_body && b->of_body)
    return a->h == b->h ? weight_of(s, a->h) * s->resistance[6 * a->g + b->g] : 0.0;
  if (b->of_body) return follow_meet(s, b, a);
  follow_rigid_row(s, b->first + b->g, K);
  if (a->of_body) return weight_of(s, a->h) * K[a->h] * s->rigid[6 * (long) b->i + a->g];
  follow_rigid_row(s, a->first + a->g, other);
  for (int c = 0; c < 6; c++) sum += weight_of(s, c) * K[c] * other[c];
  return sum * s->inverse[n * a->i + b->i];
}

static double meet_all(const sd_body_shape *s, int k, int l)
{
  term a[2], b[2];
  const int of_k = condition(s, k, a), of_l = condition(s, l, b);
  double sum = 0.0;
  for (int p = 0; p < of_k; p++)
    for (int q = 0; q < of_l; q++) sum += a[p].coefficient * b[q].coefficient * follow_meet(s, a + p, b + q);
  return sum;
}

/* y = G x */
static void follow_multiply(int n, const double *G, const double *x, double *y)
{
  for (int p = 0; p < n; p++) {
    y[p] = 0.0;
    for (int q = 0; q < n; q++) y[p] += G[(long) n * p + q] * x[q];
  }
}

/* G x = b, where some conditions may follow from others: by a factor of G + ridge, whose error the same
 * factor takes out again. wrong: what is left of b. work [2 n + n^2] */
static sd_status solve_conditions(int n, const double *G, const double *b, double *x, double *work,
                                  double *wrong)
{
  const double ridge = 1e-10;
  double *factor = work, *left = factor + (size_t) n * (size_t) n, *Gx = left + n;
  memcpy(factor, G, sizeof(double) * (size_t) n * (size_t) n);
  for (int p = 0; p < n; p++) factor[(long) (n + 1) * p] += ridge;
  const sd_status status = sd_cholesky(n, factor);
  memset(x, 0, sizeof(double) * (size_t) n);
  for (int pass = 0; pass < 6 && status == SD_OK; pass++) {
    follow_multiply(n, G, x, Gx);
    *wrong = 0.0;
    for (int p = 0; p < n; p++) {
      left[p] = b[p] - Gx[p];
      *wrong = fmax(*wrong, fabs(left[p]));
    }
    sd_cholesky_apply(n, factor, 1, left);
    for (int p = 0; p < n && pass < 5; p++) x[p] += left[p];
  }
  return status;
}

/* A_c = weight_of(c) M_b'^-1 (sum of multipliers times conditions); work [6 n] */
static void follow_combine(const sd_body_shape *s, const double *multiplier, double *work, double *A)
{
  const int n = s->width * s->m;
  memset(work, 0, sizeof(double) * 6 * (size_t) n);
  for (int k = 0; k < conditions(s); k++) {
    term t[2];
    double K[6];
    const int terms = condition(s, k, t);
    for (int p = 0; p < terms; p++) {
      const double by = multiplier[k] * t[p].coefficient;
      for (int i = 0; i < n && t[p].of_body; i++) {
        follow_rigid_row(s, i, K);
        work[6 * (long) i + t[p].h] += by * K[t[p].g];
      }
      if (t[p].of_body) continue;
      follow_rigid_row(s, t[p].first + t[p].g, K);
      for (int c = 0; c < 6; c++) work[6 * (long) t[p].i + c] += by * K[c];
    }
  }
  memset(A, 0, sizeof(double) * 6 * (size_t) n);
  for (long i = 0; i < n; i++)
    for (long j = 0; j < n; j++)
      for (int c = 0; c < 6; c++)
        A[6 * i + c] += weight_of(s, c) * s->inverse[n * i + j] * work[6 * j + c];
}

/* *wrong: the largest error of a condition, each over the root of its own H */
static sd_status design(const sd_body_shape *s, double *A, double *wrong)
{
  const int n = conditions(s);
  const size_t square = (size_t) n * (size_t) n, own = 6 * (size_t) (s->width * s->m);
  double *G = malloc(sizeof(double) * (2 * square + 5 * (size_t) n + own));
  if (!G) return SD_ENOMEMORY;
  double *work = G + square, *x = work + square + 2 * (size_t) n, *b = x + n, *scale = b + n;
  for (int k = 0; k < n; k++) {
    const double itself = meet_all(s, k, k);
    scale[k] = itself > 0.0 ? 1.0 / sqrt(itself) : 1.0;
    b[k] = k < OF_BODY && k / 6 == k % 6 ? scale[k] : 0.0;
  }
  for (int k = 0; k < n; k++)
    for (int l = 0; l <= k; l++)
      G[(long) n * k + l] = G[(long) n * l + k] = scale[k] * scale[l] * meet_all(s, k, l);
  const sd_status status = solve_conditions(n, G, b, x, work, wrong);
  for (int k = 0; k < n; k++) x[k] *= scale[k];
  if (status == SD_OK) follow_combine(s, x, scale + n, A);
  free(G);
  return status;
}

/* --- what is left of the body's own --- */

/* out += sign e_q x (M v), or M (e_q x v), of all vectors of the rows; turned [n]: scratch */
static void add_turned(const sd_body_shape *s, const double *M, int q, const double *v, double *turned,
                       double *out)
{
  const int n = s->width * s->m;
  const double e[3] = {q == 0, q == 1, q == 2};
  for (int i = 0; i < n; i += 3) sd_cross(e, v + i, turned + i);
  for (long i = 0; i < n; i += 3) {
    double Mv[3] = {0.0}, w[3];
    for (int d = 0; d < 3; d++)
      for (int j = 0; j < n; j++) {
        Mv[d] += M[n * (i + d) + j] * v[j];
        out[i + d] -= M[n * (i + d) + j] * turned[j];
      }
    sd_cross(e, Mv, w);
    for (int d = 0; d < 3; d++) out[i + d] += w[d];
  }
}

static sd_status find_own(const sd_body_shape *s, sd_body_follow *f)
{
  const size_t n = (size_t) f->n;
  double *M = malloc(sizeof(double) * (n * n + 2 * n)), *column = M + n * n, *turned = column + n;
  f->slip = calloc(n, sizeof(double));
  if (!M || !f->slip) {
    free(M);
    return SD_ENOMEMORY;
  }
  memcpy(M, s->inverse, sizeof(double) * n * n);
  const sd_status status = sd_inverse((int) n, M);
  for (int q = 0; q < 3 && status == SD_OK; q++) {
    const double e[3] = {q == 0, q == 1, q == 2};
    for (size_t i = 0; i < n; i++) column[i] = f->A[6 * i + 3 + (size_t) q];
    add_turned(s, M, q, column, turned, f->slip);
    for (int b = 0; b < s->m; b++) {
      double there[3], couple[3];
      sd_cross(e, s->x + 3 * b, there);
      sd_cross(there, column + (long) s->width * b, couple);
      for (int d = 0; d < 3; d++) f->torque[d] += couple[d];
    }
  }
  free(M);
  return status;
}

/* Conditions are met to rounding, or not at all. */
static const double MET = 1e-7;

/* A body that turns with its points, or in another way: M_b'^-1 K N */
static sd_status follow_turning(const sd_body_shape *s, sd_body_follow *out)
{
  double wrong = INFINITY;
  if (s->turns == SD_BODY_ALONG && s->inverse && out->n <= SD_BODY_FOLLOW_MOST) {
    const sd_status status = design(s, out->A, &wrong);
    if (status != SD_OK && status != SD_ESINGULAR) return status;
  }
  if (wrong < MET) {
    out->exact = 1;
    return find_own(s, out);
  }
  for (long i = 0; i < out->n; i++)
    for (int c = 0; c < 6; c++) {
      out->A[6 * i + c] = 0.0;
      for (int p = 0; p < 6; p++) out->A[6 * i + c] += s->rigid[6 * i + p] * s->mobility[6 * p + c];
    }
  return SD_OK;
}

sd_status sd_body_follow_create(const sd_body_shape *s, sd_body_follow *out)
{
  sd_status status = SD_OK;
  *out = (sd_body_follow){.n = s->width * s->m};
  out->A = calloc(6 * (size_t) out->n, sizeof(double));
  if (!out->A)
    status = SD_ENOMEMORY;
  else if (s->turns == SD_BODY_STILL)
    take_mean(s, out);
  else
    status = follow_turning(s, out);
  if (status != SD_OK) sd_body_follow_free(out);
  return status;
}
