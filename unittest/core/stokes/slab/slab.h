/* Spheres in a box that is periodic in two directions, on one rank: their images along it as ghosts, and the engine
 * slab placed among them. */
#ifndef SLAB_H
#define SLAB_H

#include "check.h"

#include "sd_constants.h"
#include "sd_mobility.h"

#include <string.h>

typedef struct {
  int n, n_all;
  double *x, *a, *w; /* [n_all], images after the spheres */
  int *owner;        /* [n_all] whose image it is */
  sd_slab slab;
  sd_mobility omega;
} slab;

static inline sd_status slab_refresh(void *ctx, const double *rows, double *ghosts, int width)
{
  const slab *s = ctx;
  for (int g = s->n; g < s->n_all; g++)
    memcpy(ghosts + width * (g - s->n), rows + width * s->owner[g], sizeof(double) * (size_t) width);
  return SD_OK;
}

/* A box with two edges along the walls of an axis */
static inline sd_ewald_box slab_box(int axis, double lx, double ly)
{
  sd_ewald_box box = {.periodic = 1};
  box.edge[(axis + 1) % 3] = lx;
  box.edge[(axis + 2) % 3] = ly;
  return box;
}

static inline sd_status slab_choose(const sd_slab_walls *walls, const sd_ewald_box *box, const double *x,
                                    const double *a, int n, double tolerance, sd_slab *out)
{
  sd_slab_spheres s = {.smallest = INFINITY, .lo = INFINITY, .hi = -INFINITY};
  for (int i = 0; i < n; i++) s.sizes.all.largest = fmax(s.sizes.all.largest, a[i]);
  for (int i = 0; i < n; i++) {
    if (!(a[i] > 0.0)) continue;
    sd_ewald_count(&s.sizes, a[i], 1);
    s.smallest = fmin(s.smallest, a[i]);
    s.lo = fmin(s.lo, sd_slab_height(walls, x + 3 * i));
    s.hi = fmax(s.hi, sd_slab_height(walls, x + 3 * i));
  }
  return sd_slab_choose(walls, box, &s, tolerance, out);
}

/* All images along the slab that a sphere may see */
static inline void slab_images(slab *s, const double *x, const double *a, const double *w)
{
  const int axis = s->slab.walls.wall->axis, d[2] = {(axis + 1) % 3, (axis + 2) % 3};
  const double *edge = s->slab.ewald.box.edge, reach = s->slab.ewald.reach;
  double lo[2] = {INFINITY, INFINITY}, hi[2] = {-INFINITY, -INFINITY};
  int most[2];
  for (int i = 0; i < s->n; i++)
    for (int l = 0; l < 2; l++) {
      lo[l] = fmin(lo[l], x[3 * i + d[l]]);
      hi[l] = fmax(hi[l], x[3 * i + d[l]]);
    }
  for (int l = 0; l < 2; l++) most[l] = (int) ceil((hi[l] - lo[l] + reach) / edge[d[l]]);
  const size_t room = (size_t) s->n * (2 * (size_t) most[0] + 1) * (2 * (size_t) most[1] + 1);
  s->x = malloc(sizeof(double) * 3 * room);
  s->a = malloc(sizeof(double) * room);
  s->w = malloc(sizeof(double) * room);
  s->owner = malloc(sizeof(int) * room);
  s->n_all = 0;
  for (int pass = 0; pass < 2; pass++)
    for (int k = -most[0]; k <= most[0]; k++)
      for (int m = -most[1]; m <= most[1]; m++) {
        if ((k == 0 && m == 0) != (pass == 0)) continue;
        for (int i = 0; i < s->n; i++) {
          double *y = s->x + 3 * s->n_all;
          memcpy(y, x + 3 * i, 3 * sizeof(double));
          y[d[0]] += k * edge[d[0]];
          y[d[1]] += m * edge[d[1]];
          int near = 1;
          for (int l = 0; l < 2; l++) near = near && y[d[l]] >= lo[l] - reach && y[d[l]] <= hi[l] + reach;
          if (!near && pass == 1) continue;
          s->a[s->n_all] = a[i];
          s->w[s->n_all] = w ? w[i] : 1.0;
          s->owner[s->n_all++] = i;
        }
      }
}

static inline sd_status slab_try(slab *s, const sd_slab *how, const double *x, const double *a, const double *w, int n)
{
  memset(s, 0, sizeof(*s));
  s->n = n;
  s->slab = *how;
  slab_images(s, x, a, w);
  const sd_mobility_scene scene = {.how = {.law = {.tensor = SD_TENSOR_RPY}, .width = 3, .slab = &s->slab},
                                   .n = n,
                                   .n_all = s->n_all,
                                   .spheres = {s->x, s->a, s->w},
                                   .world = {.ctx = s, .refresh = slab_refresh}};
  return sd_mobility_place(&s->omega, &sd_mobility_slab, &scene);
}

static inline void slab_place(slab *s, const sd_slab_walls *walls, const sd_ewald_box *box, const double *x,
                              const double *a, int n, double tolerance)
{
  sd_slab how = {0};
  assert_int_equal(slab_choose(walls, box, x, a, n, tolerance, &how), SD_OK);
  assert_int_equal(slab_try(s, &how, x, a, NULL, n), SD_OK);
}

static inline void slab_free(slab *s)
{
  sd_mobility_free(&s->omega);
  free(s->x);
  free(s->a);
  free(s->w);
  free(s->owner);
}

/* u = M F, the whole mobility: the engine's part and the sphere's own */
static inline void slab_apply(slab *s, const double *F, double *u)
{
  assert_int_equal(sd_mobility_apply(&s->omega, F, u), SD_OK);
  for (int i = 0; i < s->n; i++)
    for (int d = 0; d < 3 && s->a[i] > 0.0; d++)
      u[3 * i + d] += s->w[i] * s->w[i] * F[3 * i + d] / (6.0 * SD_PI * s->a[i]);
}

/* All of it at once */
static inline void slab_velocities(const sd_slab_walls *walls, const sd_ewald_box *box, const double *x,
                                   const double *a, int n, double tolerance, const double *F, double *u)
{
  slab s;
  slab_place(&s, walls, box, x, a, n, tolerance);
  slab_apply(&s, F, u);
  slab_free(&s);
}

#endif
