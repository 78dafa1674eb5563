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

/* From the point that N is about; 0 where nothing turns */
static void centre_of_mobility(const double N[36], double o[3])
{
  const double *D[3] = {N + 21, N + 27, N + 33};
  const double trace = D[0][0] + D[1][1] + D[2][2];
  double A[9];
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) A[3 * p + q] = (p == q ? trace : 0.0) - D[p][q];
  for (int p = 0; p < 3; p++) { /* B_pq is N[6 p + 3 + q] */
    const int y = (p + 1) % 3, z = (p + 2) % 3;
    o[p] = N[6 * z + 3 + y] - N[6 * y + 3 + z];
  }
  if (sd_cholesky_solve(3, A, 1, o) != SD_OK) memset(o, 0, 3 * sizeof(double));
}

/* With S = diag(1, 1, 1, l, l, l), l^2 = tr TT / tr RR, the matrix S N S has one unit, and L = S^-1 (S N
 * S)^1/2. Eigenvalues below 0 are rounding. */
static void take_root(const double N[36], double L[36])
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
  double o[3], N[36];
  centre_of_mobility(clump->mobility, o);
  shift_mobility(clump->mobility, o, N);
  for (int d = 0; d < 3; d++) out->centre[d] = clump->centre[d] + o[d];
  take_root(N, out->root);
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
