#include "sd_constants.h"
#include "sd_linear.h"
#include "sd_sphere.h"
#include "sd_vans_grains.h"

#include <math.h>
#include <stdlib.h>

typedef struct {
  double n[3], h; /* the sphere keeps r.n <= h, r from its centre */
} cut;

/* Of one disc: the lines m.u <= c that cut it, |m| = 1, and the ends of the arcs that they take;
 * room for as many as there are cuts, of arcs for twice as many. */
typedef struct {
  double (*m)[2], *c, *from, *to;
} lines;

/* What the other lines leave of the chord k, from -t to t along (-m_y, m_x): its length. */
static double chord_left(double r, int count, const lines *line, int k)
{
  const double ex = line->m[k][0], ey = line->m[k][1], height = line->c[k];
  double t0 = -sqrt(r * r - height * height), t1 = -t0;
  for (int j = 0; j < count; j++) {
    if (j == k) continue;
    const double along = -line->m[j][0] * ey + line->m[j][1] * ex,
                 rest = line->c[j] - height * (line->m[j][0] * ex + line->m[j][1] * ey);
    if (fabs(along) < 1e-14) {
      if (rest < 0.0 || (rest == 0.0 && j < k)) t1 = t0;
    } else if (along > 0.0)
      t1 = fmin(t1, rest / along);
    else
      t0 = fmax(t0, rest / along);
  }
  return fmax(t1 - t0, 0.0);
}

/* Area of a disc of radius r within half-planes, all of which cut it. Gauss's theorem for the field
 * u/2 whose divergence is 1: the area is half the integral of u.n over its border, r^2 times the
 * angle of the arcs left plus, over the chords left, their signed distance from the centre times
 * their length. */
