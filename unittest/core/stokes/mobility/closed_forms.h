/* What engines must answer, written down here anew: the tensor of two spheres, of two in a periodic box, of two between
 * walls. Blocks [9] row-major, velocity from force. */
#ifndef CLOSED_FORMS_H
#define CLOSED_FORMS_H

#include "check.h"

#include "sd_constants.h"
#include "sd_wall.h"

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

/* Two spheres, or (r = 0) one with its own images, in a box of edges `edge`, whose rows are vectors: Beenakker 1986,
 * whose a^2 is the mean of both for unequal radii; images that overlap are corrected. Sums to 1e-12. */
static inline void periodic_tensor(const double r[3], double a, double b, double eta, double edge[3][3], int self,
                                   double M[9])
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
    for (int d = 0; d < 3; d++) M[4 * d] = unit * (1.0 / a - 6.0 * xi / root + 40.0 * pow(xi, 3) * a * a /
                                                   (3.0 * root));
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
          const double wave = unit * (1.0 - h * k2 / 3.0) * (1.0 + x + 2.0 * x * x) * 6.0 * SD_PI / k2 * exp(-x) / V *
              cos(kr);
          block_of(wave, -wave, q, B);
          for (int e = 0; e < 9; e++) M[e] += B[e];
        }
        if (self && here) continue;
        const double R = sqrt(R2), E = exp(-xi * xi * R2) / root, x2 = xi * xi, x3 = x2 * xi, x5 = x3 * x2,
                     x7 = x5 * x2;
        f = unit * (erfc(xi * R) * (0.75 / R + 0.5 * h / (R2 * R)) +
                    E * (4 * x7 * h * R2 * R2 + 3 * x3 * R2 - 20 * x5 * h * R2 - 4.5 * xi + 14 * x3 * h + xi * h / R2));
        g = unit * (erfc(xi * R) * (0.75 / R - 1.5 * h / (R2 * R)) +
                    E * (-4 * x7 * h * R2 * R2 - 3 * x3 * R2 + 16 * x5 * h * R2 + 1.5 * xi - 2 * x3 * h - 3 * xi * h /
                         R2));
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

/* Two spheres at xi and xj, or (home = 0) one with its own images, of radii a and b */
typedef struct {
  const double *xi, *xj;
  double a, b;
  int home;
} pair_above;

/* Above the wall z = 0 in a box of square section, all images along it: pairs and their images in the wall, to a smooth
 * end at 40 cells. Beyond it is 12 h g xx/(8 pi eta R^5) on average (Blake 1971). */
static inline void floor_tensor(const pair_above *p, double eta, double edge, double M[9])
{
  const double *xi = p->xi, *xj = p->xj, a = p->a, b = p->b;
  const double far = 40.0 * edge, mean = 1.5 * xi[2] * xj[2] * tgamma(5.0 / 6.0) / (eta * far * edge * edge);
  const sd_wall ground = {2, 1, 0.0};
  memset(M, 0, 9 * sizeof(double));
  M[0] = M[4] = mean;
  for (int k = -70; k <= 70; k++)
    for (int l = -70; l <= 70; l++) {
      const double x[3] = {xj[0] + k * edge, xj[1] + l * edge, xj[2]}, r[3] = {xi[0] - x[0], xi[1] - x[1],
                                                                               xi[2] - x[2]};
      const double part = exp(-pow((r[0] * r[0] + r[1] * r[1]) / (far * far), 3));
      double bare[9] = {0.0}, image[9];
      if (part < 1e-15) continue;
      if (p->home || k != 0 || l != 0) pair_tensor(r, a, b, eta, bare);
      else bare[0] = bare[4] = bare[8] = 1.0 / (6.0 * SD_PI * eta * a);
      sd_wall_block(&ground, 3, xi, a, x, b, image);
      for (int e = 0; e < 9; e++) M[e] += part * (bare[e] + image[e] / eta);
    }
}

/* [4] row-major, times 4 eta k: flow of a wave exp(ikl) along it and, times i, across the walls, at a height d above
 * forces of that wave in free fluid, averaged over a sphere there: s = k^2 a^2/3 */
static inline void wave_of_forces(double k, double d, double s, double W[4])
{
  const double up = d < 0.0 ? -1.0 : 1.0, E = exp(-k * fabs(d)), K = k * fabs(d) - s;
  W[0] = E * (1.0 - K);
  W[1] = -up * E * K;
  W[2] = up * E * K;
  W[3] = E * (1.0 + K);
}

