#include "sd_constants.h"
#include "sd_vans.h"

#include <math.h>

enum { MAX_CUTS = 64 };

typedef struct {
  double n[3], h; /* the sphere keeps r.n <= h, r from its centre */
} cut;

static double dot(const double *a, const double *b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Area of a disc of radius r within half-planes m.u <= c. Gauss's theorem for the field u/2
 * whose divergence is 1: the area is half the integral of u.n over its border, r^2 times the
 * angle of the arcs left plus, over the chords left, their signed distance from the centre times
 * their length. */
static double disc_area(double r, int count, double (*m)[2], const double *c)
{
  double from[2 * MAX_CUTS], to[2 * MAX_CUTS], chords = 0.0;
  int arcs = 0;
  for (int k = 0; k < count; k++) {
    const double size = hypot(m[k][0], m[k][1]);
    if (size < 1e-14) {
      if (c[k] < 0.0) return 0.0;
      continue;
    }
    const double height = c[k] / size;
    if (height >= r) continue;
    if (height <= -r) return 0.0;
    const double middle = atan2(m[k][1], m[k][0]), half = acos(height / r);
    double lo = middle - half, hi = middle + half;
    /* an arc over the ray of angle pi is two */
    if (lo < -SD_PI) from[arcs] = lo + 2 * SD_PI, to[arcs++] = SD_PI, lo = -SD_PI;
    if (hi > SD_PI) from[arcs] = -SD_PI, to[arcs++] = hi - 2 * SD_PI, hi = SD_PI;
    from[arcs] = lo, to[arcs++] = hi;

    /* the chord, from -t to t along (-m_y, m_x)/size, within the other half-planes */
    const double ex = m[k][0] / size, ey = m[k][1] / size;
    double t0 = -sqrt(r * r - height * height), t1 = -t0;
    for (int j = 0; j < count; j++) {
      if (j == k) continue;
      const double along = -m[j][0] * ey + m[j][1] * ex,
                   rest = c[j] - height * (m[j][0] * ex + m[j][1] * ey);
      if (fabs(along) < 1e-14) {
        if (rest < 0.0 || (rest == 0.0 && j < k)) t1 = t0;
      } else if (along > 0.0)
        t1 = fmin(t1, rest / along);
      else
        t0 = fmax(t0, rest / along);
    }
    if (t1 > t0) chords += height * (t1 - t0);
  }
  for (int i = 1; i < arcs; i++) /* sort by the beginning */
    for (int k = i; k > 0 && from[k] < from[k - 1]; k--) {
      const double f = from[k], t = to[k];
      from[k] = from[k - 1], to[k] = to[k - 1];
      from[k - 1] = f, to[k - 1] = t;
    }
  /* the angle that is covered by arcs cut off, counted once */
  double covered = 0.0, end = -SD_PI;
  for (int k = 0; k < arcs; k++) {
    const double begin = fmax(from[k], end);
    if (to[k] > begin) covered += to[k] - begin, end = to[k];
  }
  return 0.5 * (r * r * fmax(2 * SD_PI - covered, 0.0) + chords);
}

/* Volume of the sphere within all cuts: slabs across the first cut's normal, each a disc cut by
 * the lines where the other planes meet it. With z = a sin(t) the radius is a cos(t), and no
 * root is left at the ends of the sphere; Gauss's rule of eight points in every panel, since
 * lines that come and go make kinks. */
static double integrate(double a, int count, const cut *cuts)
{
  static const double node[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                 0.9602898564975363};
  static const double gauss[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                  0.1012285362903763};
  double axis[3], side[3], up[3], volume = 0.0; /* an orthonormal frame */
  for (int d = 0; d < 3; d++) axis[d] = cuts[0].n[d];
  const double helper[3] = {fabs(axis[0]) < 0.6 ? 1.0 : 0.0, fabs(axis[0]) < 0.6 ? 0.0 : 1.0, 0.0};
  for (int d = 0; d < 3; d++) side[d] = helper[d] - dot(helper, axis) * axis[d];
  const double size = sqrt(dot(side, side));
  for (int d = 0; d < 3; d++) side[d] /= size;
  for (int d = 0; d < 3; d++)
    up[d] = axis[(d + 1) % 3] * side[(d + 2) % 3] - axis[(d + 2) % 3] * side[(d + 1) % 3];
  const double end = asin(fmax(-1.0, fmin(1.0, cuts[0].h / a)));
  enum { PANELS = 200 };
  const double width = (end + SD_PI / 2) / PANELS;
  for (int p = 0; p < PANELS; p++)
    for (int q = 0; q < 8; q++) {
      const double t = -SD_PI / 2 + (p + 0.5 + 0.5 * (q < 4 ? node[q] : -node[q - 4])) * width,
                   z = a * sin(t), r = a * cos(t);
      double m[MAX_CUTS][2], c[MAX_CUTS];
      for (int k = 1; k < count; k++) {
        m[k - 1][0] = dot(cuts[k].n, side);
        m[k - 1][1] = dot(cuts[k].n, up);
        c[k - 1] = cuts[k].h - dot(cuts[k].n, axis) * z;
      }
      volume += 0.5 * width * gauss[q % 4] * disc_area(r, count - 1, m, c) *
          r; /* dz = a cos t dt = r dt */
    }
  return volume;
}

double sd_vans_union_share(int n, const double *x, const double *a, int i)
{
  const double ai = a[i], all = 4.0 / 3.0 * SD_PI * ai * ai * ai;
  cut cuts[MAX_CUTS];
  int count = 0;
  for (int j = 0; j < n; j++) {
    if (j == i) continue;
    double r[3];
    for (int d = 0; d < 3; d++) r[d] = x[3 * j + d] - x[3 * i + d];
    const double distance = sqrt(dot(r, r));
    if (distance >= ai + a[j]) continue;
    if (distance <= 1e-12 * ai) { /* concentric: the larger counts, of equal ones the first */
      if (a[j] > ai || (a[j] == ai && j < i)) return 0.0;
      continue;
    }
    /* the radical plane, where the powers |x|^2 - a^2 for both spheres are equal, holds the circle
     * in which they meet; it may lie beyond either centre */
    const double h = (distance * distance + ai * ai - a[j] * a[j]) / (2.0 * distance);
    if (h <= -ai) return 0.0;
    if (h >= ai || count == MAX_CUTS) continue;
    for (int d = 0; d < 3; d++) cuts[count].n[d] = r[d] / distance;
    cuts[count++].h = h;
  }
  /* The caps cut off: if none meets another, their volumes just add. */
  int apart = 1;
  for (int k = 0; k < count; k++)
    for (int j = 0; j < k; j++) {
      const double between = acos(fmax(-1.0, fmin(1.0, dot(cuts[j].n, cuts[k].n))));
      if (between < acos(cuts[j].h / ai) + acos(cuts[k].h / ai)) apart = 0;
    }
  if (!apart) return integrate(ai, count, cuts) / all;
  double volume = all;
  for (int k = 0; k < count; k++)
    volume -= SD_PI * (ai - cuts[k].h) * (ai - cuts[k].h) * (2.0 * ai + cuts[k].h) / 3.0;
  return volume / all;
}
