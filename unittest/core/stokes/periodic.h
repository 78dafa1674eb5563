/* Spheres in a periodic box, summed directly: u = Omega F of the lattice sum of Rotne and Prager's tensor, forces only, by Ewald's
 * splitting with H = (1 + x) exp(-x), x = k^2/(4 xi^2) (Hasimoto 1959), and 1 - a^2 k^2/6 for each sphere. Near blocks are stored
 * and every wave is summed over all spheres: slow, and with nothing in common with the engine. */
#ifndef PERIODIC_H
#define PERIODIC_H

#include "scene.h"

#include "sd_ewald.h"
#include "sd_linear.h"

#include <string.h>

typedef struct {
  const scene *s;
  sd_ewald_box box;
  double xi;
  /* near pairs, images and the sphere itself among them: rows first [n + 1], source, block [6] xx yy zz yz xz xy */
  long *first, pairs;
  int *source;
  double (*block)[6];
  /* half of the waves: k, strength 2 H/(k^2 V); n_d up to most[d]; cosines and sines of n x_d, [d][n][i] */
  int most[3], products;
  double *cosine[3], *sine[3], *wave;
} periodic;

/* I_n and J_n of the wave part of one pair, at distance r, in units 1/eta */
static inline void wave_functions(double xi, double r, double I[3], double J[3])
{
  const double root = sqrt(SD_PI), q = xi * xi * r * r, E = exp(-q), x3 = pow(xi, 3),
               x5 = pow(xi, 5);
  I[2] = x5 / (SD_PI * root) * (14.0 - 22.0 * q + 4.0 * q * q) * E;
  J[2] = x5 / (SD_PI * root) * (18.0 * q - 4.0 * q * q) * E;
  if (r == 0.0) {
    I[0] = xi / (2.0 * SD_PI * root);
    I[1] = 5.0 * x3 / (3.0 * SD_PI * root);
    J[0] = J[1] = 0.0;
    return;
  }
  const double e = erf(xi * r), L = e / (r * r * r) - 2.0 * xi * E / (root * r * r);
  I[0] = (e / r + 2.0 * xi * E / root) / (8.0 * SD_PI);
  J[0] = (e / r - 2.0 * xi * E / root) / (8.0 * SD_PI);
  I[1] = (-L + (8.0 * x3 - 4.0 * x5 * r * r) * E / root) / (4.0 * SD_PI);
  J[1] = (3.0 * L - (4.0 * x3 - 4.0 * x5 * r * r) * E / root) / (4.0 * SD_PI);
}

/* Near block of spheres i and j at separation r; of i with itself: without what the solver adds */
static inline void near_block(const periodic *p, int i, int j, const double r[3], double B[6])
{
  const double ai = p->s->a[i], aj = p->s->a[j], R = sqrt(sd_dot(r, r)),
               inv = R > 0.0 ? 1.0 / R : 0.0;
  const double bi = ai * ai / 6.0, bj = aj * aj / 6.0, unit = 1.0 / (6.0 * SD_PI),
               w = p->s->w[i] * p->s->w[j];
  double I[3], J[3], f, g;
  wave_functions(p->xi, R, I, J);
  sd_rpy_radial(R, ai, aj, &f, &g);
  if (R == 0.0 && i == j) f = 0.0;
  f = w * (unit * f - (I[0] - (bi + bj) * I[1] + bi * bj * I[2]));
  g = w * (unit * g - (J[0] - (bi + bj) * J[1] + bi * bj * J[2]));
  const int first[6] = {0, 1, 2, 1, 0, 0}, second[6] = {0, 1, 2, 2, 2, 1};
  for (int c = 0; c < 6; c++) {
    const double hh = r[first[c]] * r[second[c]] * inv * inv;
    B[c] = (c < 3 ? f : 0.0) + g * hh;
  }
}

/* What is left out is below the tolerance beyond the distance `range`, which no edge may fall short of. */
static inline periodic periodic_create(const scene *s, const double edge[3], double range,
                                       double tolerance)
{
  const double digits = sqrt(log(1.0 / tolerance));
  periodic p = {
      .s = s, .xi = digits / range, .box = {.periodic = 1, .edge = {edge[0], edge[1], edge[2]}}};
  long capacity = 0;
  p.first = malloc(sizeof(long) * ((size_t) s->n + 1));
  for (int i = 0; i < s->n; i++) {
    p.first[i] = p.pairs;
    for (int j = 0; j < s->n; j++)
      for (int image = 0; image < 27; image++) {
        const int shift[3] = {image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1};
        double r[3];
        for (int d = 0; d < 3; d++) {
          r[d] = s->x[3 * i + d] - s->x[3 * j + d];
          r[d] -= edge[d] * (round(r[d] / edge[d]) + shift[d]);
        }
        if (sd_dot(r, r) > range * range) continue;
        if (p.pairs == capacity) {
          capacity = 2 * capacity + 1000;
          p.source = realloc(p.source, sizeof(int) * (size_t) capacity);
          p.block = realloc(p.block, sizeof(*p.block) * (size_t) capacity);
        }
        p.source[p.pairs] = j;
        near_block(&p, i, j, r, p.block[p.pairs++]);
      }
  }
  p.first[s->n] = p.pairs;
  for (int d = 0; d < 3; d++) {
    p.most[d] = (int) (2.0 * p.xi * digits * edge[d] / (2.0 * SD_PI)) + 1;
    p.cosine[d] = malloc(sizeof(double) * (size_t) s->n * (size_t) (p.most[d] + 1));
    p.sine[d] = malloc(sizeof(double) * (size_t) s->n * (size_t) (p.most[d] + 1));
    for (int m = 0; m <= p.most[d]; m++)
      for (int i = 0; i < s->n; i++) {
        const double t = 2.0 * SD_PI * m * s->x[3 * i + d] / edge[d];
        p.cosine[d][(long) s->n * m + i] = cos(t);
        p.sine[d][(long) s->n * m + i] = sin(t);
      }
  }
  p.wave = malloc(sizeof(double) * 9 * (size_t) s->n);
  return p;
}

