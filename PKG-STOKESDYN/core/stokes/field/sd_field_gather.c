/* Velocities from the grid of a wave part at the points of a regular grid. The coordinate of the
 * waves' grid along z follows from z alone, that along y from y and z: so windows are summed along z
 * for a plane of points, then along y for a row, and along x last, P points each time instead of
 * P^3. */
#include "sd_field_internal.h"

#include <math.h>
#include <stdlib.h>

#include "sd_room.h"

/* Grid coordinate d of a point */
static double coordinate(const sd_ewald_waves *w, int d, const double *x)
{
  const sd_ewald_box *b = &w->ewald.box;
  double s = b->periodic ? 0.0 : 0.5 * w->ewald.points;
  for (int c = 0; c < 3; c++) s += w->spreading.gradient[d][c] * (x[c] - b->origin[c]);
  return s;
}

static void place_window(const sd_ewald_waves *w, int d, double s, sd_field_place *p)
{
  const sd_window *window = &w->window;
  const double half = 0.5 * window->points, first = floor(s - half);
  const double v = 2.0 * (s - half - first) - 1.0;
  const int period = w->ewald.grid[d];
  p->at = (int) first + 1;
  if (w->ewald.box.periodic) p->at = (p->at % period + period) % period;
  for (int k = 0; k < window->points; k++) {
    double value = window->coefficient[window->degree][k];
    for (int m = window->degree - 1; m >= 0; m--) value = value * v + window->coefficient[m][k];
    p->value[k] = value;
  }
}

typedef struct {
  const sd_ewald_waves *w;
  const sd_field_grid *g;
  const struct sd_field_kernels *kernels;
  /* of the points of a row, made anew only where it differs from row to row */
  sd_field_place *of_row;
  int oblique, made;
  /* velocities on the waves' grid in some planes of z, on the line of y and z, and at the points of a
   * row: three numbers and a free one each, x fastest: [planes][n1][n0], [n0], [points] */
  double *planes, *line, *row;
} gathering;

/* So many planes at once: of the columns of the waves' grid, which lie far from each other in memory,
 * whole lines of the cache are read, and the planes stay in the last level of it. */
enum { PLANES = 16 };

static void sum_along_z(const gathering *q, const sd_field_place *z, int planes)
{
  const sd_spreading *s = &q->w->spreading;
  const int *n = q->w->grid.n;
  const long size = 4L * n[0] * n[1];
  for (int pair = 0; pair < n[0]; pair += 2) /* two share a line of the cache in the planes */
    for (int j = 0; j < n[1]; j++)
      for (int i = pair; i < pair + 2 && i < n[0]; i++) {
        const sd_field_line line = {(const double *) s->brick + i * s->layer + j * s->row, 3, s->row};
        q->kernels->windows(z, planes, q->w->window.points, &line, q->planes + 4L * (j * (long) n[0] + i), size);
      }
}

static void sum_along_y(const gathering *q, const double *plane, const sd_field_place *y)
{
  const long row = 4L * q->w->grid.n[0];
  q->kernels->rows(y->value, q->w->window.points, plane + y->at * row, row, q->line);
}

static void sum_along_x(gathering *q, const double *x, double *u)
{
  const int points = q->g->n[0];
  if (!q->made || q->oblique)
    for (int i = 0; i < points; i++) {
      const double at[3] = {q->g->lo[0] + i * q->g->step[0], x[1], x[2]};
      place_window(q->w, 0, coordinate(q->w, 0, at), q->of_row + i);
    }
  q->made = 1;
  const sd_field_line line = {q->line, 4, 0};
  q->kernels->windows(q->of_row, points, q->w->window.points, &line, q->row, 4);
  for (int i = 0; i < points; i++)
    for (int d = 0; d < 3; d++) u[3 * i + d] += q->row[4 * i + d];
}

static void gather_plane(gathering *q, int k, const double *plane, double *u)
{
  const sd_field_grid *g = q->g;
  for (int j = 0; j < g->n[1]; j++) {
    const double x[3] = {0.0, g->lo[1] + j * g->step[1], g->lo[2] + k * g->step[2]};
    sd_field_place y;
    place_window(q->w, 1, coordinate(q->w, 1, x), &y);
    sum_along_y(q, plane, &y);
    sum_along_x(q, x, u + 3 * ((long) (k - g->from) * g->n[1] + j) * g->n[0]);
  }
}

sd_status sd_field_gather(sd_field *f, const sd_field_grid *g,
                          const struct sd_field_kernels *kernels, double *u)
{
  const sd_ewald_waves *w = &f->waves;
  const double *G = w->spreading.gradient[0];
  const int most = g->to - g->from < PLANES ? g->to - g->from : PLANES;
  const size_t plane = 4 * (size_t) w->grid.n[0] * (size_t) w->grid.n[1];
  const size_t line = 4 * (size_t) w->grid.n[0], row = 4 * (size_t) g->n[0];
  gathering q = {.w = w, .g = g, .kernels = kernels, .oblique = G[1] != 0.0 || G[2] != 0.0};
  q.of_row = malloc(sizeof(sd_field_place) * (size_t) g->n[0]);
  const int ok = q.of_row && sd_reserve(&f->scratch, sizeof(double),
                                        (size_t) most * plane + line + row, &f->scratch_room);
  q.planes = f->scratch;
  q.line = q.planes + (size_t) most * plane;
  q.row = q.line + line;
  for (int k = g->from; k < g->to && ok; k += PLANES) {
    const int planes = g->to - k < PLANES ? g->to - k : PLANES;
    sd_field_place z[PLANES];
    for (int b = 0; b < planes; b++) {
      const double x[3] = {0.0, 0.0, g->lo[2] + (k + b) * g->step[2]};
      place_window(w, 2, coordinate(w, 2, x), z + b);
    }
    sum_along_z(&q, z, planes);
    for (int b = 0; b < planes; b++) gather_plane(&q, k + b, q.planes + (size_t) b * plane, u);
  }
  free(q.of_row);
  return ok ? SD_OK : SD_ENOMEMORY;
}
