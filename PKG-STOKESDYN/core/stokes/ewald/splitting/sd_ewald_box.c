#include "sd_ewald_box.h"

#include <math.h>
#include <string.h>

#include "sd_constants.h"

/* --- edges and waves --- */

/* Multiples of 63 and of 81 are left out: the transforms of 126 points along columns take four times as long as
 * those of 128 with FFTW, of 162, 252 and 378 up to twice as long as those of the next number. */
int sd_ewald_transformable(double at_least)
{
  for (int n = 2 * (int) ceil(0.5 * at_least);; n += 2) {
    int m = n;
    if (n % 63 == 0 || n % 81 == 0) continue;
    for (int p = 2; p < 8; p++)
      while (m % p == 0) m /= p;
    if (m == 1) return n;
  }
}

double sd_ewald_edge_length(const sd_ewald_box *b, int d)
{
  if (d == 0) return b->edge[0];
  if (d == 1) return hypot(b->edge[1], b->tilt[0]);
  return hypot(b->edge[2], hypot(b->tilt[1], b->tilt[2]));
}

void sd_ewald_reciprocal(const sd_ewald_box *b, double k[3][3])
{
  const double lx = b->edge[0], ly = b->edge[1], lz = b->edge[2];
  const double xy = b->tilt[0], xz = b->tilt[1], yz = b->tilt[2], unit = 2.0 * SD_PI;
  const double rows[3][3] = {{unit / lx, -unit * xy / (lx * ly),
                              unit * (xy * yz - ly * xz) / (lx * ly * lz)},
                             {0.0, unit / ly, -unit * yz / (ly * lz)},
                             {0.0, 0.0, unit / lz}};
  memcpy(k, rows, sizeof(rows));
}

double sd_ewald_narrowest(const sd_ewald_box *b)
{
  const double lx = b->edge[0], ly = b->edge[1], lz = b->edge[2];
  const double xy = b->tilt[0], xz = b->tilt[1], yz = b->tilt[2], V = sd_ewald_volume(b);
  const double yz_face = sqrt(ly * ly * lz * lz + xy * xy * lz * lz +
                              (xy * yz - ly * xz) * (xy * yz - ly * xz));
  const double xz_face = lx * hypot(lz, yz);
  return fmin(lz, fmin(V / yz_face, V / xz_face));
}

/* --- a box that stays --- */

int sd_ewald_box_around(sd_ewald_box *box, int still, const double *lo, const double *hi,
                        double largest)
{
  int holds = !box->periodic && box->edge[0] > 0.0;
  double spare[3];
  for (int d = 0; d < 3; d++) {
    const double from = d == still ? box->origin[d] : lo[d], edge = box->edge[d];
    spare[d] = fmax(0.05 * (hi[d] - lo[d]), largest);
    holds = holds && lo[d] >= from && hi[d] <= from + edge &&
            edge <= 1.5 * (hi[d] - lo[d] + 2.0 * spare[d]);
  }
  if (!holds) *box = (sd_ewald_box){0};
  for (int d = 0; d < 3; d++) {
    if (!holds) box->edge[d] = hi[d] - lo[d] + 2.0 * spare[d];
    if (!holds || d != still) box->origin[d] = 0.5 * (lo[d] + hi[d] - box->edge[d]);
  }
  return !holds;
}
