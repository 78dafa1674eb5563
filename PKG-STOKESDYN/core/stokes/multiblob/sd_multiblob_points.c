#include "sd_multiblob_points.h"

#include <string.h>

#include "sd_linear.h"

static int inside(const double p[3], const double centre[3], double radius)
{
  return sd_distance_squared(p, centre) < radius * radius;
}

void sd_multiblob_masks(const sd_multiblob *m, const sd_shape *clump, const double turn[9],
                        sd_multiblob_mask *mask)
{
  const double hair = SD_SHAPE_TOLERANCE * clump->size;
  for (int i = 0; i < clump->n; i++) {
    const double *x = clump->x + 3 * (long) i, a = clump->a[i];
    mask[i] = sd_multiblob_whole(m);
    for (int j = 0; j < clump->n; j++) {
      if (j == i || !inside(x, clump->x + 3 * (long) j, a + clump->a[j] - hair)) continue;
      mask[i] &= ~SD_MULTIBLOB_WHOLE;
      for (int k = 0; k < m->n; k++) {
        double p[3];
        sd_multiply3(turn, m->r + 3 * k, p);
        for (int d = 0; d < 3; d++) p[d] = x[d] + a * p[d];
        if (inside(p, clump->x + 3 * (long) j, m->radius * clump->a[j]))
          mask[i] &= ~(UINT64_C(1) << k);
      }
    }
  }
}

void sd_multiblob_expand(const sd_multiblob *m, const sd_multiblob_spheres *s, double *r, double *x,
                         double *b)
{
  for (int i = 0; i < s->n; i++) {
    const double *turn = s->turn ? s->turn + 9 * (long) i : NULL, a = s->a[i];
    const sd_multiblob_mask mask = s->mask ? s->mask[i] : sd_multiblob_whole(m);
    for (int k = 0; k < m->n; k++) {
      const long row = (long) m->n * i + k;
      double arm[3];
      if (turn)
        sd_multiply3(turn, m->r + 3 * k, arm);
      else
        memcpy(arm, m->r + 3 * k, sizeof arm);
      for (int d = 0; d < 3; d++) {
        arm[d] *= a;
        x[3 * row + d] = s->x[3 * (long) i + d] + arm[d];
        if (r) r[3 * row + d] = arm[d];
      }
      b[row] = mask >> k & 1 ? a * m->point : 0.0;
    }
  }
}

void sd_multiblob_add(const sd_multiblob *m, const sd_multiblob_spheres *s, const double *w,
                      const double *r, const double *f, double *u)
{
  if (m->delta == 0.0) return;
  for (int i = 0; i < s->n; i++) {
    const long row = 3L * m->n * i;
    if (!sd_multiblob_is_whole(s, i)) continue;
    sd_multiblob_one_body(m, s->a[i], 1.0 / (w[i] * w[i]), r + row, f + row, u + row);
  }
}

void sd_multiblob_moments(int points, int spheres, const double *r, const double *f, double *S)
{
  static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
  for (long i = 0; i < spheres; i++) {
    double *sum = S + 6 * i;
    for (long k = points * i; k < points * (i + 1); k++) {
      const double *arm = r + 3 * k, *force = f + 3 * k, trace = sd_dot(arm, force) / 3.0;
      for (int e = 0; e < 6; e++) {
        const int p = row[e], q = column[e];
        sum[e] += 0.5 * (arm[p] * force[q] + arm[q] * force[p]) - (p == q ? trace : 0.0);
      }
    }
  }
}
