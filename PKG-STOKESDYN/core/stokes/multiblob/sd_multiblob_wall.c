#include "sd_multiblob_wall.h"

#include <math.h>
#include <string.h>

#include "sd_body_shape.h"
#include "sd_linear.h"
#include "sd_wall_film.h"

/* The motions U W of the sphere, and the flow */
enum { FLOW = 6, COLUMNS = 7 };

/* The lone shell of radius 1 in a fluid of viscosity 1, `height` above a wall at 0 */
typedef struct {
  const sd_multiblob *m;
  sd_wall wall;
  double height, e[3];
  /* [N] from the centre, [N] where they are, [n] radii; [N N]; [COLUMNS][N] velocities, and their
   * forces */
  double *r, *x, *b, *M, *v, *f;
} lone_shell;

long sd_multiblob_wall_work(const sd_multiblob *m)
{
  const long N = 3L * m->n;
  return N * N + (2 * COLUMNS + 2) * N + m->n;
}

static void place(lone_shell *s, const double *r, double a, const double u[3])
{
  const size_t N = 3 * (size_t) s->m->n;
  memset(s->v, 0, sizeof(double) * COLUMNS * N);
  for (size_t k = 0; k < N; k += 3) {
    for (size_t d = 0; d < 3; d++) {
      s->r[k + d] = r[k + d] / a;
      s->x[k + d] = s->r[k + d] + s->height * s->e[d];
    }
    for (size_t d = 0; d < 3; d++) {
      const double unit[3] = {d == 0, d == 1, d == 2};
      s->v[d * N + k + d] = 1.0;
      sd_cross(unit, s->r + k, s->v + (3 + d) * N + k);
    }
    const double height = sd_wall_height(&s->wall, s->x + k);
    for (size_t d = 0; d < 3; d++) s->v[FLOW * N + k + d] = u[d] * height / s->height;
    s->b[k / 3] = s->m->point;
  }
}

/* B, E -= the points' */
static sd_status take_off_points(lone_shell *s, double B[36], double E[6])
{
  const size_t N = 3 * (size_t) s->m->n;
  memcpy(s->f, s->v, sizeof(double) * COLUMNS * N);
  const sd_status status = sd_cholesky_solve((int) N, s->M, COLUMNS, s->f);
  if (status != SD_OK) return status;
  for (size_t p = 0; p < 6; p++)
    for (size_t q = 0; q < COLUMNS; q++) {
      double sum = 0.0;
      for (size_t k = 0; k < N; k++) sum += s->v[p * N + k] * s->f[q * N + k];
      if (q == FLOW)
        E[p] -= sum;
      else
        B[6 * p + q] -= sum;
    }
  return SD_OK;
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

sd_status sd_multiblob_wall_film(const sd_multiblob *m, const sd_wall *wall, const double x[3],
                                 double a, const double *r, int one_body, double floor, double eta,
                                 const double u[3], double B[36], double E[6], double *work)
{
  const double rest[3] = {0.0}, gap = fmax(sd_wall_height(wall, x) / a - 1.0, floor);
  const size_t N = 3 * (size_t) m->n;
  memset(B, 0, 36 * sizeof(double));
  memset(E, 0, 6 * sizeof(double));
  if (gap >= SD_MULTIBLOB_WALL_END) return SD_OK;
  lone_shell s = {.m = m, .wall = *wall, .height = 1.0 + gap, .M = work};
  double along[3];
  s.wall.at = 0.0;
  s.e[wall->axis] = wall->sign;
  s.v = s.M + N * N;
  s.f = s.v + COLUMNS * N;
  s.r = s.f + COLUMNS * N;
  s.x = s.r + N;
  s.b = s.x + N;
  memcpy(along, u ? u : rest, sizeof along);
  along[wall->axis] = 0.0;
  place(&s, r, a, along);
  sd_body_shape_matrix(&s.wall, m->n, 3, s.x, s.b, s.M);
  if (one_body) sd_multiblob_one_body_matrix(m, 1.0, s.r, N, s.M);
  const sd_wall_film exact = sd_wall_film_exact(1.0, s.height, floor);
  sd_wall_film_matrix(&exact, s.e, 1.0, B);
  sd_wall_film_flow(&exact, s.e, 1.0, along, E);
  const sd_status status = take_off_points(&s, B, E);
  clip(B);
  give_units(a, eta * a * fading(gap), B, E);
  return status;
}
