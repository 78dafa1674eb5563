#include "sd_lattice.h"

#include <math.h>
#include <string.h>

/* d less so many times the edge along z, y or x: edges are the rows of a lower triangle, so that
 * taking off one leaves the components after it alone */
static void lattice_shift(const double h[6], int edge, double times, double d[3])
{
  const double edges[3][3] = {{h[0], 0.0, 0.0}, {h[5], h[1], 0.0}, {h[4], h[3], h[2]}};
  for (int p = 0; p < 3; p++) d[p] -= times * edges[edge][p];
}

/* Half an edge at most along each direction: z first, since only its edge has a z, then y, then x.
 * A length beyond 2^53 edges loses 53 bits a pass and no more, so the passes are counted: 1023 / 53
 * < 20. */
static void into_the_box(const double h[6], const int periodic[3], double d[3])
{
  for (int pass = 0; pass < 20; pass++) {
    int done = 1;
    for (int k = 2; k >= 0; k--) {
      const double times = periodic[k] ? round(d[k] / h[k]) : 0.0;
      if (times != 0.0) lattice_shift(h, k, times, d);
      done = done && fabs(times) < 0x1p50;
    }
    if (done) return;
  }
}

void sd_closest_image(const double h[6], const int periodic[3], double d[3])
{
  into_the_box(h, periodic, d);
  if (h[3] == 0.0 && h[4] == 0.0 && h[5] == 0.0) return;
  /* A shorter image is no farther than half the diagonal away along z, and for each such z along y;
   * with z and y given the best along x is the one nearest to 0. */
  double half = 0.0, best = INFINITY, start[3], image[3], shortest[3];
  memcpy(start, d, sizeof(start));
  memcpy(shortest, d, sizeof(shortest));
  for (int k = 0; k < 3; k++) half += periodic[k] ? 0.25 * h[k] * h[k] : 0.0;
  half = sqrt(half);
  const int nz = periodic[2] ? (int) (half / h[2] + 0.5) : 0;
  const int ny = periodic[1] ? (int) (half / h[1] + 1.0) : 0;
  for (int z = -nz; z <= nz; z++) {
    double at_z[3];
    memcpy(at_z, start, sizeof(at_z));
    lattice_shift(h, 2, z, at_z);
    const double middle = periodic[1] ? round(at_z[1] / h[1]) : 0.0;
    for (int y = -ny; y <= ny; y++) {
      memcpy(image, at_z, sizeof(image));
      lattice_shift(h, 1, middle + y, image);
      if (periodic[0]) lattice_shift(h, 0, round(image[0] / h[0]), image);
      const double sq = image[0] * image[0] + image[1] * image[1] + image[2] * image[2];
      if (!(sq < best * (1.0 - 1e-12))) continue;
      best = sq;
      memcpy(shortest, image, sizeof(shortest));
    }
  }
  memcpy(d, shortest, sizeof(shortest));
}

void sd_bring_close(const double h[6], const int periodic[3], const double to[3], double x[3],
                    int steps[3])
{
  double before[3], d[3], moved[3], exact[3];
  for (int k = 0; k < 3; k++) {
    before[k] = d[k] = x[k] - to[k];
    steps[k] = 0;
  }
  sd_closest_image(h, periodic, d);
  if (d[0] == before[0] && d[1] == before[1] && d[2] == before[2]) return;    /* as nearly all are */
  for (int k = 0; k < 3; k++) {
    x[k] = to[k] + d[k];
    moved[k] = d[k] - before[k];
  }
  sd_in_edges(h, moved, exact);
  for (int k = 0; k < 3; k++) steps[k] = fabs(exact[k]) < 1e9 ? (int) lround(exact[k]) : 0;
}

void sd_box_step(const sd_box *start, const sd_box *at, const sd_box *to, const double move[3],
                 double x[3])
{
  const double *h = to->h;
  double r[3], f[3], goes[3];
  for (int d = 0; d < 3; d++) r[d] = x[d] - start->lo[d];
  sd_in_edges(start->h, r, f);
  sd_in_edges(at->h, move, goes);
  for (int d = 0; d < 3; d++) f[d] += goes[d];
  x[0] = to->lo[0] + h[0] * f[0] + h[5] * f[1] + h[4] * f[2];
  x[1] = to->lo[1] + h[1] * f[1] + h[3] * f[2];
  x[2] = to->lo[2] + h[2] * f[2];
}

double sd_across_faces(const double h[6], int d, double length)
{
  const double xy = h[5], xz = h[4], yz = h[3], s = xy * yz / h[1] - xz;
  if (d == 2) return length / h[2];
  if (d == 1) return length / h[1] * hypot(1.0, yz / h[2]);
  return length / h[0] * hypot(1.0, hypot(xy / h[1], s / h[2]));
}
