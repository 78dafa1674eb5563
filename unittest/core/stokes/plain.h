/* The product by the blocks of sd_tensor.h, pair by pair, for comparison. */
#ifndef PLAIN_H
#define PLAIN_H

#include "check.h"

#include "sd_product.h"

static inline const char *isa_name(sd_isa isa)
{
  static const char *const names[] = {"best", "plain C", "baseline", "AVX2", "AVX-512"};
  return names[isa];
}

/* u [width] += what sphere i gets of j, with F [width] */
static inline void plain_pair(const sd_law *law, const sd_spheres *s, long i, long j, int width,
                              const double *F, double *u)
{
  double r[3], M[36];
  if (!(s->a[i] > 0.0 && s->a[j] > 0.0)) return;
  for (int d = 0; d < 3; d++) r[d] = s->x[3 * i + d] - s->x[3 * j + d];
  const double eta = 1.0 / (s->w[i] * s->w[j]);
  const double taper = sd_taper_factor(law, sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]));
  if (width == 3)
    sd_tensor_uf(law->tensor, r, s->a[i], s->a[j], eta, M);
  else
    sd_tensor_grand(r, s->a[i], s->a[j], eta, M);
  for (int p = 0; p < width; p++)
    for (int q = 0; q < width; q++) u[p] += taper * M[width * p + q] * F[q];
}

/* Every one of n spheres with every other: F [width n] -> u [width n] */
static inline void plain_all(const sd_law *law, const sd_spheres *s, int n, int width,
                             const double *F, double *u)
{
  for (long i = 0; i < n; i++) {
    for (int d = 0; d < width; d++) u[width * i + d] = 0.0;
    for (long j = 0; j < n; j++)
      if (j != i) plain_pair(law, s, i, j, width, F + width * j, u + width * i);
  }
}

/* F [width n], those of ghosts behind those of the targets -> u [width pairs->n] */
static inline void plain_list(const sd_law *law, const sd_spheres *s, int n, int width,
                              const sd_pairs *pairs, const double *F, double *u)
{
  (void) n;
  for (long i = 0; i < pairs->n; i++) {
    for (int d = 0; d < width; d++) u[width * i + d] = 0.0;
    for (long k = pairs->first[i]; k < pairs->first[i + 1]; k++) {
      const long j = pairs->neighbor[k];
      plain_pair(law, s, i, j, width, F + width * j, u + width * i);
    }
  }
}

#endif
