/* Velocities from the grid of a wave part at the points of a regular grid. The coordinate of the
 * waves' grid along z follows from z alone, that along y from y and z: so windows are summed along z
 * for a plane of points, then along y for a row, and along x last, P points each time instead of
 * P^3. */
#include "sd_field_internal.h"

#include <math.h>
#include <stdlib.h>

/* First point of a window and its values */
typedef struct {
  int at;
  double value[SD_WINDOW_COLUMNS];
} place;

/* Grid coordinate d of a point */
static double coordinate(const sd_ewald_waves *w, int d, const double *x)
{
  const sd_ewald_box *b = &w->ewald.box;
  double s = b->periodic ? 0.0 : 0.5 * w->ewald.points;
  for (int c = 0; c < 3; c++) s += w->spreading.gradient[d][c] * (x[c] - b->origin[c]);
  return s;
}

static void place_window(const sd_ewald_waves *w, int d, double s, place *p)
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
  double factor;
  /* of the points of a row, made anew only where it differs from row to row */
  place *of_row;
  int oblique, made;
  /* velocities on the waves' grid in the plane of z, and on the line of y and z: [n0][n1][3], [n0][3] */
  double *plane, *line;
} gathering;

static void sum_along_z(const gathering *q, const place *z)
{
  const sd_spreading *s = &q->w->spreading;
  const int *n = q->w->grid.n, points = q->w->window.points;
  double *out = q->plane;
  for (int i = 0; i < n[0]; i++)
    for (int j = 0; j < n[1]; j++, out += 3) {
      const double *from = s->brick + i * s->layer + j * s->row + 3L * z->at;
      out[0] = out[1] = out[2] = 0.0;
      for (int k = 0; k < points; k++)
        for (int c = 0; c < 3; c++) out[c] += z->value[k] * from[3 * k + c];
    }
}

static void sum_along_y(const gathering *q, const place *y)
{
  const int *n = q->w->grid.n, points = q->w->window.points;
  for (int i = 0; i < n[0]; i++) {
    const double *from = q->plane + 3L * ((long) i * n[1] + y->at);
    double sum[3] = {0.0};
    for (int k = 0; k < points; k++)
      for (int c = 0; c < 3; c++) sum[c] += y->value[k] * from[3 * k + c];
    for (int c = 0; c < 3; c++) q->line[3 * i + c] = sum[c];
  }
}

static void sum_along_x(gathering *q, const double *x, double *const *column, long row)
{
  const int points = q->w->window.points;
  if (!q->made || q->oblique)
    for (int i = 0; i < q->g->n[0]; i++) {
      const double at[3] = {q->g->lo[0] + i * q->g->step[0], x[1], x[2]};
      place_window(q->w, 0, coordinate(q->w, 0, at), q->of_row + i);
    }
  q->made = 1;
  for (int i = 0; i < q->g->n[0]; i++) {
    const place *p = q->of_row + i;
    const double *from = q->line + 3L * p->at;
    double sum[3] = {0.0};
    for (int k = 0; k < points; k++)
      for (int c = 0; c < 3; c++) sum[c] += p->value[k] * from[3 * k + c];
    for (int c = 0; c < 3; c++) column[c][row + i] += q->factor * sum[c];
  }
}

sd_status sd_field_gather(const sd_ewald_waves *w, const sd_field_grid *g, double factor,
                          long stride, double *const *column)
{
  const int *n = w->grid.n;
  const double *G = w->spreading.gradient[0];
  gathering q = {.w = w, .g = g, .factor = factor, .oblique = G[1] != 0.0 || G[2] != 0.0};
  q.of_row = malloc(sizeof(place) * (size_t) g->n[0]);
  q.plane = malloc(sizeof(double) * 3 * (size_t) n[0] * (size_t) n[1]);
  q.line = malloc(sizeof(double) * 3 * (size_t) n[0]);
  const int ok = q.of_row && q.plane && q.line;
  for (int k = g->from; k < g->to && ok; k++) {
    double x[3] = {0.0, 0.0, g->lo[2] + k * g->step[2]};
    place z, y;
    place_window(w, 2, coordinate(w, 2, x), &z);
    sum_along_z(&q, &z);
    for (int j = 0; j < g->n[1]; j++) {
      x[1] = g->lo[1] + j * g->step[1];
      place_window(w, 1, coordinate(w, 1, x), &y);
      sum_along_y(&q, &y);
      sum_along_x(&q, x, column, ((long) (k - g->from) * g->n[1] + j) * stride);
    }
  }
  free(q.of_row);
  free(q.plane);
  free(q.line);
  return ok ? SD_OK : SD_ENOMEMORY;
}
