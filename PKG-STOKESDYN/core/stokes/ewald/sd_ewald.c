#include "sd_ewald.h"

#include <math.h>
#include <stdlib.h>

#include "sd_constants.h"

static const double TIGHTEST = 1e-13, LOOSEST = 1e-1;

double sd_ewald_volume(const sd_ewald_box *box)
{
  return box->edge[0] * box->edge[1] * box->edge[2];
}

/* Six digits: ranks whose sums differ in the last bits round to the same number, but for the rare
 * one that lies on the border; the caller hands out sums that are equal anyway. */
static double six_digits(double value)
{
  if (!(value > 0.0)) return 0.0;
  const double unit = pow(10.0, floor(log10(value)) - 5.0);
  return rint(value / unit) * unit;
}

/* The next number whose only prime factors are 2, 3, 5 and 7 */
static int transformable(double at_least)
{
  for (int n = (int) ceil(at_least);; n++) {
    int m = n;
    for (int p = 2; p < 8; p++)
      while (m % p == 0) m /= p;
    if (m == 1) return n;
  }
}

/* Length of edge d of the box: a grid spans the edges, not the widths */
static double edge_length(const sd_ewald_box *b, int d)
{
  if (d == 0) return b->edge[0];
  if (d == 1) return hypot(b->edge[1], b->tilt[0]);
  return hypot(b->edge[2], hypot(b->tilt[1], b->tilt[2]));
}

/* The smallest distance between opposite faces */
static double narrowest(const sd_ewald_box *b)
{
  const double lx = b->edge[0], ly = b->edge[1], lz = b->edge[2];
  const double xy = b->tilt[0], xz = b->tilt[1], yz = b->tilt[2], V = sd_ewald_volume(b);
  const double yz_face = sqrt(ly * ly * lz * lz + xy * xy * lz * lz +
                              (xy * yz - ly * xz) * (xy * yz - ly * xz));
  const double xz_face = lx * hypot(lz, yz);
  return fmin(lz, fmin(V / yz_face, V / xz_face));
}

static int sound(const sd_ewald_box *b, const sd_ewald_sizes *s, double tolerance)
{
  int ok = tolerance > 0.0 && isfinite(tolerance);
  ok = ok && isfinite(s->count) && isfinite(s->squares) && isfinite(s->fourths) &&
       isfinite(s->largest);
  for (int d = 0; d < 3; d++)
    ok = ok && isfinite(b->origin[d]) && isfinite(b->tilt[d]) && isfinite(b->edge[d]) &&
         b->edge[d] > 0.0;
  return ok && isfinite(sd_ewald_volume(b)) && sd_ewald_volume(b) > 0.0;
}

/* Range of the near part that costs least, as measured: 86 spheres within it at 1e-3, and more at
 * tight tolerances, since the grid gets finer while a near pair costs about the same; in an open box
 * with its padded grid 2.5 times as many. It need not reach the first images, nor beyond an open
 * box. (A range that is just an edge would by rounding hold one image of a sphere and not the
 * opposite one.) */
static double natural_range(const sd_ewald_box *box, double count, double digits)
{
  const double many = fmax(86.0, 86.0 * pow(digits / 3.0, 1.6)) * (box->periodic ? 1.0 : 2.5);
  const double range = cbrt(3.0 * many * sd_ewald_volume(box) / (4.0 * SD_PI * count));
  if (box->periodic) return fmin(range, 0.97 * narrowest(box));
  return fmin(range, hypot(box->edge[0], hypot(box->edge[1], box->edge[2])));
}

/* xi, a_ref, range and the window. Spheres larger than 1/xi have large wave and near parts that
 * cancel: the tolerance of both is tightened by what is lost, A, which in turn moves xi. */
static void split(sd_ewald *e, const sd_ewald_sizes *s, int width, double *y)
{
  const double rms = six_digits(sqrt(s->squares / s->count)), largest = s->largest;
  const int equal = fabs(rms / largest - 1.0) < 1e-5;
  const double ref = equal ? largest : rms;
  double A = 1.0, t = 0.0;
  for (int k = 0; k < 6; k++) {
    t = e->tolerance / A / (width == 6 ? 3.0 : 1.0);
    *y = sqrt(log(1.0 / (e->box.periodic ? t : 0.7 * t))); /* no mean makes up for the cut-off */
    e->range = fmax(natural_range(&e->box, s->count, log10(1.0 / t)),
                    *y * fmax(ref / 0.8, largest / 1.5));
    e->xi = *y / e->range;
    A = equal ? 1.0 : fmax(1.0, 0.05 * pow(2.0 * e->xi * *y * largest, 3.0));
  }
  e->a_ref = fmin(ref, 0.8 / e->xi);
  e->points = (int) ceil(2.0 + log10(1.0 / t) - 1e-9);
  if (e->points < 4) e->points = 4;
  if (e->points > SD_EWALD_MOST_POINTS) e->points = SD_EWALD_MOST_POINTS;
  /* where windows are differentiated, their jump at the ends must be smaller */
  e->beta = (equal && width == 3 ? 2.25 : 2.42) * e->points;
  e->largest = largest;
  e->reach = fmax(e->range, 2.0 * largest);
}

/* Grid spacing at most pi/(2.2 xi y). An open box has room for the windows of spheres at its
 * faces; the grid around it is twice as large. */
static sd_status lay_grid(sd_ewald *e, double y)
{
  const double h = SD_PI / (2.2 * e->xi * y);
  double all = 1.0;
  e->spacing = h;
  for (int d = 0; d < 3; d++) {
    const double cells = edge_length(&e->box, d) / h;
    if (!(cells < 1e6)) return SD_ENOMEMORY;
    if (e->box.periodic)
      e->grid[d] = 2 * transformable(0.5 * fmax(cells, e->points + 2));
    else
      e->grid[d] = transformable(ceil(cells) + e->points + 1);
    all *= e->grid[d];
  }
  return all < 2147483648.0 ? SD_OK : SD_ENOMEMORY;
}

sd_status sd_ewald_choose(const sd_ewald_box *box, const sd_ewald_sizes *sizes, int width,
                          double tolerance, sd_ewald *out)
{
  *out = (sd_ewald){.box = *box};
  if (!sound(box, sizes, tolerance)) return SD_ENOTFINITE;
  out->tolerance = fmin(fmax(tolerance, TIGHTEST), LOOSEST);
  out->count = sizes->count;
  if (!(sizes->count > 0.0) || !(sizes->largest > 0.0)) {
    out->count = 0.0;
    return SD_OK;
  }
  double y;
  split(out, sizes, width, &y);
  return lay_grid(out, y);
}

int sd_ewald_box_around(sd_ewald_box *box, const double *lo, const double *hi, double largest)
{
  int holds = !box->periodic && box->edge[0] > 0.0;
  double spare[3];
  for (int d = 0; d < 3; d++) {
    spare[d] = fmax(0.05 * (hi[d] - lo[d]), largest);
    holds = holds && lo[d] >= box->origin[d] && hi[d] <= box->origin[d] + box->edge[d] &&
            box->edge[d] <= 1.5 * (hi[d] - lo[d] + 2.0 * spare[d]);
  }
  if (holds) return 0;
  *box = (sd_ewald_box){0};
  for (int d = 0; d < 3; d++) {
    box->origin[d] = lo[d] - spare[d];
    box->edge[d] = hi[d] - lo[d] + 2.0 * spare[d];
  }
  return 1;
}
