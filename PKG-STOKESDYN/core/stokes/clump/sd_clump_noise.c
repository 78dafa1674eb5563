#include "sd_clump_noise.h"

#include "sd_linear.h"

#include <math.h>
#include <string.h>

/* N about the point d from the one that it is about: U_d = U + W x d, T = T_d + d x F, so that
 * N_d = S N S^T with -[d] beside the unit matrix in S */
static void shift_mobility(const double N[36], const double d[3], double out[36])
{
  const double cross[9] = {0.0, d[2], -d[1], -d[2], 0.0, d[0], d[1], -d[0], 0.0};
  double half[36];
  memcpy(half, N, sizeof(half));
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 6; q++)
      for (int k = 0; k < 3; k++) half[6 * p + q] += cross[3 * p + k] * N[6 * (3 + k) + q];
  memcpy(out, half, sizeof(half));
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 3; q++)
      for (int k = 0; k < 3; k++) out[6 * p + q] += half[6 * p + 3 + k] * cross[3 * q + k];
}

/* With S = diag(1, 1, 1, l, l, l), l^2 = tr TT / tr RR, the matrix S N S has one unit, and L = S^-1 (S N
 * S)^1/2. Eigenvalues below 0 are rounding. */
static void noise_take_root(const double N[36], double L[36])
{
  const double tt = N[0] + N[7] + N[14], rr = N[21] + N[28] + N[35];
  const double length = rr > 0.0 ? sqrt(tt / rr) : 1.0;
  double A[36], w[6], V[36];
  for (int p = 0; p < 36; p++)
    A[p] = N[p] * (p / 6 < 3 ? 1.0 : length) * (p % 6 < 3 ? 1.0 : length);
  sd_eigen(6, A, w, V);
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 6; q++) {
      double sum = 0.0;
      for (int k = 0; k < 6; k++) sum += V[6 * p + k] * V[6 * q + k] * sqrt(fmax(w[k], 0.0));
      L[6 * p + q] = sum / (p < 3 ? 1.0 : length);
    }
}

void sd_clump_noise_of(const sd_clump *clump, sd_clump_noise *out)
{
  const double *o = clump->mobility_centre;
  double N[36];
  shift_mobility(clump->mobility, o, N);
  for (int d = 0; d < 3; d++) out->centre[d] = clump->centre[d] + o[d];
  noise_take_root(N, out->root);
}

void sd_clump_noise_draw(const sd_clump_noise *n, const double R[9], double eta, const double w[6],
                         double y[6])
{
  const double factor = 1.0 / sqrt(eta);
  double in[6], out[6] = {0.0};
  sd_multiply3t(R, w, in);
  sd_multiply3t(R, w + 3, in + 3);
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 6; q++) out[p] += factor * n->root[6 * p + q] * in[q];
  sd_multiply3(R, out, y);
  sd_multiply3(R, out + 3, y + 3);
}
