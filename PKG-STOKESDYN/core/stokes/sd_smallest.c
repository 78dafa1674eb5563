#include "sd_smallest.h"

#include "sd_linear.h"

#include <math.h>
#include <string.h>

/* The vectors of the span and M times each. */
enum { V, W, P, SPAN };
typedef struct {
  double *x[SPAN], *Mx[SPAN];
} span;

static double diagonal(const sd_system *A, long sphere, int p)
{
  return p < 3 ? A->drag[sphere] : A->spin[sphere];
}

static sd_status apply(const sd_system *A, int width, const double *x, double *Mx)
{
  const sd_status status = A->apply(A->apply_ctx, x, Mx);
  if (status != SD_OK) return status;
  for (long i = 0; i < A->n; i++)
    for (int p = 0; p < width; p++) {
      const long j = width * i + p;
      Mx[j] = A->drag[i] == 0.0 ? 0.0 : Mx[j] + x[j] / diagonal(A, i, p);
    }
  return SD_OK;
}

/* w = P r, r = M v - lambda D^-1 v, at lambda = v.Mv; own: r.D r of this rank. */
static sd_status direction(const sd_system *A, int width, double lambda, const span *s, double *r,
                           double *own)
{
  const double *v = s->x[V], *Mv = s->Mx[V];
  double *w = s->x[W];
  *own = 0.0;
  for (long i = 0; i < A->n; i++)
    for (int p = 0; p < width; p++) {
      const long j = width * i + p;
      const double D = diagonal(A, i, p);
      r[j] = A->drag[i] == 0.0 ? 0.0 : Mv[j] - lambda * v[j] / D;
      *own += D * r[j] * r[j];
      if (!A->precondition) w[j] = D * r[j];
    }
  return A->precondition ? A->precondition(A->precondition_ctx, r, w) : SD_OK;
}

/* x.Mx and x.D^-1 x of the span, each [SPAN SPAN], and own[0], summed over the ranks. */
static sd_status gram(const sd_system *A, int width, int count, const span *s, double *own,
                      double *M, double *B)
{
  double t[2 * SPAN * SPAN + 1] = {0.0};
  for (long i = 0; i < A->n; i++) {
    if (A->drag[i] == 0.0) continue;
    for (int p = 0; p < width; p++) {
      const long j = width * i + p;
      const double inverse = 1.0 / diagonal(A, i, p);
      for (int k = 0; k < count; k++)
        for (int l = 0; l <= k; l++) {
          t[SPAN * k + l] += s->x[k][j] * s->Mx[l][j];
          t[SPAN * SPAN + SPAN * k + l] += s->x[k][j] * s->x[l][j] * inverse;
        }
    }
  }
  t[2 * SPAN * SPAN] = *own;
  const sd_status status = A->sum ? A->sum(A->sum_ctx, t, 2 * SPAN * SPAN + 1) : SD_OK;
  *own = t[2 * SPAN * SPAN];
  for (int k = 0; k < SPAN; k++)
    for (int l = 0; l < SPAN; l++) {
      const int at = k > l ? SPAN * k + l : SPAN * l + k;
      M[SPAN * k + l] = t[at];
      B[SPAN * k + l] = t[SPAN * SPAN + at];
    }
  return status;
}

/* Coefficients c of the vector with c.Bc = 1 and the smallest c.Mc, which is returned. Vectors that hardly leave the span of those
 * before them are left out: T has the others' B-orthonormal combinations, row by row. */
static double smallest_of_span(int count, const double *M, const double *B, double *c)
{
  double T[SPAN * SPAN] = {0.0}, G[SPAN * SPAN], w[SPAN], E[SPAN * SPAN];
  int m = 0;
  for (int k = 0; k < count; k++) {
    double *t = T + SPAN * m, square = 0.0;
    const double own = B[SPAN * k + k];
    if (!(own > 0.0)) continue;
    memset(t, 0, SPAN * sizeof(double));
    t[k] = 1.0 / sqrt(own);
    for (int twice = 0; twice < 2; twice++)
      for (int l = 0; l < m; l++) {
        double share = 0.0;
        for (int p = 0; p < SPAN; p++)
          for (int q = 0; q < SPAN; q++) share += T[SPAN * l + p] * B[SPAN * p + q] * t[q];
        for (int p = 0; p < SPAN; p++) t[p] -= share * T[SPAN * l + p];
      }
    for (int p = 0; p < SPAN; p++)
      for (int q = 0; q < SPAN; q++) square += t[p] * B[SPAN * p + q] * t[q];
    if (!(square > 1e-10)) continue;
    for (int p = 0; p < SPAN; p++) t[p] /= sqrt(square);
    m++;
  }
  for (int k = 0; k < m; k++)
    for (int l = 0; l < m; l++) {
      double g = 0.0;
      for (int p = 0; p < SPAN; p++)
        for (int q = 0; q < SPAN; q++) g += T[SPAN * k + p] * M[SPAN * p + q] * T[SPAN * l + q];
      G[m * k + l] = g;
    }
  sd_eigen(m, G, w, E);
  for (int p = 0; p < SPAN; p++) {
    c[p] = 0.0;
    for (int k = 0; k < m; k++) c[p] += E[m * k + m - 1] * T[SPAN * k + p];
  }
  return w[m - 1];
}

/* v = c.x and p = v without its share of the old v */
static void step(long size, int count, const double *c, double *const *x)
{
  for (long j = 0; j < size; j++) {
    double p = 0.0;
    for (int k = 1; k < count; k++) p += c[k] * x[k][j];
    x[V][j] = c[V] * x[V][j] + p;
    x[P][j] = p;
  }
}

sd_status sd_smallest_eigenvalue(const sd_system *A, double accuracy, int max_products, double *v,
                                 double *work, double *lambda, int *products)
{
  const int width = A->spin ? 6 : 3;
  const long size = (long) width * A->n;
  double *r = work + 5 * size, M[SPAN * SPAN], B[SPAN * SPAN], c[SPAN], own = 0.0;
  const span s = {{v, work, work + size}, {work + 2 * size, work + 3 * size, work + 4 * size}};
  int count = 1;
  for (long j = 0; j < size; j++)
    if (A->drag[j / width] == 0.0) v[j] = 0.0;
  *products = 0;
  *lambda = 1.0;
  sd_status status = apply(A, width, v, s.Mx[V]);
  if (status != SD_OK || (status = gram(A, width, 1, &s, &own, M, B)) != SD_OK) return status;
  *products = 1;
  for (;;) {
    if (!isfinite(M[0]) || !isfinite(B[0])) return SD_ENOTFINITE;
    if (!(B[0] > 0.0)) return SD_OK; /* nobody takes part */
    *lambda = smallest_of_span(count, M, B, c);
    step(size, count, c, s.x);
    step(size, count, c, s.Mx);
    if (*lambda <= 0.0) return SD_OK;
    if (*products >= max_products) return SD_EMAXITER;
    if ((status = direction(A, width, *lambda, &s, r, &own)) != SD_OK) return status;
    if ((status = apply(A, width, s.x[W], s.Mx[W])) != SD_OK) return status;
    ++*products;
    count = *products > 2 ? SPAN : 2;
    if ((status = gram(A, width, count, &s, &own, M, B)) != SD_OK) return status;
    if (sqrt(own) <= accuracy * *lambda) return SD_OK;
  }
}
