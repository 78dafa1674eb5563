#include "sd_film.h"

#include <math.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_film_table_internal.h"
#include "sd_tensor.h"
#include "sd_two_sphere_table_internal.h"

const double sd_film_table[SD_FILM_KINDS][SD_FILM_RATIOS][SD_FILM_GAPS][SD_FILM_SCALARS] = {
#include "sd_film_table.inc"
};

enum { RATIOS = SD_FILM_RATIOS, GAPS = SD_FILM_GAPS, SCALARS = SD_FILM_SCALARS };

static double node_of_ratio(double ratio)
{
  return (ratio - 1.0) / (ratio + 1.0) / SD_FILM_LARGEST_V;
}

static double node_of_xi(double xi)
{
  return sqrt(xi / SD_FILM_LARGEST_XI);
}

void sd_film_scales(double a1, double a2, double scale[SCALARS])
{
  const double c1 = a1 * a1 * a1, c2 = a2 * a2 * a2;
  scale[0] = 6.0 * SD_PI * a1 * a2 / (a1 + a2);
  scale[1] = 8.0 * SD_PI * c1 * c2 / (c1 + c2);
  scale[2] = 8.0 * SD_PI * c1;
  scale[3] = 8.0 * SD_PI * sqrt(c1 * c2);
  scale[4] = 8.0 * SD_PI * c2;
}

/* out = sum of w over the nodes of the ratio */
static void at_ratio(const double table[RATIOS][GAPS][SCALARS], double ratio,
                     double out[GAPS][SCALARS])
{
  double w[RATIOS];
  sd_two_sphere_weights(RATIOS, node_of_ratio(ratio), w);
  memset(out, 0, sizeof(double) * GAPS * SCALARS);
  for (int i = 0; i < RATIOS; i++)
    for (int j = 0; j < GAPS; j++)
      for (int k = 0; k < SCALARS; k++) out[j][k] += w[i] * table[i][j][k];
}

sd_status sd_films_create(int n, int one_body, const sd_two_sphere *exact, sd_films *out)
{
  if (n != 12 && n != 42) return SD_EOUTSIDE;
  out->exact = exact;
  out->shells = sd_film_table[2 * (n == 42) + (one_body != 0)];
  at_ratio(out->shells, 1.0, out->equal);
  for (int j = 0; j < GAPS; j++) /* equal spheres do not know which is 1, to the last bit */
    out->equal[j][2] = out->equal[j][4] = 0.5 * (out->equal[j][2] + out->equal[j][4]);
  return SD_OK;
}

void sd_film_clip(double *p, double *q, double *r)
{
  const double mean = 0.5 * (*p + *r), half = 0.5 * (*p - *r), root = sqrt(half * half + *q * *q);
  const double most = mean + root;
  if (mean - root >= 0.0) return;
  if (!(most > 0.0)) {
    *p = *q = *r = 0.0;
    return;
  }
  /* the projector on the larger one is (1 + (half q; q -half)/root)/2 */
  const double c = half / root, s = *q / root;
  *p = 0.5 * most * (1.0 + c);
  *q = 0.5 * most * s;
  *r = 0.5 * most * (1.0 - c);
}

/* a1 <= a2 */
static sd_status read_film(const sd_films *films, double a1, double a2, double xi, sd_film *film)
{
  double w[GAPS], sums[SCALARS] = {0.0}, scale[SCALARS], unequal[GAPS][SCALARS];
  const double(*shells)[SCALARS] = films->equal;
  sd_pair_resistance R;
  const sd_status status = sd_two_sphere_correction(films->exact, a1, a2, xi, 0.0, 1.0, &R);
  if (status != SD_OK) return status;
  if (a2 > a1) {
    at_ratio(films->shells, a2 / a1, unequal);
    shells = unequal;
  }
  sd_two_sphere_weights(GAPS, node_of_xi(xi), w);
  for (int j = 0; j < GAPS; j++)
    for (int k = 0; k < SCALARS; k++) sums[k] += w[j] * shells[j][k];
  sd_film_scales(a1, a2, scale);
  const double approach =
      scale[0] * sums[0] + sd_rpy_approach((1.0 + 0.5 * xi) * (a1 + a2), a1, a2, 1.0);
  const double beyond[SCALARS] = {R.XA[0], R.XC[0], R.YC[0], R.YC[1], R.YC[2]};
  for (int k = 0; k < SCALARS; k++) sums[k] = beyond[k] / scale[k] - sums[k];
  sd_film_clip(&sums[2], &sums[3], &sums[4]);
  *film = (sd_film){scale[0] * fmax(sums[0], 0.0),
                    scale[1] * fmax(sums[1], 0.0),
                    {scale[2] * sums[2], scale[3] * sums[3], scale[4] * sums[4]},
                    fmax(approach, 0.0)};
  return SD_OK;
}

sd_status sd_film_at(const sd_films *films, double a1, double a2, double xi, sd_film *film)
{
  const double small = a1 < a2 ? a1 : a2, large = a1 < a2 ? a2 : a1;
  if (!(large <= SD_FILM_LARGEST_RATIO * (1.0 + 1e-12) * small)) return SD_EOUTSIDE;
  if (!(xi <= SD_FILM_LARGEST_XI)) return SD_EOUTSIDE;
  const sd_status status = read_film(films, small, large, xi, film);
  if (a1 > a2) {
    const double B = film->B[0];
    film->B[0] = film->B[2];
    film->B[2] = B;
  }
  return status;
}

/* A velocity of sphere 2 alone turns both against the line of centres by U x d/R, and so bears
 * t_q = (B_q1 + B_q2) U x d/R; one of sphere 1 the opposite. */
sd_pair_resistance sd_film_resistance(const sd_film *film, double distance, double scale)
{
  const double A = scale * film->A_n, C = scale * film->A_t;
  const double B[3] = {scale * film->B[0], scale * film->B[1], scale * film->B[2]};
  const double s1 = (B[0] + B[1]) / distance, s2 = (B[1] + B[2]) / distance;
  const double slide = (s1 + s2) / distance;
  return (sd_pair_resistance){
      {A, -A, A}, {slide, -slide, slide}, {-s1, s1, -s2, s2}, {C, -C, C}, {B[0], B[1], B[2]}};
}
