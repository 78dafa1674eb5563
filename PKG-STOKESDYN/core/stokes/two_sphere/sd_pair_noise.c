#include "sd_pair_resistance.h"

#include <math.h>

#include "sd_linear.h"

/* Torques over the length: all numbers of the pair are comparable then. */
static sd_pair_resistance over_length(const sd_pair_resistance *R, double length)
{
  sd_pair_resistance S = *R;
  for (int k = 0; k < 4; k++) S.YB[k] /= length;
  for (int k = 0; k < 3; k++) {
    S.XC[k] /= length * length;
    S.YC[k] /= length * length;
  }
  return S;
}

static double largest_of(const sd_pair_resistance *S)
{
  double most = 0.0;
  for (int k = 0; k < 3; k++)
    most = fmax(most, fmax(fmax(fabs(S->XA[k]), fabs(S->YA[k])),
                           fmax(fabs(S->XC[k]), fabs(S->YC[k]))));
  return most;
}

/* The symmetric root of A [n n], n <= 4; what is above least <= 0 counts as 0 */
static sd_status pair_take_root(int n, const double *A, double least, double *root)
{
  double w[4], V[16];
  sd_eigen(n, A, w, V);
  if (w[n - 1] < least) return SD_EINDEFINITE;
  for (int p = 0; p < n; p++)
    for (int q = 0; q < n; q++) {
      root[n * p + q] = 0.0;
      for (int k = 0; k < n; k++)
        root[n * p + q] += V[n * p + k] * V[n * q + k] * sqrt(fmax(w[k], 0.0));
    }
  return SD_OK;
}

/* The numbers of X, 11 12 22, along d: from `from`[0] and [1] to F[at] of either sphere */
static sd_status add_along(const double X[3], double least, const double d[3], const double *from,
                           int at, double F[12])
{
  const double A[4] = {X[0], X[1], X[1], X[2]};
  double root[4];
  const sd_status status = pair_take_root(2, A, least, root);
  for (int i = 0; i < 2 && status == SD_OK; i++)
    for (int e = 0; e < 3; e++)
      F[6 * i + at + e] += (root[2 * i] * from[0] + root[2 * i + 1] * from[1]) * d[e];
  return status;
}

/* Rows F1 F2 T1 T2 as in sd_pair_resistance.c, where torques are along e x d */
static sd_status add_across(const sd_pair_resistance *S, double least, const double d[3],
                            double g[4][3], double F[12])
{
  const double *a = S->YA, *b = S->YB, *c = S->YC;
  const double A[16] = {a[0], a[1], b[0], b[2], a[1], a[2], b[1], b[3],
                        b[0], b[1], c[0], c[1], b[2], b[3], c[1], c[2]};
  double root[16];
  const sd_status status = pair_take_root(4, A, least, root);
  for (int p = 0; p < 4 && status == SD_OK; p++) {
    double sum[3] = {0.0}, turned[3], *to = F + 6 * (p % 2) + 3 * (p / 2);
    for (int k = 0; k < 4; k++)
      for (int e = 0; e < 3; e++) sum[e] += root[4 * p + k] * g[k][e];
    sd_cross(sum, d, turned);
    for (int e = 0; e < 3; e++) to[e] += p < 2 ? sum[e] : turned[e];
  }
  return status;
}

sd_status sd_pair_noise(const sd_pair_resistance *R, const double d[3], double length,
                        const double g[12], double F[12])
{
  const sd_pair_resistance S = over_length(R, length);
  const double least = -1e-6 * largest_of(&S);
  double along[4], across[4][3], f[12] = {0.0};
  for (int k = 0; k < 4; k++) {
    along[k] = sd_dot(g + 3 * k, d);
    for (int e = 0; e < 3; e++) across[k][e] = g[3 * k + e] - along[k] * d[e];
  }
  sd_status status = add_along(S.XA, least, d, along, 0, f);
  if (status == SD_OK) status = add_along(S.XC, least, d, along + 2, 3, f);
  if (status == SD_OK) status = add_across(&S, least, d, across, f);
  for (int p = 0; p < 12; p++) F[p] += p % 6 < 3 ? f[p] : length * f[p];
  return status;
}
