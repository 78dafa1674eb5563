/* What follows from films that stand: products, power, rate and stress. */
#include "sd_lubrication_internal.h"

#include "sd_rate.h"

#include <string.h>

sd_status sd_lubrication_apply(void *ctx, const double *V, double *out)
{
  const sd_lubrication *L = ctx;
  return sd_lubrication_apply_both(L, NULL, NULL, V, out);
}

sd_status sd_lubrication_forces(const sd_lubrication *L, const double *V, double *F)
{
  const sd_status status = sd_lubrication_apply_both(L, NULL, NULL, V, F);
  for (long j = 0; j < 6 * (long) L->n; j++) F[j] = L->carried[j] - F[j];
  return status;
}

sd_status sd_lubrication_apply_both(const sd_lubrication *L, const double *own, const double *c,
                                    const double *V, double *out)
{
  const sd_status status = fetch(L, V);
  if (status != SD_OK) return status;
  SD_KERNELS_OF(sd_lubrication, plain, sd_isa_of(SD_ISA_BEST))->times(L, own, c, V, out);
  return SD_OK;
}

void sd_lubrication_strain_power(const sd_lubrication *L, const double *V, double *out)
{
  memset(out, 0, sizeof(double) * (size_t) L->n);
  for (long i = 0; i < L->n && L->work->flows; i++) {
    const double *strain = L->strain + 7 * i;
    out[i] = strain[6];
    for (int k = 0; k < 6; k++) out[i] -= strain[k] * V[6 * i + k];
  }
}

sd_status sd_lubrication_rate(sd_lubrication *L, const double *W, double *v, double *work,
                              double *rate)
{
  enum { PRODUCTS = 30 };
  const sd_decay films = {6 * (long) L->n, W, sd_lubrication_apply, L, &L->world};
  return sd_rate(&films, PRODUCTS, v, work, rate);
}

/* Half of d F dev-symmetric times the distance, to sphere i and, if it is this rank's, j. F: of the
 * first sphere on the fluid; what its own velocity does is what the second's does, turned round. */
static void add_moment(const sd_lubrication *L, long k, const sd_lubrication_link *film,
                       const double *Vi, const double *Vj, double *S)
{
  const int i = L->pair[k][0], j = L->pair[k][1];
  const closeness *close = L->work->close + k;
  const double *d = film->d, half = 0.5 * close->distance, *drift = drift_at(L, close->at);
  double U[3], spin[3], turned[3], F[3];
  for (int e = 0; e < 3; e++) {
    U[e] = Vj[e] + drift[e] - Vi[e];
    spin[e] = film->YB21 * Vj[3 + e] - film->YB12 * Vi[3 + e];
  }
  const double along = sd_dot(d, U);
  sd_cross(d, spin, turned);
  for (int e = 0; e < 3; e++)
    F[e] = film->XA * along * d[e] + film->YA * (U[e] - along * d[e]) + turned[e];
  sd_add_deviator(half, d, F, S + 6 * (long) i);
  if (j < L->n && j != i) sd_add_deviator(half, d, F, S + 6 * (long) j);
}

sd_status sd_lubrication_stress(const sd_lubrication *L, const double *V, double *S)
{
  const sd_status status = fetch(L, V);
  if (status != SD_OK) return status;
  for (long k = 0; k < L->count; k++) {
    const int i = L->pair[k][0], j = L->pair[k][1];
    if (j == i) continue;
    add_moment(L, k, L->link + k, V + 6 * (long) i, motion_at(L, V, j), S);
  }
  for (long e = 0; e < L->work->images; e++) {
    const own_image *image = L->work->image + e;
    const double *Vi = V + 6 * (long) L->pair[image->k][0];
    add_moment(L, image->k, &image->film, Vi, Vi, S);
  }
  return SD_OK;
}
