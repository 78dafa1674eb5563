#include "sd_flow.h"

void sd_flow_rotation(const double G[9], double w[3])
{
  for (int d = 0; d < 3; d++) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    w[d] = 0.5 * (G[3 * f + e] - G[3 * e + f]);
  }
}

void sd_flow_add_rotation(int n, int p, int q, const double *slope, double *w)
{
  const int d = 3 - p - q; /* the third axis */
  const double half = (d + 1) % 3 == q ? 0.5 : -0.5;
  for (int i = 0; i < n; i++) w[3 * (long) i + d] += half * slope[i];
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
void sd_flow_slope(int n, const double *ahead, const double *behind, const double *a,
                   double *slope)
{
  for (int i = 0; i < n; i++) slope[i] = a[i] > 0.0 ? (ahead[i] - behind[i]) / (2.0 * a[i]) : 0.0;
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
