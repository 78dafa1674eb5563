/* What engines must answer, written down here anew: the tensor of two spheres, of two in a periodic box, of one above a wall. Blocks
 * [9] row-major, velocity from force. */
#ifndef CLOSED_FORMS_H
#define CLOSED_FORMS_H

#include "check.h"

#include "sd_constants.h"

#include <string.h>

/* M = f 1 + g rr/r^2 */
static inline void block_of(double f, double g, const double r[3], double M[9])
{
  const double r2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) M[3 * p + q] = (p == q ? f : 0.0) + (r2 > 0.0 ? g * r[p] * r[q] / r2 : 0.0);
}

/* f and g of spheres apart (Rotne & Prager 1969, for unequal radii Jeffrey & Onishi 1984), at any distance */
static inline void apart(double R, double a, double b, double eta, double *f, double *g)
{
  const double unit = 1.0 / (8.0 * SD_PI * eta * R), s = (a * a + b * b) / (R * R);
  *f = unit * (1.0 + s / 3.0);
  *g = unit * (1.0 - s);
}

/* And of spheres that overlap, or one in the other (Zuk, Wajnryb, Mizerski & Szymczak 2014) */
static inline void pair_tensor(const double r[3], double a, double b, double eta, double M[9])
{
  const double R = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]), d2 = (a - b) * (a - b);
  double f, g = 0.0;
  if (R > a + b)
    apart(R, a, b, eta, &f, &g);
  else if (R > fabs(a - b)) {
    const double unit = 1.0 / (6.0 * SD_PI * eta * a * b * 32.0 * R * R * R);
    f = unit * (16.0 * R * R * R * (a + b) - (d2 + 3.0 * R * R) * (d2 + 3.0 * R * R));
    g = unit * 3.0 * (d2 - R * R) * (d2 - R * R);
  } else
    f = 1.0 / (6.0 * SD_PI * eta * fmax(a, b));
  block_of(f, g, r, M);
}

/* Two spheres, or (r = 0) one with its own images, in a box of edges `edge`, whose rows are vectors: Beenakker 1986, whose a^2 is the
 * mean of both for unequal radii; images that overlap are corrected. Sums to 1e-12. */
static inline void periodic_tensor(const double r[3], double a, double b, double eta, double edge[3][3], int self, double M[9])
{
  enum { CELLS = 6 };
  const double V = edge[0][0] * edge[1][1] * edge[2][2], xi = sqrt(SD_PI) / cbrt(V), h = 0.5 * (a * a + b * b);
  const double unit = 1.0 / (6.0 * SD_PI * eta), root = sqrt(SD_PI);
  double k[3][3];
  for (int d = 0; d < 3; d++) {
    const double *p = edge[(d + 1) % 3], *q = edge[(d + 2) % 3];
    for (int c = 0; c < 3; c++)
      k[d][c] = 2.0 * SD_PI / V * (p[(c + 1) % 3] * q[(c + 2) % 3] - p[(c + 2) % 3] * q[(c + 1) % 3]);
  }
  memset(M, 0, 9 * sizeof(double));
  if (self)
    for (int d = 0; d < 3; d++) M[4 * d] = unit * (1.0 / a - 6.0 * xi / root + 40.0 * pow(xi, 3) * a * a / (3.0 * root));
  for (int l = -CELLS; l <= CELLS; l++)
    for (int m = -CELLS; m <= CELLS; m++)
      for (int n = -CELLS; n <= CELLS; n++) {
        double y[3], q[3], B[9], f, g, kr = 0.0, k2 = 0.0, R2 = 0.0;
        const int here = l == 0 && m == 0 && n == 0;
        for (int c = 0; c < 3; c++) {
          y[c] = r[c] + l * edge[0][c] + m * edge[1][c] + n * edge[2][c];
          q[c] = l * k[0][c] + m * k[1][c] + n * k[2][c];
          R2 += y[c] * y[c];
          k2 += q[c] * q[c];
          kr += q[c] * r[c];
        }
        if (!here) {
          const double x = k2 / (4.0 * xi * xi);
          const double wave = unit * (1.0 - h * k2 / 3.0) * (1.0 + x + 2.0 * x * x) * 6.0 * SD_PI / k2 * exp(-x) / V * cos(kr);
          block_of(wave, -wave, q, B);
          for (int e = 0; e < 9; e++) M[e] += B[e];
        }
        if (self && here) continue;
        const double R = sqrt(R2), E = exp(-xi * xi * R2) / root, x2 = xi * xi, x3 = x2 * xi, x5 = x3 * x2, x7 = x5 * x2;
        f = unit * (erfc(xi * R) * (0.75 / R + 0.5 * h / (R2 * R)) +
                    E * (4 * x7 * h * R2 * R2 + 3 * x3 * R2 - 20 * x5 * h * R2 - 4.5 * xi + 14 * x3 * h + xi * h / R2));
        g = unit * (erfc(xi * R) * (0.75 / R - 1.5 * h / (R2 * R)) +
                    E * (-4 * x7 * h * R2 * R2 - 3 * x3 * R2 + 16 * x5 * h * R2 + 1.5 * xi - 2 * x3 * h - 3 * xi * h / R2));
        block_of(f, g, y, B);
        for (int e = 0; e < 9; e++) M[e] += B[e];
        if (R >= a + b) continue;
        pair_tensor(y, a, b, eta, B);
        for (int e = 0; e < 9; e++) M[e] += B[e];
        apart(R, a, b, eta, &f, &g);
        block_of(f, g, y, B);
        for (int e = 0; e < 9; e++) M[e] -= B[e];
      }
}

#endif