static inline void periodic_free(periodic *p)
{
  for (int d = 0; d < 3; d++) {
    free(p->cosine[d]);
    free(p->sine[d]);
  }
  free(p->first);
  free(p->source);
  free(p->block);
  free(p->wave);
}

/* u += one wave, k = 2 pi n/edge */
static inline void add_wave(const periodic *p, const int n[3], const double *F, double *u)
{
  const scene *s = p->s;
  const long N = s->n;
  double k[3], volume = 1.0, re[3] = {0.0}, im[3] = {0.0};
  double *c = p->wave, *q = c + N, *g = q + N;
  for (int d = 0; d < 3; d++) {
    k[d] = 2.0 * SD_PI * n[d] / p->box.edge[d];
    volume *= p->box.edge[d];
  }
  const double square = sd_dot(k, k), x = square / (4.0 * p->xi * p->xi),
               strength = 2.0 * (1.0 + x) * exp(-x) / (square * volume);
  const double sy = n[1] < 0 ? -1.0 : 1.0, sz = n[2] < 0 ? -1.0 : 1.0;
  const double *cx = p->cosine[0] + N * n[0], *cy = p->cosine[1] + N * abs(n[1]),
               *cz = p->cosine[2] + N * abs(n[2]);
  const double *qx = p->sine[0] + N * n[0], *qy = p->sine[1] + N * abs(n[1]),
               *qz = p->sine[2] + N * abs(n[2]);
  for (long i = 0; i < N; i++) {
    const double cxy = cx[i] * cy[i] - sy * qx[i] * qy[i], qxy = sy * cx[i] * qy[i] + qx[i] * cy[i];
    c[i] = cxy * cz[i] - sz * qxy * qz[i];
    q[i] = sz * cxy * qz[i] + qxy * cz[i];
    g[i] = s->w[i] * (1.0 - s->a[i] * s->a[i] * square / 6.0);
    for (int d = 0; d < 3; d++) {
      re[d] += g[i] * c[i] * F[3 * i + d];
      im[d] += g[i] * q[i] * F[3 * i + d];
    }
  }
  const double along = sd_dot(k, re) / square, across = sd_dot(k, im) / square;
  for (int d = 0; d < 3; d++) {
    re[d] = strength * (re[d] - k[d] * along);
    im[d] = strength * (im[d] - k[d] * across);
  }
  for (long i = 0; i < N; i++)
    for (int d = 0; d < 3; d++) u[3 * i + d] += g[i] * (c[i] * re[d] + q[i] * im[d]);
}

/* In the signature of sd_apply */
static inline sd_status periodic_apply(void *ctx, const double *F, double *u)
{
  periodic *p = ctx;
  p->products++;
  for (int i = 0; i < p->s->n; i++) {
    double v[3] = {0.0};
    for (long l = p->first[i]; l < p->first[i + 1]; l++) {
      const double *B = p->block[l], *f = F + 3 * (long) p->source[l];
      v[0] += B[0] * f[0] + B[5] * f[1] + B[4] * f[2];
      v[1] += B[5] * f[0] + B[1] * f[1] + B[3] * f[2];
      v[2] += B[4] * f[0] + B[3] * f[1] + B[2] * f[2];
    }
    memcpy(u + 3 * (long) i, v, sizeof(v));
  }
  for (int l = 0; l <= p->most[0]; l++)
    for (int m = l > 0 ? -p->most[1] : 0; m <= p->most[1]; m++)
      for (int n = l > 0 || m > 0 ? -p->most[2] : 1; n <= p->most[2]; n++) {
        const double far = pow((double) l / p->most[0], 2) + pow((double) m / p->most[1], 2) +
            pow((double) n / p->most[2], 2);
        if (far <= 1.0) add_wave(p, (int[3]){l, m, n}, F, u);
      }
  return SD_OK;
}

/* m^3 equal spheres at volume fraction phi in a cube of this side, from a lattice by random moves that keep them apart */
static inline scene periodic_suspension(int m, double phi, double a, double eta, int sweeps,
                                        double *side)
{
  const double spacing = a * cbrt(4.0 / 3.0 * SD_PI / phi),
               step = fmin(0.3 * (1.0 - phi) * a, 0.5 * a);
  scene s = scene_lattice(m, m, m, spacing / a, a, eta);
  uint64_t seed = 5;
  *side = m * spacing;
  for (int sweep = 0; sweep < sweeps; sweep++)
    for (int i = 0; i < s.n; i++) {
      double x[3];
      int free_of_others = 1;
      for (int d = 0; d < 3; d++) x[d] = s.x[3 * i + d] + uniform(&seed, -step, step);
      for (int j = 0; j < s.n && free_of_others; j++) {
        double sq = 0.0;
        for (int d = 0; d < 3; d++) {
          const double r = x[d] - s.x[3 * j + d];
          sq += pow(r - *side * round(r / *side), 2);
        }
        free_of_others = j == i || sq >= 4.0 * a * a;
      }
      if (free_of_others) memcpy(s.x + 3 * i, x, sizeof(x));
    }
  return s;
}

#endif
