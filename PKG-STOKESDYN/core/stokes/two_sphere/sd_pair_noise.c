#include "sd_pair_noise.h"

#include <math.h>

#include "sd_linear.h"

/* The symmetric root of A [n n], n <= 4 */
static sd_status take_root(int n, const double *A, double *root)
{
  double w[4], V[16];
  sd_eigen(n, A, w, V);
  if (w[n - 1] < -1e-6 * fmax(w[0], -w[n - 1])) return SD_EINDEFINITE;
  for (int p = 0; p < n; p++)
    for (int q = 0; q < n; q++) {
      root[n * p + q] = 0.0;
      for (int k = 0; k < n; k++)
        root[n * p + q] += V[n * p + k] * V[n * q + k] * sqrt(fmax(w[k], 0.0));
    }
  return SD_OK;
}

/* The numbers of X, 11 12 22, along d: from `from`[0] and [1] to F[at] of either sphere */
static sd_status add_along(const double X[3], const double d[3], const double *from, int at,
                           double F[12])
{
  const double A[4] = {X[0], X[1], X[1], X[2]};
  double root[4];
  const sd_status status = take_root(2, A, root);
  for (int i = 0; i < 2 && status == SD_OK; i++)
    for (int e = 0; e < 3; e++)
      F[6 * i + at + e] += (root[2 * i] * from[0] + root[2 * i + 1] * from[1]) * d[e];
  return status;
}

/* Rows F1 F2 T1 T2 as in sd_pair_resistance.c, where torques are along e x d. Over a length of the pair
 * they are comparable to forces: else they may be rounding beside these, in units in which the spheres
 * are small. */
static sd_status add_across(const sd_pair_resistance *R, const double d[3], double g[4][3],
                            double F[12])
{
  const double *a = R->YA, forces = a[0] + a[2], torques = R->YC[0] + R->YC[2];
  const double length = forces > 0.0 && torques > 0.0 ? sqrt(torques / forces) : 1.0;
  double b[4], c[3];
  for (int k = 0; k < 4; k++) b[k] = R->YB[k] / length;
  for (int k = 0; k < 3; k++) c[k] = R->YC[k] / (length * length);
  const double A[16] = {a[0], a[1], b[0], b[2], a[1], a[2], b[1], b[3],
                        b[0], b[1], c[0], c[1], b[2], b[3], c[1], c[2]};
  double root[16];
  const sd_status status = take_root(4, A, root);
  for (int p = 0; p < 4 && status == SD_OK; p++) {
    double sum[3] = {0.0}, turned[3], *to = F + 6 * (p % 2) + 3 * (p / 2);
    for (int k = 0; k < 4; k++)
      for (int e = 0; e < 3; e++) sum[e] += root[4 * p + k] * g[k][e];
    sd_cross(sum, d, turned);
    for (int e = 0; e < 3; e++) to[e] += p < 2 ? sum[e] : length * turned[e];
  }
  return status;
}

sd_status sd_pair_noise(const sd_pair_resistance *R, const double d[3], const double g[12],
                        double F[12])
{
  double along[4], across[4][3];
  for (int k = 0; k < 4; k++) {
    along[k] = sd_dot(g + 3 * k, d);
    for (int e = 0; e < 3; e++) across[k][e] = g[3 * k + e] - along[k] * d[e];
  }
  sd_status status = add_along(R->XA, d, along, 0, F);
  if (status == SD_OK) status = add_along(R->XC, d, along + 2, 3, F);
  return status == SD_OK ? add_across(R, d, across, F) : status;
}
