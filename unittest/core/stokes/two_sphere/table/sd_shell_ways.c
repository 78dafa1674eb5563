#include "sd_shell_ways.h"

#include <math.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_linear.h"

/* Orientation of sphere `which` of pair k: even over all rotations, by an additive sequence of six
 * dimensions (multiples of the powers of 1/1.1128, the root of x^7 = x + 1) */
static void orientation(int k, int which, double Q[9])
{
  const double root = 1.1127756842787055;
  double s[3];
  for (int d = 0; d < 3; d++) s[d] = fmod(0.5 + (k + 1) * pow(root, -(3 * which + d + 1)), 1.0);
  const double u = 2.0 * SD_PI * s[1], v = 2.0 * SD_PI * s[2];
  const double w = sqrt(1.0 - s[0]) * sin(u), x = sqrt(1.0 - s[0]) * cos(u),
               y = sqrt(s[0]) * sin(v), z = sqrt(s[0]) * cos(v);
  const double R[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                       2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                       2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
  memcpy(Q, R, sizeof R);
}

static void any_way(int k, sd_shell_way *out)
{
  double Q1[9], Q2[9], back[9];
  orientation(k, 0, Q1);
  orientation(k, 1, Q2);
  for (int e = 0; e < 9; e++) back[e] = Q2[3 * (e % 3) + e / 3];
  sd_product3(back, Q1, out->Q);
  for (int e = 0; e < 3; e++) out->d[e] = back[3 * e + 2];
}

void sd_shell_ways(int count, sd_shell_way *out)
{
  for (int k = 0; k < count; k++) any_way(k, out + k);
}

/* Is this direction in one of the 120 triangles between the mirror planes of the icosahedron, a given one? */
static int in_triangle(const double d[3])
{
  const double g = 0.5 * (1.0 + sqrt(5.0)), some[3] = {0.11, 0.47, 0.82};
  for (int e = 0; e < 3; e++) {
    if (d[e] < 0.0) return 0;
    for (int s = 0; s < 4; s++) {
      double root[3];
      root[e] = 1.0 / g;
      root[(e + 1) % 3] = s & 1 ? -g : g;
      root[(e + 2) % 3] = s & 2 ? -1.0 : 1.0;
      if (sd_dot(root, d) * sd_dot(root, some) < 0.0) return 0;
    }
  }
  return 1;
}

/* The next direction in that triangle of an additive sequence over the sphere, of steps u and v */
static void next_direction(long *k, double u, double v, double E[9])
{
  double d[3], x[3], y[3];
  do {
    ++*k;
    const double z = 1.0 - 2.0 * fmod(0.5 + *k * u, 1.0), azimuth = 2.0 * SD_PI * fmod(0.5 + *k * v, 1.0);
    d[0] = sqrt(1.0 - z * z) * cos(azimuth), d[1] = sqrt(1.0 - z * z) * sin(azimuth), d[2] = z;
  } while (!in_triangle(d));
  sd_across(d, x);
  sd_normalize(x);
  sd_cross(d, x, y);
  for (int e = 0; e < 3; e++) E[3 * e] = x[e], E[3 * e + 1] = y[e], E[3 * e + 2] = d[e];
}

void sd_shell_ways_of_icosahedra(int count, sd_shell_way *out)
{
  const double plastic = 1.32471795724474603, golden = 0.61803398874989485;
  long k1 = 0, k2 = 0;
  for (int k = 0; k < count; k++) {
    const double turn = 2.0 * SD_PI * fmod(0.5 + k * golden, 1.0), c = cos(turn), s = sin(turn);
    double E1[9], E2[9], T[9];
    next_direction(&k2, 1.0 / plastic, 1.0 / (plastic * plastic), E2);
    next_direction(&k1, sqrt(2.0) - 1.0, sqrt(3.0) - 1.0, E1);
    for (int p = 0; p < 3; p++) {
      out[k].d[p] = E2[3 * p + 2];
      T[3 * p] = c * E2[3 * p] + s * E2[3 * p + 1];
      T[3 * p + 1] = c * E2[3 * p + 1] - s * E2[3 * p];
      T[3 * p + 2] = E2[3 * p + 2];
    }
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++) out[k].Q[3 * p + q] = sd_dot(T + 3 * p, E1 + 3 * q);
  }
}