static double disc_area(double r, int count, const lines *line)
{
  double *from = line->from, *to = line->to, chords = 0.0;
  int arcs = 0;
  for (int k = 0; k < count; k++) {
    const double height = line->c[k], middle = atan2(line->m[k][1], line->m[k][0]),
                 half = acos(height / r);
    double lo = middle - half, hi = middle + half;
    /* an arc over the ray of angle pi is two */
    if (lo < -SD_PI) from[arcs] = lo + 2 * SD_PI, to[arcs++] = SD_PI, lo = -SD_PI;
    if (hi > SD_PI) from[arcs] = -SD_PI, to[arcs++] = hi - 2 * SD_PI, hi = SD_PI;
    from[arcs] = lo, to[arcs++] = hi;
    chords += height * chord_left(r, count, line, k);
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

/* The lines in which the planes 1 to count - 1 meet the disc of radius r at the height z along the third axis of a
 * frame; how many cut it, or -1 if one of them leaves nothing of it. */
static int lines_in(double r, double z, const double frame[3][3], int count, const cut *cuts, const lines *line)
{
  int found = 0;
  for (int k = 1; k < count; k++) {
    const double mx = sd_dot(cuts[k].n, frame[0]), my = sd_dot(cuts[k].n, frame[1]),
                 c = cuts[k].h - sd_dot(cuts[k].n, frame[2]) * z, size = hypot(mx, my);
    if (size < 1e-14 ? c < 0.0 : c <= -r * size) return -1;
    if (size < 1e-14 || c >= r * size) continue;
    line->m[found][0] = mx / size;
    line->m[found][1] = my / size;
    line->c[found++] = c / size;
  }
  return found;
}

/* Volume of the sphere within all cuts: slabs across the first cut's normal, each a disc cut by
 * the lines where the other planes meet it. With z = a sin(t) the radius is a cos(t), and no
 * root is left at the ends of the sphere; Gauss's rule of eight points in every panel, since
 * lines that come and go make kinks. */
static double integrate(double a, int count, const cut *cuts, const lines *line)
{
  static const double node[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                 0.9602898564975363};
  static const double gauss[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                  0.1012285362903763};
  double frame[3][3], volume = 0.0;
  for (int d = 0; d < 3; d++) frame[2][d] = cuts[0].n[d];
  sd_across(frame[2], frame[0]);
  sd_cross(frame[2], frame[0], frame[1]);
  const double end = asin(fmax(-1.0, fmin(1.0, cuts[0].h / a)));
  enum { PANELS = 200 };
  const double width = (end + SD_PI / 2) / PANELS;
  for (int p = 0; p < PANELS; p++)
    for (int q = 0; q < 8; q++) {
      const double t = -SD_PI / 2 + (p + 0.5 + 0.5 * (q < 4 ? node[q] : -node[q - 4])) * width,
                   z = a * sin(t), r = a * cos(t);
      const int found = lines_in(r, z, frame, count, cuts, line);
      if (found >= 0) /* dz = a cos t dt = r dt */
        volume += 0.5 * width * gauss[q % 4] * disc_area(r, found, line) * r;
    }
  return volume;
}

/* The planes that cut sphere i, as many as there are; -1 if one of them leaves nothing of it. */
static int cuts_of(int n, const double *x, const double *a, int i, cut *cuts)
{
  const double ai = a[i];
  int count = 0;
  for (int j = 0; j < n; j++) {
    if (j == i) continue;
    double r[3];
    for (int d = 0; d < 3; d++) r[d] = x[3 * j + d] - x[3 * i + d];
    const double distance = sqrt(sd_dot(r, r));
    if (distance >= ai + a[j]) continue;
    if (distance <= 1e-12 * ai) { /* concentric: the larger counts, of equal ones the first */
      if (a[j] > ai || (a[j] == ai && j < i)) return -1;
      continue;
    }
    /* the radical plane, where the powers |x|^2 - a^2 for both spheres are equal, holds the circle
     * in which they meet; it may lie beyond either centre */
    const double h = (distance * distance + ai * ai - a[j] * a[j]) / (2.0 * distance);
    if (h <= -ai) return -1;
    if (h >= ai) continue;
    for (int d = 0; d < 3; d++) cuts[count].n[d] = r[d] / distance;
    cuts[count++].h = h;
  }
  return count;
}

/* Do the caps cut off meet nowhere? Then their volumes just add. */
static int caps_are_apart(double a, int count, const cut *cuts)
{
  for (int k = 0; k < count; k++)
    for (int j = 0; j < k; j++) {
      const double between = acos(fmax(-1.0, fmin(1.0, sd_dot(cuts[j].n, cuts[k].n))));
      if (between < acos(cuts[j].h / a) + acos(cuts[k].h / a)) return 0;
    }
  return 1;
}

double sd_vans_union_share(int n, const double *x, const double *a, int i)
{
  const double ai = a[i], all = sd_sphere_volume(ai);
  cut *cuts = malloc((size_t) n * (sizeof(cut) + 7 * sizeof(double)));
  if (!cuts) return -1.0;
  const int count = cuts_of(n, x, a, i, cuts);
  double volume = count < 0 ? 0.0 : all;
  if (count >= 0 && !caps_are_apart(ai, count, cuts)) {
    double *room = (double *) (cuts + n);
    const lines line = {(double(*)[2]) room, room + 2 * n, room + 3 * n, room + 5 * n};
    volume = integrate(ai, count, cuts, &line);
  } else
    for (int k = 0; k < count; k++)
      volume -= SD_PI * (ai - cuts[k].h) * (ai - cuts[k].h) * (2.0 * ai + cuts[k].h) / 3.0;
  free(cuts);
  return volume / all;
}

/* Along x only those are compared that are within two of the largest radii. */
int sd_vans_any_nearer(int n, const double *x, const double *a, double part)
{
  double largest = 0.0;
  for (int i = 0; i < n; i++) largest = fmax(largest, a[i]);
  for (int i = 0; i < n; i++)
    for (int j = i + 1; j < n && x[3 * (long) j] - x[3 * (long) i] <= 2.0 * part * largest; j++) {
      const double reach = part * (a[i] + a[j]);
      if (sd_distance_squared(x + 3 * (long) i, x + 3 * (long) j) < reach * reach) return 1;
    }
  return 0;
}
