#include "sd_tensor.h"

void sd_tensor_uf(sd_tensor kind, const double r[3], double ai, double aj, double eta, double M[9])
{
  const double R = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
  const double scale = 1.0 / (6.0 * SD_PI * eta);
  double f, g;
  sd_tensor_radial(kind, R, ai, aj, &f, &g);
  const double inv = R > 0.0 ? 1.0 / R : 0.0;
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++)
      M[3 * p + q] = scale * (g * (r[p] * inv) * (r[q] * inv) + (p == q ? f : 0.0));
}

/* row p, column q of [h]x, the matrix of h x */
static double cross(const double h[3], int p, int q)
{
  if (p == q) return 0.0;
  return (q == (p + 1) % 3 ? -1.0 : 1.0) * h[3 - p - q];
}

/* Velocity from torque and spin from force are both cross products with rhat, of opposite sign as
 * matrices, and rhat changes sign with the pair: hence M(j,i) = M(i,j)^T. */
void sd_tensor_grand(const double r[3], double ai, double aj, double eta, double M[36])
{
  const double R = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]), inv = R > 0.0 ? 1.0 / R : 0.0;
  const double h[3] = {r[0] * inv, r[1] * inv, r[2] * inv};
  const double uf = 1.0 / (6.0 * SD_PI * eta), wt = 1.0 / (8.0 * SD_PI * eta);
  double f, g, fw, gw;
  sd_rpy_radial(R, ai, aj, &f, &g);
  sd_rpy_radial_wt(R, ai, aj, &fw, &gw);
  const double cij = sd_rpy_radial_wf(R, ai, aj), cji = sd_rpy_radial_wf(R, aj, ai);
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      const double hh = h[p] * h[q], hx = cross(h, p, q); /* F x h = -[h]x F */
      M[6 * p + q] = uf * (g * hh + (p == q ? f : 0.0));
      M[6 * p + q + 3] = -wt * cji * hx;
      M[6 * (p + 3) + q] = -wt * cij * hx;
      M[6 * (p + 3) + q + 3] = wt * (gw * hh + (p == q ? fw : 0.0));
    }
}
