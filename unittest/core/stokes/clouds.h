/* Scenes of many spheres, the same on every machine: dense packings and clouds of flocs. */
#ifndef CLOUDS_H
#define CLOUDS_H

#include <string.h>

#include "scene.h"

/* A random direction times length */
static inline void random_vector(uint64_t *seed, double length, double v[3])
{
  double sq;
  do {
    sq = 0.0;
    for (int d = 0; d < 3; d++) {
      v[d] = uniform(seed, -1, 1);
      sq += v[d] * v[d];
    }
  } while (sq > 1.0 || sq < 1e-4);
  for (int d = 0; d < 3; d++) v[d] *= length / sqrt(sq);
}

/* Spheres of radii smallest ... largest (uniform) at volume fraction phi in a cube, pushed apart until no two overlap
 * by more than a millionth: random sequential addition would end at 0.38. */
static inline scene cloud_dense(int n, double phi, double smallest, double largest, double eta,
                                uint64_t seed)
{
  scene s = scene_create(n);
  double volume = 0.0;
  for (int i = 0; i < n; i++) {
    s.a[i] = uniform(&seed, smallest, largest);
    volume += 4.0 / 3.0 * SD_PI * pow(s.a[i], 3);
  }
  const double side = cbrt(volume / phi);
  for (int i = 0; i < n; i++)
    scene_set(&s, i, uniform(&seed, 0, side), uniform(&seed, 0, side), uniform(&seed, 0, side),
              s.a[i], eta);
  sd_neighbors list = {0};
  double *move = malloc(3 * sizeof(double) * (size_t) n), worst = 1.0;
  for (int sweep = 0; sweep < 5000 && worst > 1e-6; sweep++) {
    worst = 0.0;
    if (sd_neighbors_cutoff(&list, s.x, n, n, 2.0 * largest) != SD_OK) abort();
    for (int i = 0; i < n; i++) {
      double *m = move + 3 * i;
      m[0] = m[1] = m[2] = 0.0;
      for (long k = list.pairs.first[i]; k < list.pairs.first[i + 1]; k++) {
        const int j = list.pairs.neighbor[k];
        double r[3], R = 0.0;
        for (int d = 0; d < 3; d++) {
          r[d] = s.x[3 * i + d] - s.x[3 * j + d];
          R += r[d] * r[d];
        }
        R = sqrt(R);
        const double overlap = s.a[i] + s.a[j] - R;
        if (overlap <= 0.0 || R == 0.0) continue;
        worst = fmax(worst, overlap);
        for (int d = 0; d < 3; d++) m[d] += 0.5 * (overlap + 1e-3 * largest) * r[d] / R;
      }
    }
    for (int i = 0; i < 3 * n; i++) s.x[i] = fmin(fmax(s.x[i] + 0.7 * move[i], 0.0), side);
  }
  free(move);
  sd_neighbors_free(&list);
  return s;
}

/* Flocs of m spheres, radii 1 ... spread (uniform in the logarithm), each sphere stuck to one before it at 0.6 to 0.95
 * of the sum of their radii; flocs at random places of a cube. apart: spheres of different flocs do not overlap.
 * Spheres m k ... m (k+1) - 1 are floc k. */
static inline scene cloud_flocs(int flocs, int m, double spread, double side, int apart, double eta,
                                uint64_t seed)
{
  scene s = scene_create(flocs * m);
  for (int k = 0; k < flocs; k++) {
    int overlap = 0;
    for (int i = m * k; i < m * (k + 1); i++) {
      const double a = spread > 1.0 ? exp(uniform(&seed, 0.0, log(spread))) : 1.0;
      double c[3];
      if (i == m * k)
        for (int d = 0; d < 3; d++) c[d] = uniform(&seed, 0, side);
      else {
        const int to = m * k + (int) uniform(&seed, 0, i - m * k);
        random_vector(&seed, uniform(&seed, 0.6, 0.95) * (a + s.a[to]), c);
        for (int d = 0; d < 3; d++) c[d] += s.x[3 * to + d];
      }
      scene_set(&s, i, c[0], c[1], c[2], a, eta);
      for (int j = 0; j < m * k && apart && !overlap; j++) {
        double sq = 0.0;
        for (int d = 0; d < 3; d++) sq += pow(c[d] - s.x[3 * j + d], 2);
        overlap = sq < pow(a + s.a[j], 2);
      }
    }
    if (overlap) k--; /* another shape at another place */
  }
  return s;
}

/* Equal spheres in a periodic cube, in cells that are at least as wide as two radii: who touches whom */
typedef struct {
  int n, *first, *next;
  double side;
} cloud_cells;

static inline int *cloud_cell(const cloud_cells *c, const double *x, const int *step)
{
  int at = 0;
  for (int d = 0; d < 3; d++) {
    const int k = (int) fmin(c->n - 1, x[d] / c->side * c->n);
    at = at * c->n + (k + (step ? step[d] : 0) + c->n) % c->n;
  }
  return c->first + at;
}

static inline void cloud_put(const cloud_cells *c, const double *x, int i)
{
  int *first = cloud_cell(c, x, NULL);
  c->next[i] = *first;
  *first = i;
}

static inline void cloud_take(const cloud_cells *c, const double *x, int i)
{
  int *at = cloud_cell(c, x, NULL);
  while (*at != i) at = c->next + *at;
  *at = c->next[i];
}

static inline int cloud_apart(const cloud_cells *c, const double *all, const double *x, double a)
{
  int step[3];
  for (step[0] = -1; step[0] <= 1; step[0]++)
    for (step[1] = -1; step[1] <= 1; step[1]++)
      for (step[2] = -1; step[2] <= 1; step[2]++)
        for (int j = *cloud_cell(c, x, step); j >= 0; j = c->next[j]) {
          double sq = 0.0;
          for (int d = 0; d < 3; d++) {
            const double r = fabs(x[d] - all[3 * j + d]), image = fmin(r, c->side - r);
            sq += image * image;
          }
          if (sq < 4.0 * a * a) return 0;
        }
  return 1;
}

/* m^3 equal spheres in a periodic cube, phi up to 0.5: from a simple cubic lattice by random moves of one after the
 * other that keep them apart. */
static inline scene cloud_periodic(int m, double phi, double a, double eta, int sweeps, double *side)
{
  const double spacing = a * cbrt(4.0 / 3.0 * SD_PI / phi), step = 0.3 * (1.0 - phi) * a;
  scene s = scene_lattice(m, m, m, spacing / a, a, eta);
  uint64_t seed = 5;
  *side = m * spacing;
  cloud_cells c = {.n = (int) (*side / (2.0 * a)), .side = *side};
  c.first = malloc(sizeof(int) * (size_t) (c.n * c.n * c.n));
  c.next = malloc(sizeof(int) * (size_t) s.n);
  for (int k = 0; k < c.n * c.n * c.n; k++) c.first[k] = -1;
  for (int i = 0; i < s.n; i++) cloud_put(&c, s.x + 3 * i, i);
  for (int sweep = 0; sweep < sweeps; sweep++)
    for (int i = 0; i < s.n; i++) {
      double x[3];
      for (int d = 0; d < 3; d++) {
        x[d] = s.x[3 * i + d] + uniform(&seed, -step, step);
        x[d] -= *side * floor(x[d] / *side);
      }
      cloud_take(&c, s.x + 3 * i, i);
      if (cloud_apart(&c, s.x, x, a)) memcpy(s.x + 3 * i, x, sizeof(x));
      cloud_put(&c, s.x + 3 * i, i);
    }
  free(c.first);
  free(c.next);
  return s;
}

#endif
