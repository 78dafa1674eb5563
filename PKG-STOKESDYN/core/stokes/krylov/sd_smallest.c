#include "sd_smallest.h"

#include "sd_linear.h"
#include "sd_system.h"

#include <math.h>
#include <string.h>

/* The vectors of the span, the present v, P times its residual and the last step, and M times
 * each: M v of a combination is the combination of M v, so a step costs one product, that of the
 * new w. */
enum { V, W, P, SPAN };
typedef struct {
  double *x[SPAN], *Mx[SPAN];
} span;

/* W^-1 in row k of sphere i, which is row j */
static double inverse_weight(const sd_system *A, const double *weight, long i, int k, long j)
{
  return 1.0 / (weight ? weight[j] : sd_system_diagonal(A, i, k));
}

/* w = P r, r = M v - mu W^-1 v, at mu = v.Mv; own: r.W r of this rank. Since v.W^-1 v = 1, some
 * eigenvalue lies within sqrt(r.W r) of mu: the residual theorem for W^1/2 M W^1/2, symmetric. */
static sd_status direction(const sd_system *A, const double *weight, double mu, const span *s,
                           double *r, double *own)
{
  const int m = sd_system_width(A);
  const double *v = s->x[V], *Mv = s->Mx[V];
  *own = 0.0;
  for (long i = 0; i < A->n; i++)
    for (int k = 0; k < m; k++) {
      const long j = m * i + k;
      r[j] = 0.0;
      if (A->drag[i] == 0.0) continue;
      const double inverse = inverse_weight(A, weight, i, k, j);
      r[j] = Mv[j] - mu * v[j] * inverse;
      *own += r[j] * r[j] / inverse;
    }
  return sd_system_precondition(A, r, s->x[W]);
}

/* x.Mx and x.W^-1 x of the span, each [SPAN SPAN], and own[0], summed over the ranks. */
static sd_status gram(const sd_system *A, const double *weight, int count, const span *s,
                      double *own, double *M, double *B)
{
  const int m = sd_system_width(A);
  double t[2 * SPAN * SPAN + 1] = {0.0};
  for (long i = 0; i < A->n; i++) {
    if (A->drag[i] == 0.0) continue;
    for (int p = 0; p < m; p++) {
      const long j = m * i + p;
      const double inverse = inverse_weight(A, weight, i, p, j);
      for (int k = 0; k < count; k++)
        for (int l = 0; l <= k; l++) {
          t[SPAN * k + l] += s->x[k][j] * s->Mx[l][j];
          t[SPAN * SPAN + SPAN * k + l] += s->x[k][j] * s->x[l][j] * inverse;
        }
    }
  }
  t[2 * SPAN * SPAN] = *own;
  const sd_status status = sd_system_sum(A, t, 2 * SPAN * SPAN + 1);
  *own = t[2 * SPAN * SPAN];
  for (int k = 0; k < SPAN; k++)
    for (int l = 0; l < SPAN; l++) {
      const int at = k > l ? SPAN * k + l : SPAN * l + k;
      M[SPAN * k + l] = t[at];
      B[SPAN * k + l] = t[SPAN * SPAN + at];
    }
  return status;
}

/* x.B y */
static double form(const double *B, const double *x, const double *y)
{
  double s = 0.0;
  for (int p = 0; p < SPAN; p++)
    for (int q = 0; q < SPAN; q++) s += x[p] * B[SPAN * p + q] * y[q];
  return s;
}

/* Coefficients c of the vector with c.Bc = 1 and the smallest c.Mc, which is returned: Rayleigh
 * and Ritz's method in the span. Vectors that hardly leave the span of those before them are left
 * out: T has the others' B-orthonormal combinations, row by row, by Gram and Schmidt twice, which
 * is enough (Parlett, The Symmetric Eigenvalue Problem, 6.9). With G = T M T^T that is an ordinary
 * problem. */
static double smallest_of_span(int count, const double *M, const double *B, double *c)
{
  double T[SPAN * SPAN] = {0.0}, G[SPAN * SPAN], w[SPAN], E[SPAN * SPAN];
  int m = 0;
  for (int k = 0; k < count; k++) {
    double *t = T + SPAN * m;
    const double own = B[SPAN * k + k];
    if (!(own > 0.0)) continue;
    memset(t, 0, SPAN * sizeof(double));
    t[k] = 1.0 / sqrt(own);
    for (int twice = 0; twice < 2; twice++)
      for (int l = 0; l < m; l++) {
        const double share = form(B, T + SPAN * l, t);
        for (int p = 0; p < SPAN; p++) t[p] -= share * T[SPAN * l + p];
      }
    const double square = form(B, t, t);
    if (!(square > 1e-10)) continue;
    for (int p = 0; p < SPAN; p++) t[p] /= sqrt(square);
    m++;
  }
  for (int k = 0; k < m; k++)
    for (int l = 0; l < m; l++) G[m * k + l] = form(M, T + SPAN * k, T + SPAN * l);
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

/* Each turn: the best combination of the span becomes v, the step to it the new p, P times the
 * residual the new w; then M w, the one product, and the Gram matrices of the new span. */
sd_status sd_smallest_eigenvalue(const sd_system *A, const double *weight, double accuracy,
                                 int max_products, double *v, double *work, double *mu,
                                 int *products)
{
  const int width = sd_system_width(A);
  const long size = (long) width * A->n;
  double *r = work + 5 * size, M[SPAN * SPAN], B[SPAN * SPAN], c[SPAN], own = 0.0;
  const span s = {{v, work, work + size}, {work + 2 * size, work + 3 * size, work + 4 * size}};
  int count = 1;
  *products = 0;
  *mu = 1.0;
  for (long j = 0; j < size; j++)
    if (A->drag[j / width] == 0.0) v[j] = 0.0;
  sd_status status = sd_system_apply(A, v, s.Mx[V]);
  if (status != SD_OK || (status = gram(A, weight, 1, &s, &own, M, B)) != SD_OK) return status;
  *products = 1;
  for (;;) {
    if (!isfinite(M[0]) || !isfinite(B[0])) return SD_ENOTFINITE;
    if (!(B[0] > 0.0)) return SD_OK; /* nobody takes part */
    *mu = smallest_of_span(count, M, B, c);
    step(size, count, c, s.x);
    step(size, count, c, s.Mx);
    if (*mu <= 0.0) return SD_OK;
    if (*products >= max_products) return SD_EMAXITER;
    if ((status = direction(A, weight, *mu, &s, r, &own)) != SD_OK) return status;
    if ((status = sd_system_apply(A, s.x[W], s.Mx[W])) != SD_OK) return status;
    ++*products;
    /* There is no last step before the second. */
    count = *products > 2 ? SPAN : 2;
    if ((status = gram(A, weight, count, &s, &own, M, B)) != SD_OK) return status;
    if (sqrt(own) <= accuracy * *mu) return SD_OK;
  }
}
