/* The product of films with velocities, which a solve takes again and again. */
#include "sd_lubrication_internal.h"

/* The second spheres of pairs may be anywhere in memory: those of a pair are fetched so many pairs before. */
enum { AHEAD = 8 };

/* out += B V of a symmetric B, xx yy zz xy xz yz */
static inline void add_symmetric(const double B[6], const double V[3], double out[3])
{
  out[0] += B[0] * V[0] + B[3] * V[1] + B[4] * V[2];
  out[1] += B[3] * V[0] + B[1] * V[1] + B[5] * V[2];
  out[2] += B[4] * V[0] + B[5] * V[1] + B[2] * V[2];
}

static void films_times(const sd_lubrication *L, const double *own, const double *c, const double *V, double *out)
{
  for (long i = 0; i < L->n; i++) { /* L_ii is symmetric: by columns, which stand as rows do */
    double sum[6] = {0.0};
    for (int q = 0; q < 6; q++)
      for (int p = 0; p < 6; p++) sum[p] += L->diagonal[36 * i + 6 * q + p] * V[6 * i + q];
    if (own) add_symmetric(own + 6 * i, V + 6 * i, sum);
    for (int p = 0; p < 6; p++) out[6 * i + p] = sum[p];
  }
  for (long k = 0; k < L->count; k++) {
    const long i = L->pair[k][0], j = L->pair[k][1];
    const int later = L->pair[k + AHEAD < L->count ? k + AHEAD : k][1];
    sd_fetch(motion_at(L, V, later));
    if (later < L->n) sd_fetch(out + 6 * (long) later);
    sd_lubrication_link B12 = L->link[k];
    if (c) B12.XA -= c[k];
    add_product(&B12, motion_at(L, V, (int) j), out + 6 * i);
    if (j >= L->n) continue;
    const sd_lubrication_link B21 = exchanged(B12);
    add_product(&B21, V + 6 * i, out + 6 * j);
  }
}

const struct sd_lubrication_kernels SD_KERNELS(sd_lubrication) = {films_times};
