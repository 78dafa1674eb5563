#include "sd_lubrication_internal.h"
#include "sd_room.h"

void sd_lubrication_drift(sd_lubrication *L, long k, const sd_pair_resistance *R)
{
  const int i = L->pair[k][0], j = L->pair[k][1];
  const double *d = L->link[k].d, *drift = L->work->close[k].drift;
  const sd_lubrication_link B12 = block_of(R, 1, d), B22 = block_of(R, 2, d);
  const double V[6] = {-drift[0], -drift[1], -drift[2], 0.0, 0.0, 0.0};
  add_product(&B12, V, L->carried + 6 * (long) i);
  if (j < L->n && j != i) add_product(&B22, V, L->carried + 6 * (long) j);
}

int sd_lubrication_remember(sd_lubrication *L, long k, const sd_pair_resistance *R)
{
  struct sd_lubrication_work *w = L->work;
  if (!sd_extend(&w->image, sizeof(*w->image), (size_t) w->images + 1, &w->image_room)) return 0;
  w->image[w->images++] = (own_image){k, block_of(R, 1, L->link[k].d)};
  return 1;
}

/* Half of d F dev-symmetric times the distance, to sphere i and, if it is this rank's, j. F: of the
 * first sphere on the fluid; what its own velocity does is what the second's does, turned round. */
static void add_moment(const sd_lubrication *L, long k, const sd_lubrication_link *film,
                       const double *Vi, const double *Vj, double *S)
{
  static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
  const int i = L->pair[k][0], j = L->pair[k][1];
  const double *d = film->d, half = 0.5 * L->work->close[k].distance;
  double U[3], spin[3], turned[3], F[3];
  for (int e = 0; e < 3; e++) {
    U[e] = Vj[e] + L->work->close[k].drift[e] - Vi[e];
    spin[e] = film->YB21 * Vj[3 + e] - film->YB12 * Vi[3 + e];
  }
  const double along = sd_dot(d, U);
  sd_cross(d, spin, turned);
  for (int e = 0; e < 3; e++)
    F[e] = film->XA * along * d[e] + film->YA * (U[e] - along * d[e]) + turned[e];
  const double trace = sd_dot(d, F) / 3.0;
  for (int e = 0; e < 6; e++) {
    const int p = row[e], q = column[e];
    const double moment = half * (0.5 * (d[p] * F[q] + d[q] * F[p]) - (p == q ? trace : 0.0));
    S[6 * (long) i + e] += moment;
    if (j < L->n && j != i) S[6 * (long) j + e] += moment;
  }
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
