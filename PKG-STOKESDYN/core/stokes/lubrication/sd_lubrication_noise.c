#include "sd_lubrication_noise.h"

#include <math.h>
#include <string.h>

#include "sd_linear.h"
#include "sd_lubrication_internal.h"

/* Of pair k on its first sphere and its second, as they are in the pair, F [12]. An image of the
 * sphere itself is seen from both sides, and acts from one. */
static sd_status noise_draw_pair(const sd_lubrication *L, long k, sd_lubrication_normals *normals,
                                 void *ctx, double F[12])
{
  const whole_pair *pair = L->work->whole + k;
  const int i = L->pair[k][0], self = L->pair[k][1] == i;
  double g[12], E[12] = {0.0};
  memset(F, 0, 12 * sizeof(double));
  const int first = normals(ctx, i, L->work->close[k].at, g);
  if (first) return sd_pair_noise(&pair->R, pair->d, pair->a, g, F);
  if (self) return SD_OK;
  const sd_pair_resistance R = sd_pair_resistance_exchanged(&pair->R);
  const double d[3] = {-pair->d[0], -pair->d[1], -pair->d[2]};
  const sd_status status = sd_pair_noise(&R, d, pair->a, g, E);
  memcpy(F, E + 6, 6 * sizeof(double));
  memcpy(F + 6, E, 6 * sizeof(double));
  return status;
}

/* The symmetric root, in units that make rotations comparable to translations. An eigenvalue that is smaller beside the
 * largest one is rounding, whose root would be a force. */
static void draw_alone(const double B[36], const double g[6], double F[6])
{
  const double rounding = 1e-13;
  const double tt = B[0] + B[7] + B[14], rr = B[21] + B[28] + B[35];
  const double length = tt > 0.0 && rr > 0.0 ? sqrt(rr / tt) : 1.0;
  double A[36], w[6], V[36];
  for (int e = 0; e < 36; e++)
    A[e] = B[e] / (e / 6 < 3 ? 1.0 : length) / (e % 6 < 3 ? 1.0 : length);
  sd_eigen(6, A, w, V);
  for (int k = 0; k < 6 && w[k] > rounding * w[0]; k++) {
    double c = 0.0;
    for (int q = 0; q < 6; q++) c += V[6 * q + k] * g[q];
    c *= sqrt(w[k]);
    for (int p = 0; p < 6; p++) F[p] += c * V[6 * p + k] * (p < 3 ? 1.0 : length);
  }
}

sd_status sd_lubrication_noise(const sd_lubrication *L, sd_lubrication_normals *normals, void *ctx,
                               double *F)
{
  double of_pair[12];
  for (long k = 0; k < L->count; k++) {
    const int i = L->pair[k][0], j = L->pair[k][1];
    const sd_status status = noise_draw_pair(L, k, normals, ctx, of_pair);
    if (status != SD_OK) return status;
    for (int p = 0; p < 6; p++) {
      F[6 * (long) i + p] += of_pair[p];
      if (j < L->n) F[6 * (long) j + p] += of_pair[6 + p];
    }
  }
  for (int i = 0; i < L->n; i++) {
    const double *B = L->work->alone + 36 * (long) i;
    if (!(B[0] + B[7] + B[14] + B[21] + B[28] + B[35] > 0.0)) continue;
    normals(ctx, i, i, of_pair);
    draw_alone(B, of_pair, F + 6 * (long) i);
  }
  return SD_OK;
}
