#include "sd_clump_internal.h"

#include "sd_linear.h"
#include "sd_room.h"
#include "sd_tensor.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* --- shells ----------------------------------------------------------------------------------- */

static sd_status get_shell(sd_shells *cache, int n, const sd_shell **shell)
{
  const int size = sd_shell_size(n);
  for (int i = 0; i < cache->count; i++)
    if (cache->shell[i].n == size) {
      *shell = cache->shell + i;
      return SD_OK;
    }
  if (!sd_grow(&cache->shell, sizeof(sd_shell), (size_t) cache->count + 1)) return SD_ENOMEMORY;
  const sd_status status = sd_shell_create(size, cache->shell + cache->count);
  if (status == SD_OK) *shell = cache->shell + cache->count++;
  return status;
}

/* --- points of the surface -------------------------------------------------------------------- */

void sd_surface_free(sd_surface *s)
{
  free(s->x);
  free(s->a);
  free(s->sphere);
}

/* A point is hidden when it lies deeper inside the shell of another sphere than this, in radii of
 * that shell's points. Along the seam of two spheres both keep what would leave a gap as wide as
 * their spacing; deeper, points of nearly coincident spheres double. 0.4 makes the drag of pairs
 * and rows at any overlap (0.1 to 1.9 radii apart) as accurate as that of touching spheres. */
static const double seam = 0.4;

/* Where the points of a shell stand for a surface, and the radius of points there. Those of
 * SD_SHELL_FAT stand deep inside their sphere: for it those that twelve points apart would have. */
static void surface_of(const sd_shell *shell, double *radius, double *point)
{
  *radius = shell->n == SD_SHELL_FAT ? 0.9364 : shell->radius;
  *point = shell->n == SD_SHELL_FAT ? 0.2862 : shell->point;
}

/* Is p inside one of the spheres but its own, whose radii are given? */
static int hidden(const sd_shape *s, const double *radius, int own, const double p[3])
{
  for (int j = 0; j < s->n; j++) {
    if (j != own && sd_distance_squared(p, s->x + 3 * j) < radius[j] * radius[j]) return 1;
  }
  return 0;
}

/* A hair inside, so that spheres that only touch, within the tolerance of shapes, hide nothing of
 * each other, and points of a symmetric shape that lie on two spheres are not decided by
 * rounding. */
static const double hair = 1.7 * SD_SHAPE_TOLERANCE;

sd_status sd_surface_exposed(const sd_shape *s, sd_shells *cache, double *fraction)
{
  enum { FINE = 642 };
  const sd_shell *fine = NULL;
  sd_status status = SD_OK;
  double *radius = malloc(sizeof(double) * (size_t) s->n);
  if (!radius) return SD_ENOMEMORY;
  for (int i = 0; i < s->n; i++) radius[i] = (1.0 - hair) * s->a[i];
  for (int i = 0; i < s->n && status == SD_OK; i++) {
    int overlaps = 0, count = 0;
    for (int j = 0; j < s->n && !overlaps; j++) {
      const double reach = s->a[i] + radius[j];
      overlaps = j != i && sd_distance_squared(s->x + 3 * i, s->x + 3 * j) < reach * reach;
    }
    fraction[i] = 1.0;
    if (!overlaps) continue;
    status = get_shell(cache, FINE, &fine);
    for (int m = 0; m < FINE && status == SD_OK; m++) {
      double e[3], p[3];
      sd_multiply3(s->frame, fine->p + 3 * m, e);
      for (int d = 0; d < 3; d++) p[d] = s->x[3 * i + d] + s->a[i] * e[d];
      count += !hidden(s, radius, i, p);
    }
    fraction[i] = (double) count / FINE;
  }
  free(radius);
  return status;
}

enum { FEWEST = 12, MOST = 642 };

/* Points in proportion to the area, so that their spacing is the same on all spheres, and in all as
 * many as n for each sphere that shows. Small spheres beside large ones keep at least the coarsest
 * shell; of a large one, more than MOST points add nothing. */
