#include "sd_field_internal.h"

#include <math.h>

/* Edges are (lx 0 0), (xy ly 0), (xz yz lz): the steps along z say how far y has moved, and both how
 * far x has. */
int sd_field_images(const sd_ewald_box *box, const double *lo, const double *hi, const double *x,
                    sd_field_visit *visit, void *ctx)
{
  static const int none[3] = {0, 0, 0};
  if (!box->periodic) {
    for (int d = 0; d < 3; d++)
      if (!(x[d] >= lo[d] && x[d] <= hi[d])) return 1;
    return visit(ctx, x, none);
  }
  const double *edge = box->edge, *tilt = box->tilt;
  int t[3];
  for (t[2] = (int) ceil((lo[2] - x[2]) / edge[2]); x[2] + t[2] * edge[2] <= hi[2]; t[2]++) {
    const double y = x[1] + t[2] * tilt[2];
    for (t[1] = (int) ceil((lo[1] - y) / edge[1]); y + t[1] * edge[1] <= hi[1]; t[1]++) {
      const double x0 = x[0] + t[2] * tilt[1] + t[1] * tilt[0];
      for (t[0] = (int) ceil((lo[0] - x0) / edge[0]); x0 + t[0] * edge[0] <= hi[0]; t[0]++) {
        const double image[3] = {x0 + t[0] * edge[0], y + t[1] * edge[1], x[2] + t[2] * edge[2]};
        if (!visit(ctx, image, t)) return 0;
      }
    }
  }
  return 1;
}
