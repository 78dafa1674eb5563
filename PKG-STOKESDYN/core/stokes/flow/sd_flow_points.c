#include "sd_flow_points.h"

#include "sd_linear.h"

void sd_flow_at_points(const sd_multiblob_additions *points, const sd_flow_spheres *flow, double *u)
{
  const sd_multiblob_spheres *s = &points->spheres;
  for (long i = 0; i < s->n; i++) {
    const sd_multiblob *m = sd_multiblob_of(points->model, s, i);
    const double *velocity = flow->velocity + flow->stride * i;
    for (long row = sd_multiblob_first(points->model, s, i), end = row + m->n; row < end; row++) {
      const double *r = points->r + 3 * row;
      double change[3];
      sd_multiply3(flow->gradient + 9 * i, r, change);
      if (flow->second) sd_flow_bend(flow->second + SD_FLOW_SECOND * i, r, m->point * s->a[i], change);
      for (int d = 0; d < 3; d++) u[3 * row + d] = velocity[d] + change[d];
    }
  }
}
