/* A whole field on one rank: the images near the grid, the choice of the sum, and the sum. */
#ifndef AROUND_H
#define AROUND_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_field.h"

/* Edges are (lx 0 0), (xy ly 0), (xz yz lz): the steps along z say how far y has moved, and both how far x has. out: x
 * a F T of each image of a source within lo ... hi; NULL: only counts */
static inline int images_within(const sd_ewald_box *b, const double *lo, const double *hi, const sd_field_sources *s,
                                double *out)
{
  int many = 0;
  for (int i = 0; i < s->n; i++) {
    const double *x = s->x + 3 * i, *edge = b->edge, *tilt = b->tilt;
    for (int t = (int) ceil((lo[2] - x[2]) / edge[2]); x[2] + t * edge[2] <= hi[2]; t++) {
      const double y = x[1] + t * tilt[2];
      for (int k = (int) ceil((lo[1] - y) / edge[1]); y + k * edge[1] <= hi[1]; k++) {
        const double z = x[0] + t * tilt[1] + k * tilt[0];
        for (int l = (int) ceil((lo[0] - z) / edge[0]); z + l * edge[0] <= hi[0]; l++, many++) {
          if (!out) continue;
          double *row = out + 10 * many;
          row[0] = z + l * edge[0];
          row[1] = y + k * edge[1];
          row[2] = x[2] + t * edge[2];
          row[3] = s->a[i];
          memcpy(row + 4, s->F + 3 * i, 3 * sizeof(double));
          for (int d = 0; d < 3; d++) row[7 + d] = s->T ? s->T[3 * i + d] : 0.0;
        }
      }
    }
  }
  return many;
}

static inline sd_status add_split(sd_field *f, const sd_ewald_box *box, double range, const sd_field_sources *s,
                                  const sd_field_grid *g, double *u)
{
  const sd_world alone = {0};
  if (!box->periodic) return sd_field_add_split(f, s, s, g, &alone, u);
  double lo[3], hi[3];
  for (int d = 0; d < 3; d++) {
    lo[d] = g->lo[d] + (d == 2 ? g->from : 0) * g->step[d] - range;
    hi[d] = g->lo[d] + ((d == 2 ? g->to : g->n[d]) - 1) * g->step[d] + range;
  }
  const size_t n = (size_t) images_within(box, lo, hi, s, NULL);
  double *rows = malloc(10 * sizeof(double) * (n + 1)), *apart = malloc(10 * sizeof(double) * (n + 1));
  double *x = apart, *a = x + 3 * n, *F = a + n, *T = F + 3 * n;
  images_within(box, lo, hi, s, rows);
  for (size_t k = 0; k < n; k++) {
    a[k] = rows[10 * k + 3];
    for (size_t d = 0; d < 3; d++) {
      x[3 * k + d] = rows[10 * k + d];
      F[3 * k + d] = rows[10 * k + 4 + d];
      T[3 * k + d] = rows[10 * k + 7 + d];
    }
  }
  const sd_field_sources near = {(int) n, x, a, F, T};
  const sd_status status = sd_field_add_split(f, s, &near, g, &alone, u);
  free(rows);
  free(apart);
  return status;
}

static inline sd_status add_flow(sd_field *f, sd_field_sum how, const sd_ewald_box *box, double tolerance,
                                 const sd_field_sources *s, const sd_field_grid *g, double *u)
{
  sd_field_cloud all;
  double range;
  sd_field_measure(s, &all);
  const sd_status status = sd_field_plan(f, how, box, tolerance, &all, g, &range);
  if (status != SD_OK) return status;
  return isinf(range) ? sd_field_add_all(f, s, g, u) : add_split(f, box, range, s, g, u);
}

#endif
