#include "sd_flow.h"

void sd_flow_rotation(const double G[9], double w[3])
{
  for (int d = 0; d < 3; d++) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    w[d] = 0.5 * (G[3 * f + e] - G[3 * e + f]);
  }
}

/* G is the rate of strain, which is symmetric, plus an antisymmetric part whose three numbers are
 * half the vorticity. */
void sd_flow_set_vorticity(const double vorticity[3], double G[9])
{
  for (int d = 0; d < 3; d++) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    const double strain = 0.5 * (G[3 * f + e] + G[3 * e + f]);
    G[3 * f + e] = strain + 0.5 * vorticity[d];
    G[3 * e + f] = strain - 0.5 * vorticity[d];
  }
}

/* (u(x + a) - u(x - a))/(2 a): the scale on which a sphere feels a gradient is its own. */
double sd_flow_slope(double ahead, double behind, double a)
{
  return a > 0.0 ? (ahead - behind) / (2.0 * a) : 0.0;
}

const double sd_flow_around[SD_FLOW_DIRECTIONS][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1},
                                                       {1, 1, 0}, {1, 0, 1}, {0, 1, 1}};

/* bend = h^2 d.H d, and on a diagonal d.H d = H_qq + H_rr + 2 H_qr. */
void sd_flow_curvature(const double bend[SD_FLOW_DIRECTIONS], double h, double H[6])
{
  const double scale = 1.0 / (h * h);
  for (int e = 0; e < 3; e++) H[e] = scale * bend[e];
  H[3] = 0.5 * (scale * bend[3] - H[0] - H[1]);
  H[4] = 0.5 * (scale * bend[4] - H[0] - H[2]);
  H[5] = 0.5 * (scale * bend[5] - H[1] - H[2]);
}

void sd_flow_bend(const double H[SD_FLOW_SECOND], const double r[3], double b, double out[3])
{
  for (int p = 0; p < 3; p++) {
    const double *K = H + 6 * p;
    out[p] += 0.5 * (K[0] * r[0] * r[0] + K[1] * r[1] * r[1] + K[2] * r[2] * r[2]) +
        K[3] * r[0] * r[1] + K[4] * r[0] * r[2] + K[5] * r[1] * r[2] +
        b * b / 6.0 * (K[0] + K[1] + K[2]);
  }
}

/* G H = dH/dt, column by column: all three are upper triangles. */
void sd_flow_of_cell(const double h[6], const double rate[6], double G[9])
{
  enum { XX, YY, ZZ, YZ, XZ, XY };
  for (int k = 0; k < 9; k++) G[k] = 0.0;
  G[0] = rate[XX] / h[XX];
  G[4] = rate[YY] / h[YY];
  G[8] = rate[ZZ] / h[ZZ];
  G[1] = (rate[XY] - G[0] * h[XY]) / h[YY];
  G[5] = (rate[YZ] - G[4] * h[YZ]) / h[ZZ];
  G[2] = (rate[XZ] - G[0] * h[XZ] - G[1] * h[YZ]) / h[ZZ];
}
