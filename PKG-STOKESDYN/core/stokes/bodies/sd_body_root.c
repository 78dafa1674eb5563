#include "sd_body_root.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_linear.h"
#include "sd_radial.h"

void sd_body_root_free(sd_body_root *r)
{
  free(r->inverse);
  free(r->root);
  *r = (sd_body_root){0};
}

/* M [(width m)^2] -= the waves of points k and l, a in the units of the shape */
static void take_off_waves(const sd_body_shape *s, double a, const sd_ewald *split, int k, int l,
                           double *M)
{
  const size_t w = (size_t) s->width, N = w * (size_t) s->m;
  double r[3], f[SD_RADIALS];
  for (int d = 0; d < 3; d++) r[d] = a * (s->x[3 * k + d] - s->x[3 * l + d]);
  const double R = sqrt(sd_dot(r, r));
  const double b = sd_ewald_b(split, a * s->radius[k]), c = sd_ewald_b(split, a * s->radius[l]);
  sd_radial(split, R, f);
  const double I = f[SD_I0] - (b + c) * f[SD_I1] + b * c * f[SD_I2];
  const double J = f[SD_J0] - (b + c) * f[SD_J1] + b * c * f[SD_J2];
  double *block = M + w * ((size_t) k * N + (size_t) l);
  for (size_t p = 0; p < 3; p++)
    for (size_t q = 0; q < 3; q++) {
      block[p * N + q] -= a * ((p == q ? I : 0.0) + J * r[p] * r[q]);
      if (w < 6) continue;
      block[(3 + p) * N + 3 + q] -=
          a * 0.25 * ((p == q ? f[SD_I1] : 0.0) + f[SD_J1] * r[p] * r[q]);
    }
  for (int q = 0; q < 3 && w == 6; q++) { /* (e_q x r), velocity from torque and the other way round */
    const double e[3] = {q == 0, q == 1, q == 2};
    double turned[3];
    sd_cross(e, r, turned);
    for (size_t p = 0; p < 3; p++) {
      block[p * N + 3 + (size_t) q] -= a * (f[SD_K0] - b * f[SD_K1]) * turned[p];
      block[(3 + p) * N + (size_t) q] -= a * (f[SD_K0] - c * f[SD_K1]) * turned[p];
    }
  }
}

/* M_b', of the near part with a splitting, torques over the length */
static sd_status find_matrix(const sd_body_shape *s, double a, const sd_ewald *split, double *length,
                             double *M)
{
  const size_t w = (size_t) s->width, N = w * (size_t) s->m;
  double sum[2] = {0.0, 0.0};
  memcpy(M, s->inverse, sizeof(double) * N * N);
  for (size_t j = 0; j < N; j++) sum[j % w > 2] += M[(N + 1) * j];
  *length = w > 3 ? sqrt(sum[1] / sum[0]) : 1.0;
  const sd_status status = sd_inverse((int) N, M);
  for (int k = 0; k < s->m && status == SD_OK && split; k++)
    for (int l = 0; l < s->m; l++) take_off_waves(s, a, split, k, l, M);
  for (size_t e = 0; e < N * N; e++)
    M[e] *= (e / N % w > 2 ? *length : 1.0) * (e % N % w > 2 ? *length : 1.0);
  return status;
}

sd_status sd_body_root_create(const sd_body_shape *s, double a, const sd_ewald *split,
                              sd_body_root *out)
{
  const int n = s->width * s->m;
  const size_t bytes = sizeof(double) * (size_t) n * (size_t) n;
  *out = (sd_body_root){0};
  if (n > SD_BODY_ROOT_MOST || !s->inverse) return SD_OK;
  out->inverse = malloc(bytes);
  out->root = malloc(bytes);
  sd_status status = out->inverse && out->root ? SD_OK : SD_ENOMEMORY;
  if (status == SD_OK) status = find_matrix(s, a, split, &out->length, out->root);
  if (status == SD_OK) { /* is it positive? */
    memcpy(out->inverse, out->root, bytes);
    status = sd_cholesky(n, out->inverse);
  }
  if (status == SD_OK) status = sd_symmetric_root(n, out->root);
  if (status == SD_OK) {
    memcpy(out->inverse, out->root, bytes);
    status = sd_inverse(n, out->inverse);
  }
  if (status == SD_OK) {
    out->n = n;
    return SD_OK;
  }
  sd_body_root_free(out);
  return status == SD_ESINGULAR ? SD_OK : status;
}

/* --- which splitting a root is for --- */

static const double STEP = 0.03;

/* The length that splittings are over: the unit of the shape is often that of the run, on which nothing may
 * depend. */
static double largest_point(const sd_body_shape *s)
{
  double radius = s->radius[0];
  for (int k = 1; k < s->m; k++) radius = fmax(radius, s->radius[k]);
  return radius;
}

sd_body_root_steps sd_body_root_steps_of(const sd_body_shape *s, double a, const sd_ewald *split)
{
  const double length = a * largest_point(s);
  return (sd_body_root_steps){.xi = (int) lround(log(split->xi * length) / STEP),
                              .a_ref = (int) lround(log(split->a_ref / length) / STEP),
                              .range = (int) lround(log(split->xi * split->range) / STEP)};
}

sd_ewald sd_body_root_split(const sd_body_shape *s, const sd_body_root_steps *steps, const sd_ewald *split)
{
  const double length = largest_point(s);
  sd_ewald unit = *split;
  unit.xi = exp(STEP * steps->xi) / length;
  unit.range = exp(STEP * steps->range) / unit.xi;
  unit.band = split->band * unit.xi * unit.xi * unit.range / (split->xi * split->xi * split->range);
  unit.a_ref = exp(STEP * steps->a_ref) * length;
  return unit;
}
