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
  /* velocities on the waves' grid in some planes of z, and on the line of y and z; x fastest, so that
   * sums along y are whole rows: [planes][n1][3][n0], [3][n0] */
  double *planes, *line;
} gathering;

/* So many planes at once: the columns of the waves' grid, which lie far from each other in memory, are
 * read once for all of them. */
enum { PLANES = 64 };

static void sum_along_z(const gathering *q, const place *z, int planes)
{
  const sd_spreading *s = &q->w->spreading;
  const int *n = q->w->grid.n, points = q->w->window.points;
  const long size = 3L * n[0] * n[1];
  for (int j = 0; j < n[1]; j++)
    for (int i = 0; i < n[0]; i++) {
      const double *column = s->brick + i * s->layer + j * s->row;
      double *out = q->planes + 3L * j * n[0] + i;
      for (int b = 0; b < planes; b++, out += size) {
        const double *from = column + 3L * z[b].at;
        double sum[3] = {0.0};
        for (int k = 0; k < points; k++)
          for (int c = 0; c < 3; c++) sum[c] += z[b].value[k] * from[3 * k + c];
        for (int c = 0; c < 3; c++) out[c * n[0]] = sum[c];
      }
    }
}

static void sum_along_y(const gathering *q, const double *plane, const place *y)
{
  const long row = 3L * q->w->grid.n[0];
  const double *from = plane + y->at * row;
  for (long m = 0; m < row; m++) q->line[m] = y->value[0] * from[m];
  for (int k = 1; k < q->w->window.points; k++)
    for (long m = 0; m < row; m++) q->line[m] += y->value[k] * from[k * row + m];
}

static void sum_along_x(gathering *q, const double *x, long stride, double *row)
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
    for (int c = 0; c < 3; c++) {
      const double *from = q->line + c * q->w->grid.n[0] + p->at;
      double sum = 0.0;
      for (int k = 0; k < points; k++) sum += p->value[k] * from[k];
      row[c * stride + i] += q->factor * sum;
    }
  }
}

static void gather_plane(gathering *q, int k, const double *plane, long stride, double *u)
{
  const sd_field_grid *g = q->g;
  for (int j = 0; j < g->n[1]; j++) {
    const double x[3] = {0.0, g->lo[1] + j * g->step[1], g->lo[2] + k * g->step[2]};
    place y;
    place_window(q->w, 1, coordinate(q->w, 1, x), &y);
    sum_along_y(q, plane, &y);
    sum_along_x(q, x, stride, u + 3 * ((long) (k - g->from) * g->n[1] + j) * stride);
  }
}

sd_status sd_field_gather(const sd_ewald_waves *w, const sd_field_grid *g, double factor,
                          long stride, double *u)
{
  const int *n = w->grid.n;
  const double *G = w->spreading.gradient[0];
  gathering q = {.w = w, .g = g, .factor = factor, .oblique = G[1] != 0.0 || G[2] != 0.0};
  q.of_row = malloc(sizeof(place) * (size_t) g->n[0]);
  const int most = g->to - g->from < PLANES ? g->to - g->from : PLANES;
  q.planes = malloc(sizeof(double) * 3 * ((size_t) most * (size_t) n[0] * (size_t) n[1] + 1));
  q.line = malloc(sizeof(double) * 3 * (size_t) n[0]);
  const int ok = q.of_row && q.planes && q.line;
  for (int k = g->from; k < g->to && ok; k += PLANES) {
    const int planes = g->to - k < PLANES ? g->to - k : PLANES;
    place z[PLANES];
    for (int b = 0; b < planes; b++) {
      const double x[3] = {0.0, 0.0, g->lo[2] + (k + b) * g->step[2]};
      place_window(w, 2, coordinate(w, 2, x), z + b);
    }
    sum_along_z(&q, z, planes);
    for (int b = 0; b < planes; b++)
      gather_plane(&q, k + b, q.planes + 3L * b * n[0] * n[1], stride, u);
  }
  free(q.of_row);
  free(q.planes);
  free(q.line);
  return ok ? SD_OK : SD_ENOMEMORY;
}
