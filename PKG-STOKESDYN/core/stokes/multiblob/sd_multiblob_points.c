#include "sd_multiblob_points.h"

#include <string.h>

#include "sd_constants.h"
#include "sd_linear.h"

static int inside(const double p[3], const double centre[3], double radius)
{
  return sd_distance_squared(p, centre) < radius * radius;
}

static void set(sd_multiblob_mask *mask, int bit, int value)
{
  const uint64_t one = UINT64_C(1) << bit % 64;
  if (value)
    mask->word[bit / 64] |= one;
  else
    mask->word[bit / 64] &= ~one;
}

sd_multiblob_mask sd_multiblob_whole(const sd_multiblob *m)
{
  sd_multiblob_mask mask = {{0}};
  for (int bit = 0; bit <= m->n; bit++) set(&mask, bit, 1);
  return mask;
}

/* Member i loses what is inside member j. */
static void points_cut(const sd_multiblob *of_i, const sd_multiblob *of_j, const sd_shape *clump, int i,
                       int j, const double turn[9], sd_multiblob_mask *mask)
{
  const double *x = clump->x + 3 * (long) i, a = clump->a[i];
  set(mask, 0, 0);
  for (int k = 0; k < of_i->n; k++) {
    double p[3];
    sd_multiply3(turn, of_i->r + 3 * k, p);
    for (int d = 0; d < 3; d++) p[d] = x[d] + a * p[d];
    if (inside(p, clump->x + 3 * (long) j, of_j->radius * clump->a[j])) set(mask, 1 + k, 0);
  }
}

void sd_multiblob_masks(const sd_multiblob *m, const int *kind, const sd_shape *clump,
                        const double turn[9], sd_multiblob_mask *mask)
{
  const double hair = SD_SHAPE_TOLERANCE * clump->size;
  for (int i = 0; i < clump->n; i++) {
    const double *x = clump->x + 3 * (long) i, a = clump->a[i];
    const sd_multiblob *of_i = m + (kind ? kind[i] : 0);
    mask[i] = sd_multiblob_whole(of_i);
    for (int j = 0; j < clump->n; j++)
      if (j != i && inside(x, clump->x + 3 * (long) j, a + clump->a[j] - hair))
        points_cut(of_i, m + (kind ? kind[j] : 0), clump, i, j, turn, mask + i);
  }
}

void sd_multiblob_expand(const sd_multiblob *models, const sd_multiblob_spheres *s, double *r,
                         double *x, double *b)
{
  for (int i = 0; i < s->n; i++) {
    const sd_multiblob *m = sd_multiblob_of(models, s, i);
    const double *turn = s->turn ? s->turn + 9 * (long) i : NULL, a = s->a[i];
    const long first = sd_multiblob_first(models, s, i);
    for (int k = 0; k < m->n; k++) {
      const long row = first + k;
      double arm[3];
      if (turn)
        sd_multiply3(turn, m->r + 3 * k, arm);
      else
        memcpy(arm, m->r + 3 * k, sizeof arm);
      for (int d = 0; d < 3; d++) {
        arm[d] *= a;
        if (x) x[3 * row + d] = s->x[3 * (long) i + d] + arm[d];
        if (r) r[3 * row + d] = arm[d];
      }
      b[row] = !s->mask || sd_multiblob_has_point(s->mask + i, k) ? a * m->point : 0.0;
    }
  }
}

void sd_multiblob_add(const void *ctx, int begin, int end, const double *f, double *u)
{
  const sd_multiblob_additions *of = ctx;
  const sd_multiblob_spheres *s = &of->spheres;
  for (int i = begin; i < end; i++) {
    const sd_multiblob *m = sd_multiblob_of(of->model, s, i);
    const long row = 3 * sd_multiblob_first(of->model, s, i);
    if (m->delta == 0.0 || !sd_multiblob_is_whole(s, i)) continue;
    sd_multiblob_one_body(m, s->a[i], 1.0 / (of->w[i] * of->w[i]), of->r + row, f + row, u + row);
  }
}

void sd_multiblob_drags(const sd_multiblob_additions *points, const double *b, double *D)
{
  const sd_multiblob_spheres *s = &points->spheres;
  for (long i = 0; i < s->n; i++) {
    const double w = points->w[i];
    const long first = sd_multiblob_first(points->model, s, i);
    for (long k = first; k < first + sd_multiblob_of(points->model, s, i)->n; k++)
      for (int d = 0; d < 3; d++) D[3 * k + d] = b[k] > 0.0 ? 6.0 * SD_PI * b[k] / (w * w) : 1.0;
  }
}

void sd_multiblob_moment(long points, const double *r, const double *f, double S[6])
{
  for (long k = 0; k < points; k++) sd_add_deviator(1.0, r + 3 * k, f + 3 * k, S);
}

void sd_multiblob_moments(int spheres, const int *first, const double *r, const double *f, double *S)
{
  for (long i = 0; i < spheres; i++)
    sd_multiblob_moment(first[i + 1] - first[i], r + 3L * first[i], f + 3L * first[i], S + 6 * i);
}

void sd_multiblob_forces(int spheres, const int *first, const double *f, double *F)
{
  for (long i = 0; i < spheres; i++)
    for (long k = first[i]; k < first[i + 1]; k++)
      for (int d = 0; d < 3; d++) F[3 * i + d] += f[3 * k + d];
}

void sd_multiblob_moments_at(int spheres, const double *arm, const double *F, double *S)
{
  for (long i = 0; i < spheres; i++) sd_multiblob_moment(1, arm + 3 * i, F + 3 * i, S + 6 * i);
}
