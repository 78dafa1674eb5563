#include "sd_pair_resistance.h"

#include <math.h>
#include <string.h>

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

/* Over the largest number of the pair: an eigenvalue that is smaller is rounding, whose root would be 1e-8 of the
 * largest one, of another sign and size wherever the pair is seen from; so may be all of a block. One below the other,
 * of the other sign, is no rounding. */
static const double rounding = 1e-13, negative = -1e-6;

/* The symmetric root of A, 11 12 22: (A + s)/(tr A + 2 s)^1/2, s^2 = det A */
static sd_status root_of_two(const double A[3], double largest, double root[3])
{
  const double mean = 0.5 * (A[0] + A[2]), apart = hypot(0.5 * (A[0] - A[2]), A[1]);
  const double high = mean + apart, low = mean - apart;
  if (low < negative * largest) return SD_EINDEFINITE;
  const double s = low > rounding * largest ? sqrt(low * high) : 0.0, over = sqrt(2.0 * (mean + s));
  for (int e = 0; e < 3; e++) root[e] = high > rounding * largest ? (A[e] + (e == 1 ? 0.0 : s)) / over : 0.0;
  return SD_OK;
}

/* The same of A [4 4], whatever the spheres */
static sd_status root_of_unlike(const double A[16], double largest, double root[16])
{
  double w[4], V[16];
  sd_eigen(4, A, w, V);
  if (w[3] < negative * largest) return SD_EINDEFINITE;
  for (int p = 0; p < 4; p++)
    for (int q = 0; q < 4; q++) {
      root[4 * p + q] = 0.0;
      for (int k = 0; k < 4 && w[k] > rounding * largest; k++)
        root[4 * p + q] += V[4 * p + k] * V[4 * q + k] * sqrt(w[k]);
    }
  return SD_OK;
}

/* Of equal spheres, whose sum of forces goes with their difference of torques and the other way round: two of 2x2.
 * Rows and columns of A are F1 F2 T1 T2. */
static sd_status root_of_equal(const double A[16], double largest, double root[16])
{
  const double with_sum[3] = {A[0] + A[1], A[2] - A[3], A[10] - A[11]};
  const double with_difference[3] = {A[0] - A[1], A[2] + A[3], A[10] + A[11]};
  double s[3], d[3];
  sd_status status = root_of_two(with_sum, largest, s);
  if (status == SD_OK) status = root_of_two(with_difference, largest, d);
  if (status != SD_OK) return status;
  const double ff = 0.5 * (s[0] + d[0]), fg = 0.5 * (s[0] - d[0]), ft = 0.5 * (s[1] + d[1]), fu = 0.5 * (d[1] - s[1]);
  const double tt = 0.5 * (s[2] + d[2]), tu = 0.5 * (d[2] - s[2]);
  const double all[16] = {ff, fg, ft, fu, fg, ff, -fu, -ft, ft, -fu, tt, tu, fu, -ft, tu, tt};
  memcpy(root, all, sizeof(all));
  return SD_OK;
}

/* Are the spheres equal, to rounding beside the largest number? Exchanged they have YB of the other sign. */
static int are_equal(const sd_pair_resistance *S, double largest)
{
  const double off = fmax(fmax(fabs(S->YA[0] - S->YA[2]), fabs(S->YC[0] - S->YC[2])),
                          fmax(fabs(S->YB[0] + S->YB[3]), fabs(S->YB[1] + S->YB[2])));
  return off <= rounding * largest;
}

/* The numbers of X, 11 12 22, along d: from `from`[0] and [1] to F[at] of either sphere */
static sd_status add_along(const double X[3], double largest, const double d[3], const double *from,
                           int at, double F[12])
{
  double root[3];
  const sd_status status = root_of_two(X, largest, root);
  for (int i = 0; i < 2 && status == SD_OK; i++)
    for (int e = 0; e < 3; e++)
      F[6 * i + at + e] += (root[i] * from[0] + root[i + 1] * from[1]) * d[e];
  return status;
}

/* Rows F1 F2 T1 T2 as in sd_pair_resistance.c, where torques are along e x d */
static sd_status add_across(const sd_pair_resistance *S, double largest, const double d[3], double g[4][3],
                            double F[12])
{
  const double *a = S->YA, *b = S->YB, *c = S->YC;
  const double A[16] = {a[0], a[1], b[0], b[2], a[1], a[2], b[1], b[3],
                        b[0], b[1], c[0], c[1], b[2], b[3], c[1], c[2]};
  double root[16];
  const sd_status status = (are_equal(S, largest) ? root_of_equal : root_of_unlike)(A, largest, root);
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
  const double largest = largest_of(&S);
  double along[4], across[4][3], f[12] = {0.0};
  for (int k = 0; k < 4; k++) {
    along[k] = sd_dot(g + 3 * k, d);
    for (int e = 0; e < 3; e++) across[k][e] = g[3 * k + e] - along[k] * d[e];
  }
  sd_status status = add_along(S.XA, largest, d, along, 0, f);
  if (status == SD_OK) status = add_along(S.XC, largest, d, along + 2, 3, f);
  if (status == SD_OK) status = add_across(&S, largest, d, across, f);
  for (int p = 0; p < 12; p++) F[p] += p % 6 < 3 ? f[p] : length * f[p];
  return status;
}