static inline void product2(const double A[4], const double B[4], double C[4])
{
  for (int e = 0; e < 4; e++) C[e] = A[2 * (e / 2)] * B[e % 2] + A[2 * (e / 2) + 1] * B[2 + e % 2];
}

/* The same of the forces that stop a flow on walls at 0 and H, less those that stop it on the one at 0, at the height
 * z, where the flow is that of forces at h. With u on both walls and E their interaction q0 + E q1 = -u0, E' q0 + q1 =
 * -u1. */
static inline void wave_of_second_wall(double k, double H, double z, double s_z, double h, double s_h, double G[4])
{
  double u0[4], u1[4], E[4], back[4], square[4], q0[4], q1[4], t[4], w[4];
  wave_of_forces(k, -h, s_h, u0);
  wave_of_forces(k, H - h, s_h, u1);
  wave_of_forces(k, -H, 0.0, E);
  wave_of_forces(k, H, 0.0, back);
  product2(back, E, square);
  product2(back, u0, t);
  const double p = 1.0 - square[0], q = -square[1], r = -square[2], v = 1.0 - square[3], over = 1.0 / (p * v - q * r);
  const double inverse[4] = {over * v, -over * q, -over * r, over * p};
  for (int e = 0; e < 4; e++) t[e] -= u1[e];
  product2(inverse, t, q1);
  product2(E, q1, q0); /* with another sign: what the second wall changes of the forces on the first */
  wave_of_forces(k, z - H, s_z, w);
  product2(w, q1, G);
  wave_of_forces(k, z, s_z, w);
  product2(w, q0, t);
  for (int e = 0; e < 4; e++) G[e] -= t[e];
}

/* The same between the walls z = 0 and z = H, with no mean pressure gradient along them: those above the first wall
 * and, wave by wave, what the second one adds. No sphere cuts a wall; the waves are those of heights below 3/4 H. */
static inline void slit_tensor(const pair_above *p, double eta, double edge, double H, double M[9])
{
  enum { WAVES = 12 };
  const double *xi = p->xi, *xj = p->xj, a = p->a, b = p->b;
  const double S = edge * edge, z = xi[2], h = xj[2];
  floor_tensor(p, eta, edge, M);
  for (int d = 0; d < 2; d++) M[4 * d] -= z * h / (eta * S * H);
  for (int m = -WAVES; m <= WAVES; m++)
    for (int n = -WAVES; n <= WAVES; n++) {
      if (m == 0 && n == 0) continue;
      const double k = 2.0 * SD_PI / edge * sqrt(m * m + n * n), unit = 1.0 / (4.0 * eta * k * S);
      const double c = m / sqrt(m * m + n * n), s = n / sqrt(m * m + n * n);
      const double at = 2.0 * SD_PI / edge * (m * (xi[0] - xj[0]) + n * (xi[1] - xj[1])), real = unit * cos(at),
                   odd = unit * sin(at);
      double G[4];
      wave_of_second_wall(k, H, z, k * k * a * a / 3.0, h, k * k * b * b / 3.0, G);
      const double T = 2.0 * (sinh(k * fmin(z, h)) * sinh(k * (H - fmax(z, h))) / sinh(k * H) * 2.0 -
                              exp(-k * fabs(z - h)) +
                              exp(-k * (z + h)));
      M[0] += real * (c * c * G[0] + s * s * T);
      M[4] += real * (s * s * G[0] + c * c * T);
      M[1] += real * c * s * (G[0] - T);
      M[3] += real * c * s * (G[0] - T);
      M[2] -= odd * c * G[1];
      M[5] -= odd * s * G[1];
      M[6] += odd * c * G[2];
      M[7] += odd * s * G[2];
      M[8] += real * G[3];
    }
}

/* The same where the mean flow along the walls is stopped by a pressure gradient: u = z (H - z)/(2 eta) is the flow of
 * a gradient of -1, and by reciprocity the flux that a force makes is its velocity at the sphere, over the section
 * S. */
static inline void stop_flux(const pair_above *p, double eta, double edge, double H, double M[9])
{
  const double z = p->xi[2], h = p->xj[2];
  const double of_i = z * (H - z) - p->a * p->a / 3.0, of_j = h * (H - h) - p->b * p->b / 3.0;
  for (int d = 0; d < 2; d++) M[4 * d] -= 3.0 / (eta * edge * edge * H * H * H) * of_i * of_j;
}

#endif
