#include "sd_multiblob_wall.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_body_shape.h"
#include "sd_linear.h"
#include "sd_wall_film.h"

/* The lone shell of radius 1 in a fluid of viscosity 1, its centre `height` above a wall at 0, r its
 * points from there */
static sd_status lone_shell(const sd_multiblob *m, const sd_wall *wall, double height,
                            const double *r, int one_body, sd_body_shape *out)
{
  const size_t N = 3 * (size_t) m->n;
  double x[3 * SD_MULTIBLOB_MOST], b[SD_MULTIBLOB_MOST], *M = malloc(sizeof(double) * N * N);
  if (!M) return SD_ENOMEMORY;
  memcpy(x, r, sizeof(double) * N);
  for (int k = 0; k < m->n; k++) {
    x[3 * k + wall->axis] += wall->sign * height;
    b[k] = m->point;
  }
  sd_wall_matrix(wall, m->n, 3, x, b, M);
  if (one_body) sd_multiblob_one_body_matrix(m, 1.0, r, N, M);
  const sd_status status = sd_body_shape_of(m->n, 3, r, b, M, out);
  free(M);
  return status;
}

/* B, E -= the points'; along: the flow at the centre */
static void take_off_points(const sd_body_shape *points, const sd_wall *wall, double height,
                            const double along[3], double B[36], double E[6])
{
  for (int e = 0; e < 36; e++) B[e] -= points->resistance[e];
  for (int k = 0; k < points->m; k++) {
    const double there = height + wall->sign * points->x[3 * k + wall->axis];
    for (int d = 0; d < 3; d++)
      for (int p = 0; p < 6; p++)
        E[p] -= points->rigid[6 * (3 * k + d) + p] * along[d] * there / height;
  }
}

static void clip(double B[36])
{
  double w[6], V[36];
  sd_eigen(6, B, w, V);
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 6; q++) {
      B[6 * p + q] = 0.0;
      for (int k = 0; k < 6; k++) B[6 * p + q] += fmax(w[k], 0.0) * V[6 * p + k] * V[6 * q + k];
    }
}

/* 1 to half of the end, then as the films of pairs end (sd_lubrication.h) */
static double fading(double gap)
{
  const double half = 0.5 * SD_MULTIBLOB_WALL_END, s = fmax(gap - half, 0.0) / half;
  return 1.0 - s * s * (3.0 - 2.0 * s);
}

static void give_units(double a, double scale, double B[36], double E[6])
{
  const double length[2] = {1.0, a};
  for (int p = 0; p < 6; p++) {
    for (int q = 0; q < 6; q++) B[6 * p + q] *= scale * length[p > 2] * length[q > 2];
    E[p] *= scale * length[p > 2];
  }
}

sd_status sd_multiblob_wall_film(const sd_multiblob_sphere *s, const sd_wall *wall, double floor,
                                 double eta, const double u[3], double B[36], double E[6])
{
  const double a = s->a;
  const double gap = fmax(sd_wall_height(wall, s->x) / a - 1.0, floor), height = 1.0 + gap;
  const sd_wall ground = {wall->axis, wall->sign, 0.0};
  double e[3] = {0.0}, along[3] = {0.0}, own[3 * SD_MULTIBLOB_MOST];
  memset(B, 0, 36 * sizeof(double));
  memset(E, 0, 6 * sizeof(double));
  if (gap >= SD_MULTIBLOB_WALL_END) return SD_OK;
  e[wall->axis] = wall->sign;
  if (u) memcpy(along, u, sizeof along);
  along[wall->axis] = 0.0;
  for (int k = 0; k < 3 * s->model->n; k++) own[k] = s->r[k] / a;
  sd_body_shape points;
  const sd_status status = lone_shell(s->model, &ground, height, own, s->one_body, &points);
  if (status != SD_OK) return status;
  const sd_wall_film exact = sd_wall_film_exact(1.0, height, floor);
  sd_wall_film_matrix(&exact, e, 1.0, B);
  sd_wall_film_flow(&exact, e, 1.0, along, E);
  take_off_points(&points, &ground, height, along, B, E);
  sd_body_shape_free(&points);
  clip(B);
  give_units(a, eta * a * fading(gap), B, E);
  return SD_OK;
}
