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

/* out += L_ii V, with X_ii, its own, if there is one */
static inline void film_own_times(const double own[SD_LUBRICATION_OWN], const double *X, const double V[6],
                                  double out[6])
{
  const double *FW = own + 12;
  double FU[6];
  for (int e = 0; e < 6; e++) FU[e] = X ? own[e] + X[e] : own[e];
  add_symmetric(FU, V, out);
  add_symmetric(own + 6, V + 3, out + 3);
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      out[p] += FW[3 * p + q] * V[3 + q];
      out[3 + q] += FW[3 * p + q] * V[p];
    }
}

static void films_times(const sd_lubrication *L, const double *own, const double *c, const double *V, double *out)
{
  for (long i = 0; i < L->n; i++) {
    double sum[6] = {0.0};
    film_own_times(L->diagonal + SD_LUBRICATION_OWN * i, own ? own + 6 * i : NULL, V + 6 * i, sum);
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