void sd_surface_share(const sd_shape *s, int n, const double *fraction, int *count)
{
  const double most = fmin(fmax(MOST, 4.0 * n), INT_MAX);
  double area = 0.0;
  int visible = 0;
  for (int i = 0; i < s->n; i++) {
    const double w = fraction ? fraction[i] : 1.0;
    area += w * s->a[i] * s->a[i];
    visible += w > 0.0;
  }
  for (int i = 0; i < s->n; i++) {
    /* equal radii must give n itself, not the next number because of rounding */
    const double share = area > 0.0 ? ceil(n * s->a[i] * s->a[i] * visible / area - 1e-4) : n;
    count[i] = sd_shell_size((int) fmin(most, fmax(FEWEST, share)));
  }
}

int sd_surface_orientations(int n)
{
  /* so many that each sphere has 96 points or more in all: eight icosahedra, one shell from 96
   * points on */
  return n == 1 ? 1 : 1 + (96 - 1) / n;
}

/* Number k: the first is the frame itself, the others spread evenly over all rotations (unit quaternions from a
 * three-dimensional additive sequence). */
static void orientation(int k, double Q[9])
{
  const double t = fmod(k * 0.8191725133961645, 1.0),
               u = 2.0 * SD_PI * fmod(k * 0.6710436067037893, 1.0),
               v = 2.0 * SD_PI * fmod(k * 0.5497004779019703, 1.0);
  const double w = k ? sqrt(1.0 - t) * sin(u) : 1.0, x = k ? sqrt(1.0 - t) * cos(u) : 0.0;
  const double y = sqrt(t) * sin(v), z = sqrt(t) * cos(v);
  const double R[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
                       2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                       2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
  memcpy(Q, R, sizeof(R));
}

static sd_status surface_allocate(sd_surface *s, size_t n)
{
  s->x = malloc(sizeof(double) * 3 * n);
  s->a = malloc(sizeof(double) * n);
  s->sphere = malloc(sizeof(int) * n);
  return s->x && s->a && s->sphere ? SD_OK : SD_ENOMEMORY;
}

sd_status sd_surface_of_centres(const sd_shape *s, sd_surface *out)
{
  *out = (sd_surface){.n = s->n};
  if (surface_allocate(out, (size_t) s->n) != SD_OK) return SD_ENOMEMORY;
  memcpy(out->x, s->x, sizeof(double) * 3 * (size_t) s->n);
  memcpy(out->a, s->a, sizeof(double) * (size_t) s->n);
  for (int i = 0; i < s->n; i++) out->sphere[i] = i;
  return SD_OK;
}

/* Twice over the spheres: how deep is hidden and how many points there are at most, then the
 * points. */
sd_status sd_surface_of_shells(const sd_shape *s, const int *count, int number, sd_shells *cache,
                               sd_surface *out)
{
  size_t total = 0;
  double Q[9], G[9], radius, point;
  const sd_shell *shell;
  sd_status status = SD_OK;
  *out = (sd_surface){.number = number};
  double *deep = malloc(sizeof(double) * (size_t) s->n);
  if (!deep) return SD_ENOMEMORY;
  for (int i = 0; i < s->n && status == SD_OK; i++) {
    status = get_shell(cache, count[i], &shell);
    if (status != SD_OK) break;
    surface_of(shell, &radius, &point);
    deep[i] = (radius - seam * point) * s->a[i];
    total += (size_t) shell->n;
  }
  if (status == SD_OK) status = surface_allocate(out, total);
  orientation(number, Q);
  sd_product3(s->frame, Q, G);
  for (int i = 0; i < s->n && status == SD_OK; i++) {
    status = get_shell(cache, count[i], &shell);
    surface_of(shell, &radius, &point);
    for (int m = 0; m < shell->n; m++) {
      double e[3], *p = out->x + 3 * (size_t) out->n;
      sd_multiply3(G, shell->p + 3 * m, e);
      for (int d = 0; d < 3; d++) p[d] = s->x[3 * i + d] + radius * s->a[i] * e[d];
      if (hidden(s, deep, i, p)) continue;
      for (int d = 0; d < 3; d++) p[d] = s->x[3 * i + d] + shell->radius * s->a[i] * e[d];
      out->a[out->n] = shell->point * s->a[i];
      out->sphere[out->n++] = i;
    }
  }
  free(deep);
  return status;
}
