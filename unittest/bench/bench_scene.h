/* What bench_product and bench_solve share: the law and a scene of spheres at random. */
#ifndef BENCH_SCENE_H
#define BENCH_SCENE_H

#include "clouds.h"

static const double ETA = 1.3;
static const sd_law RPY = {.tensor = SD_TENSOR_RPY};

/* n spheres of radii 0.5 ... 1.5 at random at volume fraction 0.2: some overlap */
static inline scene polydisperse(int n, uint64_t seed)
{
  scene s = scene_create(n);
  double volume = 0.0;
  for (int i = 0; i < n; i++) {
    s.a[i] = uniform(&seed, 0.5, 1.5);
    volume += 4.0 / 3.0 * SD_PI * pow(s.a[i], 3);
  }
  const double side = cbrt(volume / 0.2);
  for (int i = 0; i < n; i++)
    scene_set(&s, i, uniform(&seed, 0, side), uniform(&seed, 0, side), uniform(&seed, 0, side),
              s.a[i], ETA);
  return s;
}

/* count numbers in -1 ... 1; the caller frees */
static inline double *random_numbers(int count)
{
  double *F = malloc(sizeof(double) * (size_t) count);
  uint64_t seed = 2;
  for (int i = 0; i < count; i++) F[i] = uniform(&seed, -1, 1);
  return F;
}

#endif
