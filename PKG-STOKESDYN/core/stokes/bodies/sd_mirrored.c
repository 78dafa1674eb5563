#include "sd_mirrored.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_linear.h"

enum { SIGNS = 8 };

/* -1 if bit d of the signs (or of the parity) is set */
static double mi_sign(int bits, int d)
{
  return bits >> d & 1 ? -1.0 : 1.0;
}

/* chi(s) s_c; both parities and signs are bits */
static double mi_weight(int parity, int signs, int c)
{
  double w = mi_sign(signs, c);
  for (int d = 0; d < 3; d++)
    if (signs >> d & 1) w *= mi_sign(parity, d);
  return w;
}

static int mi_find(int m, const double *x, const double wanted[3], double hair)
{
  for (int k = 0; k < m; k++)
    if (sd_distance_squared(x + 3 * k, wanted) < hair * hair) return k;
  return -1;
}

/* The sets of images of points x in the axes of the mirrors */
static sd_status mi_find_sets(sd_mirrored *s, const double *x)
{
  double largest = 0.0;
  for (int k = 0; k < 3 * s->m; k++) largest = fmax(largest, fabs(x[k]));
  const double hair = 1e-9 * largest;
  int found = 0;
  for (int k = 0; k < s->m; k++) {
    const double *p = x + 3 * k;
    if (p[0] < -hair || p[1] < -hair || p[2] < -hair) continue;
    int *image = s->image + SIGNS * s->sets, different = 0;
    for (int signs = 0; signs < SIGNS; signs++) {
      const double wanted[3] = {mi_sign(signs, 0) * p[0], mi_sign(signs, 1) * p[1],
                                mi_sign(signs, 2) * p[2]};
      image[signs] = mi_find(s->m, x, wanted, hair);
      if (image[signs] < 0) return SD_EOUTSIDE;
      int first = 1;
      for (int other = 0; other < signs; other++) first = first && image[other] != image[signs];
      different += first;
    }
    s->images[s->sets++] = different;
    found += different;
  }
  return found == s->m ? SD_OK : SD_EOUTSIDE;
}

/* Is there such a component at the first point of a set? Not if a mirror through it makes its weight -1 */
static int mi_exists(const sd_mirrored *s, int set, int parity, int c)
{
  const int *image = s->image + SIGNS * set;
  for (int signs = 0; signs < SIGNS; signs++)
    if (image[signs] == image[0] && mi_weight(parity, signs, c) < 0.0) return 0;
  return 1;
}

static void mi_number(sd_mirrored *s)
{
  int *next = s->unknown;
  for (int parity = 0; parity < SIGNS; parity++)
    for (int e = 0; e < 3 * s->sets; e++)
      if (mi_exists(s, e / 3, parity, e % 3)) {
        *next++ = e;
        s->size[parity]++;
      }
}

/* Block of M, which stands in the axes of the mirrors: rows at the first point of each set,
 *   A_pe = sqrt(n_p/n_q)/(8/n_q) sum over all eight signs of chi(s) s_c M(p, s q)
 * as each image stands there 8/n_q times */
static void mi_block(const sd_mirrored *s, int parity, const int *unknown, const double *M, double *A)
{
  const int n = s->size[parity];
  const size_t N = 3 * (size_t) s->m;
  for (int i = 0; i < n; i++) {
    const int p = unknown[i] / 3;
    const double *row = M + N * (size_t) (3 * s->image[SIGNS * p] + unknown[i] % 3);
    for (int j = 0; j < n; j++) {
      const int q = unknown[j] / 3, c = unknown[j] % 3;
      double sum = 0.0;
      for (int signs = 0; signs < SIGNS; signs++)
        sum += mi_weight(parity, signs, c) * row[3 * s->image[SIGNS * q + signs] + c];
      A[(size_t) i * (size_t) n + (size_t) j] =
          sum * sqrt((double) s->images[p] * s->images[q]) / SIGNS;
    }
  }
}

/* M in the axes of the mirrors, in place */
static void mi_turn(int m, const double axes[9], double *M)
{
  const size_t N = 3 * (size_t) m;
  const double back[9] = {axes[0], axes[3], axes[6], axes[1], axes[4], axes[7], axes[2], axes[5], axes[8]};
  for (size_t p = 0; p < (size_t) m; p++)
    for (size_t q = 0; q < (size_t) m; q++) {
      double B[9], half[9], *at = M + 3 * p * N + 3 * q;
      for (size_t e = 0; e < 9; e++) B[e] = at[e / 3 * N + e % 3];
      sd_product3(back, B, half);
      sd_product3(half, axes, B);
      for (size_t e = 0; e < 9; e++) at[e / 3 * N + e % 3] = B[e];
    }
}

