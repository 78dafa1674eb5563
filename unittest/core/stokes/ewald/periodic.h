/* Spheres in a periodic box on one rank: their images as ghosts, as LAMMPS would have them, and the engine ewald placed
 * among them. */
#ifndef PERIODIC_H
#define PERIODIC_H

#include "check.h"

#include "sd_mobility.h"
#include "sd_tensor.h"

#include <string.h>

typedef struct {
  int n, n_all, width;
  double *x, *a, *w; /* [n_all], images after the spheres */
  int *owner;        /* [n_all] whose image it is */
  sd_ewald ewald;
  sd_ewald_level second; /* from 0: there is none */
  sd_mobility omega;
} periodic;

static inline sd_status periodic_refresh(void *ctx, const double *rows, double *ghosts, int width)
{
  const periodic *p = ctx;
  for (int g = p->n; g < p->n_all; g++)
    memcpy(ghosts + width * (g - p->n), rows + width * p->owner[g], sizeof(double) * (size_t) width);
  return SD_OK;
}

static inline sd_ewald_sizes periodic_sizes(const double *a, int n)
{
  sd_ewald_sizes s = {0};
  for (int i = 0; i < n; i++) s.all.largest = fmax(s.all.largest, a[i]);
  for (int i = 0; i < n; i++)
    if (a[i] > 0.0) sd_ewald_count(&s, a[i], 1);
  return s;
}

static inline void periodic_edges(const sd_ewald_box *b, double edge[3][3])
{
  const double e[3][3] = {{b->edge[0], 0, 0}, {b->tilt[0], b->edge[1], 0}, {b->tilt[1], b->tilt[2], b->edge[2]}};
  memcpy(edge, e, sizeof(e));
}

/* Widths of the box: distances between opposite faces */
static inline void periodic_widths(const sd_ewald_box *b, double *width)
{
  double e[3][3];
  periodic_edges(b, e);
  const double V = sd_ewald_volume(b);
  for (int d = 0; d < 3; d++) {
    const double *p = e[(d + 1) % 3], *q = e[(d + 2) % 3];
    const double c[3] = {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
    width[d] = V / sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
  }
}

/* Coordinates in edges of the box */
static inline void periodic_fractions(const sd_ewald_box *b, const double *x, double *f)
{
  const double r[3] = {x[0] - b->origin[0], x[1] - b->origin[1], x[2] - b->origin[2]};
  f[2] = r[2] / b->edge[2];
  f[1] = (r[1] - b->tilt[2] * f[2]) / b->edge[1];
  f[0] = (r[0] - b->tilt[0] * f[1] - b->tilt[1] * f[2]) / b->edge[0];
}

/* All images that a sphere of the box may see: within reach of its faces. The spheres themselves stay where they
   are. */
static inline void periodic_images(periodic *p, const double *x, const double *a, const double *w)
{
  const sd_ewald_box *b = &p->ewald.box;
  double edge[3][3], width[3], least[3] = {0}, most[3] = {0};
  periodic_edges(b, edge);
  periodic_widths(b, width);
  for (int i = 0; i < p->n; i++) {
    double f[3];
    periodic_fractions(b, x + 3 * i, f);
    for (int d = 0; d < 3; d++) {
      least[d] = i == 0 ? f[d] : fmin(least[d], f[d]);
      most[d] = i == 0 ? f[d] : fmax(most[d], f[d]);
    }
  }
  int shifts[3];
  for (int d = 0; d < 3; d++) shifts[d] = (int) floor(p->ewald.reach / width[d] + most[d] - least[d]);
  long room = p->n;
  for (int d = 0; d < 3; d++) room *= 2 * shifts[d] + 1;
  p->x = malloc(sizeof(double) * 3 * (size_t) room);
  p->a = malloc(sizeof(double) * (size_t) room);
  p->w = malloc(sizeof(double) * (size_t) room);
  p->owner = malloc(sizeof(int) * (size_t) room);
  p->n_all = 0;
  for (int pass = 0; pass < 2; pass++)
    for (int k = -shifts[0]; k <= shifts[0]; k++)
      for (int l = -shifts[1]; l <= shifts[1]; l++)
        for (int m = -shifts[2]; m <= shifts[2]; m++) {
          if ((k == 0 && l == 0 && m == 0) != (pass == 0)) continue;
          for (int i = 0; i < p->n; i++) {
            double f[3], *y = p->x + 3 * p->n_all;
            for (int d = 0; d < 3; d++) y[d] = x[3 * i + d] + k * edge[0][d] + l * edge[1][d] + m * edge[2][d];
            periodic_fractions(b, y, f);
            int near = 1;
            for (int d = 0; d < 3; d++) {
              const double margin = p->ewald.reach / width[d];
              near = near && f[d] >= least[d] - margin && f[d] <= most[d] + margin;
            }
            if (!near && pass == 1) continue;
            p->a[p->n_all] = a[i];
            p->w[p->n_all] = w ? w[i] : 1.0;
            p->owner[p->n_all++] = i;
          }
        }
}

/* The engine of one level or of two */
static inline const sd_mobility_engine *periodic_engine(const sd_ewald_level *second)
{
  return second->from > 0.0 ? &sd_mobility_levels : &sd_mobility_ewald;
}

/* With two levels that are given */
static inline void periodic_place_levels(periodic *p, const double *x, const double *a, const double *w, int n,
                                         int width, const sd_ewald *first, const sd_ewald_level *second)
{
  memset(p, 0, sizeof(*p));
  p->n = n;
  p->width = width;
  p->ewald = *first;
  p->second = *second;
  periodic_images(p, x, a, w);
  sd_mobility_scene scene = {
      .how = {.law = {.tensor = SD_TENSOR_RPY}, .width = width, .ewald = &p->ewald, .second = &p->second},
                             .n = n,
                             .n_all = p->n_all,
                             .spheres = {p->x, p->a, p->w},
                             .world = {.ctx = p, .refresh = periodic_refresh}};
  assert_int_equal(sd_mobility_place(&p->omega, periodic_engine(second), &scene), SD_OK);
}

/* With a splitting that is given */
static inline void periodic_place(periodic *p, const double *x, const double *a, const double *w, int n, int width,
                                  const sd_ewald *how)
{
  const sd_ewald_level none = {0};
  periodic_place_levels(p, x, a, w, n, width, how, &none);
}

static inline void periodic_free(periodic *p)
{
  sd_mobility_free(&p->omega);
  free(p->x);
  free(p->a);
  free(p->w);
  free(p->owner);
}

/* Splitting by the rule */
static inline sd_ewald periodic_choose(const sd_ewald_box *box, const double *a, int n, int width, double tolerance)
{
  sd_ewald how;
  const sd_ewald_sizes sizes = periodic_sizes(a, n);
  assert_int_equal(sd_ewald_choose(box, &sizes, width, tolerance, &how), SD_OK);
  return how;
}

/* u = M F, the whole mobility: the engine's part and the sphere's own */
static inline void periodic_apply(periodic *p, const double *F, double *u)
{
  assert_int_equal(sd_mobility_apply(&p->omega, F, u), SD_OK);
  for (int i = 0; i < p->n; i++)
    for (int d = 0; d < p->width && p->a[i] > 0.0; d++) {
      const double a = p->a[i], w2 = p->w[i] * p->w[i];
      u[p->width * i + d] += w2 * F[p->width * i + d] / (d < 3 ? 6.0 * SD_PI * a : 8.0 * SD_PI * a * a * a);
    }
}

#endif
