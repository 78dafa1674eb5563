#include "sd_field.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
  const sd_field_grid *g;
  /* of our points: squared distance over radius of the nearest sphere */
  double *nearest;
  double *u;
  unsigned char *inside;
} filling;

/* First and end of the points of a direction within a of x */
static int points_near(const filling *q, int d, double x, double a, int *end)
{
  const double step = q->g->step[d], lo = q->g->lo[d];
  const int from = d == 2 ? q->g->from : 0, to = d == 2 ? q->g->to : q->g->n[d];
  *end = (int) fmin(to, fmax(from, floor((x + a - lo) / step) + 1.0));
  return (int) fmin(to, fmax(from, ceil((x - a - lo) / step)));
}

static void move_with(filling *q, size_t point, const double *V, const double *r, double share)
{
  if (share > 1.0 || share >= q->nearest[point]) return;
  double *u = q->u + 3 * point;
  q->nearest[point] = share;
  q->inside[point] = 1;
  for (int d = 0; d < 3; d++) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    u[d] = V[d] + V[3 + e] * r[f] - V[3 + f] * r[e];
  }
}

static void fill_sphere(filling *q, const double *x, double a, const double *V)
{
  const sd_field_grid *g = q->g;
  int end[3], from[3];
  for (int d = 0; d < 3; d++) from[d] = points_near(q, d, x[d], a, end + d);
  for (int k = from[2]; k < end[2]; k++)
    for (int j = from[1]; j < end[1]; j++)
      for (int i = from[0]; i < end[0]; i++) {
        const double r[3] = {g->lo[0] + i * g->step[0] - x[0], g->lo[1] + j * g->step[1] - x[1],
                             g->lo[2] + k * g->step[2] - x[2]};
        const double share = (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]) / (a * a);
        move_with(q, ((size_t) (k - g->from) * (size_t) g->n[1] + (size_t) j) * (size_t) g->n[0] +
                         (size_t) i, V, r, share);
      }
}

sd_status sd_field_inside(const sd_field_bodies *b, const sd_field_grid *g, double *u,
                          unsigned char *inside)
{
  const size_t points = sd_field_points(g);
  filling q = {.g = g, .u = u, .inside = inside};
  q.nearest = malloc(sizeof(double) * (points + 1));
  if (!q.nearest) return SD_ENOMEMORY;
  memset(inside, 0, points);
  for (size_t k = 0; k < points; k++) q.nearest[k] = INFINITY;
  for (long i = 0; i < b->n; i++) fill_sphere(&q, b->x + 3 * i, b->a[i], b->V + 6 * i);
  free(q.nearest);
  return SD_OK;
}