static sd_status mi_invert(sd_mirrored *s, const double *M)
{
  size_t room = 0;
  for (int parity = 0; parity < SIGNS; parity++)
    room += (size_t) s->size[parity] * (size_t) s->size[parity];
  double *A = s->inverse = malloc(sizeof(double) * (room + 1));
  const int *unknown = s->unknown;
  if (!A) return SD_ENOMEMORY;
  for (int parity = 0; parity < SIGNS; parity++) {
    const int n = s->size[parity];
    mi_block(s, parity, unknown, M, A);
    const sd_status status = n > 0 ? sd_inverse(n, A) : SD_OK;
    if (status != SD_OK) return status;
    A += (size_t) n * (size_t) n;
    unknown += n;
  }
  return SD_OK;
}

sd_status sd_mirrored_create(int m, const double *x, const double axes[9], const double *M,
                             sd_mirrored *s)
{
  const size_t N = 3 * (size_t) m;
  *s = (sd_mirrored){.m = m};
  memcpy(s->axes, axes, sizeof s->axes);
  s->image = malloc(sizeof(int) * SIGNS * (size_t) m);
  s->images = malloc(sizeof(int) * (size_t) m);
  s->unknown = malloc(sizeof(int) * SIGNS * N);
  double *own = malloc(sizeof(double) * N), *turned = malloc(sizeof(double) * N * N);
  sd_status status =
      s->image && s->images && s->unknown && own && turned ? SD_OK : SD_ENOMEMORY;
  if (status == SD_OK) {
    for (int k = 0; k < m; k++) sd_multiply3t(axes, x + 3 * k, own + 3 * k);
    memcpy(turned, M, sizeof(double) * N * N);
    mi_turn(m, axes, turned);
    status = mi_find_sets(s, own);
  }
  if (status == SD_OK) {
    mi_number(s);
    status = mi_invert(s, turned);
  }
  free(own);
  free(turned);
  if (status != SD_OK) sd_mirrored_free(s);
  return status;
}

/* What field y, in space, has of a parity at the first points: f [size] */
static void mi_gather(const sd_mirrored *s, int parity, const int *unknown, const double *y, double *f)
{
  for (int i = 0; i < s->size[parity]; i++) {
    const int set = unknown[i] / 3, c = unknown[i] % 3;
    double sum = 0.0;
    for (int signs = 0; signs < SIGNS; signs++)
      sum += mi_weight(parity, signs, c) * y[3 * s->image[SIGNS * set + signs] + c];
    f[i] = sum * sqrt((double) s->images[set]) / SIGNS;
  }
}

/* z += the field of f */
static void mi_spread(const sd_mirrored *s, int parity, const int *unknown, const double *f, double *z)
{
  for (int i = 0; i < s->size[parity]; i++) {
    const int set = unknown[i] / 3, c = unknown[i] % 3;
    const double share = f[i] * sqrt((double) s->images[set]) / SIGNS;
    for (int signs = 0; signs < SIGNS; signs++)
      z[3 * s->image[SIGNS * set + signs] + c] += mi_weight(parity, signs, c) * share;
  }
}

void sd_mirrored_apply(const sd_mirrored *s, const double *y, double *z)
{
  enum { SIZE = 3 * 642 };
  double own[SIZE], out[SIZE], f[SIZE], g[SIZE];
  const double *A = s->inverse;
  const int *unknown = s->unknown;
  for (int k = 0; k < s->m; k++) sd_multiply3t(s->axes, y + 3 * k, own + 3 * k);
  memset(out, 0, sizeof(double) * 3 * (size_t) s->m);
  for (int parity = 0; parity < SIGNS; parity++) {
    const int n = s->size[parity];
    mi_gather(s, parity, unknown, own, f);
    memset(g, 0, sizeof(double) * (size_t) n);
    for (int j = 0; j < n; j++, A += n)
      for (int i = 0; i < n; i++) g[i] += A[i] * f[j];
    mi_spread(s, parity, unknown, g, out);
    unknown += n;
  }
  for (int k = 0; k < s->m; k++) sd_multiply3(s->axes, out + 3 * k, z + 3 * k);
}

void sd_mirrored_free(sd_mirrored *s)
{
  free(s->image);
  free(s->images);
  free(s->unknown);
  free(s->inverse);
  *s = (sd_mirrored){0};
}
