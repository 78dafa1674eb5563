#include "sd_shape.h"

#include "sd_constants.h"
#include "sd_linear.h"
#include "sd_room.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How far apart, in tolerances, are images of one sphere in two clumps of one shape, when a pair of
 * spheres says how the clumps lie? The sphere itself is off by one tolerance, the line through the
 * centroid and the first of the pair by one (no sphere is farther out), the azimuth by two (no
 * sphere is farther from that line than the second of the pair). */
static const double IMAGE = 5.0;

/* Centroid of x [3n], and x from it */
static void centre(int n, const double *x, double c[3], double *out)
{
  for (int d = 0; d < 3; d++) {
    double s = 0.0;
    /* from the first: far from the origin no digits are lost */
    for (int k = 0; k < n; k++) s += x[3 * k + d] - x[d];
    c[d] = x[d] + s / n;
  }
  for (int k = 0; k < n; k++)
    for (int d = 0; d < 3; d++) out[3 * k + d] = x[3 * k + d] - c[d];
}

static double length(const double *x)
{
  return sqrt(sd_dot(x, x));
}

/* About the centroid, from the first sphere: far from the origin no digits are lost. */
double sd_shape_size(int n, const double *x, const double *a)
{
  double c[3] = {0.0, 0.0, 0.0}, size = 0.0;
  for (int k = 0; k < n; k++)
    for (int d = 0; d < 3; d++) c[d] += (x[3 * k + d] - x[d]) / n;
  for (int k = 0; k < n; k++) {
    const double *y = x + 3 * k, r[3] = {y[0] - x[0] - c[0], y[1] - x[1] - c[1], y[2] - x[2] - c[2]};
    size = fmax(size, length(r) + a[k]);
  }
  return size;
}

/* --- which rotations map one clump onto another? -------------------------------------------------
 *
 * Two spheres that are not on one line with the centroid span a frame. In each of two clumps of one
 * shape, take the pair whose key (distances and radii, below) is the same: some such pair there is
 * the image of the pair here, and then the frames say how the one clump lies in the other. There
 * are few such pairs unless the clump is symmetric; each is a candidate, tried sphere by sphere.
 * The same candidates, of a clump with itself, are its symmetries. */

/* Spheres from their centroid */
typedef struct {
  int n, rank;
  const double *x, *a;
} cluster;

/* Frame from x, first axis, and y, second axis with it; third by hand (+1, -1). Columns of E. */
static void pair_frame(const double *x, const double *y, int hand, double E[9])
{
  double e[3] = {x[0], x[1], x[2]}, f[3], h[3];
  sd_normalize(e);
  const double along = sd_dot(y, e);
  for (int d = 0; d < 3; d++) f[d] = y[d] - along * e[d];
  sd_normalize(f);
  sd_cross(e, f, h);
  for (int d = 0; d < 3; d++) {
    E[3 * d] = e[d];
    E[3 * d + 1] = f[d];
    E[3 * d + 2] = hand * h[d];
  }
}

/* Unit vector across e, turned by the angle from the one that sd_across gives */
static void across(const double e[3], double angle, double f[3])
{
  double h[3], u[3];
  sd_across(e, h);
  sd_cross(h, e, u);
  sd_normalize(u);
  for (int d = 0; d < 3; d++) f[d] = cos(angle) * u[d] + sin(angle) * h[d];
}

/* Key of the pair i, j, each a length: of i distance from the centroid and radius (all that there
 * is on a line); of j distance from the line of i, radius, distance from i. */
static int keys(const cluster *c)
{
  return c->rank == 2 ? SD_SHAPE_KEYS : 2;
}
static void pair_key(const cluster *c, int i, int j, double key[SD_SHAPE_KEYS])
{
  const double *x = c->x + 3 * i, *y = c->x + 3 * j;
  double off[3];
  key[0] = length(x);
  key[1] = c->a[i];
  if (c->rank < 2) return;
  sd_cross(x, y, off);
  key[2] = key[0] > 0.0 ? length(off) / key[0] : 0.0;
  key[3] = c->a[j];
  key[4] = sqrt(sd_distance_squared(x, y));
}

/* -1, 0, 1: is the key smaller, equal within tolerance, larger? */
static int shape_compare(const double *key, const double *other, int count, double tolerance)
{
  for (int m = 0; m < count; m++) {
    if (key[m] > other[m] + tolerance) return 1;
    if (key[m] < other[m] - tolerance) return -1;
  }
  return 0;
}

/* The key that comes first: of the spheres farthest out, of those the largest, and so on. */
static void best_key(const cluster *c, double near, double best[SD_SHAPE_KEYS])
{
  double far = 0.0;
  for (int i = 0; i < c->n; i++) far = fmax(far, length(c->x + 3 * i));
  for (int m = 0; m < SD_SHAPE_KEYS; m++) best[m] = 0.0;
  for (int i = 0; i < c->n; i++) {
    if (length(c->x + 3 * i) < far - near) continue;
    for (int j = 0; j < c->n; j++) {
      double key[SD_SHAPE_KEYS];
      pair_key(c, i, j, key);
      if (shape_compare(key, best, keys(c), near) > 0) memcpy(best, key, sizeof(double) * keys(c));
    }
  }
}

/* A walk through the frames of all pairs with the key, right- and left-handed ones in turn. Spheres
 * on a line have all azimuths:
 * eight stand for them (nothing here has harmonics above the third). In a point: any two frames.
 * Start with {0}. */
typedef struct {
  int i, j;
} walk;

static int next_frame(const cluster *c, const double *key, double near, walk *at, double E[9])
{
  const int others = c->rank == 2 ? c->n : c->rank == 1 ? 8 : 1, first = c->rank ? c->n : 1;
  for (; at->i < first; at->i++, at->j = 0) {
    const double *x = c->x + 3 * at->i, mine[2] = {length(x), c->a[at->i]};
    if (c->rank && shape_compare(mine, key, 2, near) != 0) continue;
    while (at->j < 2 * others) {
      const int j = at->j / 2, hand = at->j % 2 ? -1 : 1;
      at->j++;
      double other[SD_SHAPE_KEYS], y[3];
      if (c->rank == 2) {
        pair_key(c, at->i, j, other);
        if (shape_compare(other, key, SD_SHAPE_KEYS, near) != 0) continue;
        memcpy(y, c->x + 3 * j, sizeof(y));
      } else if (c->rank == 1)
        across(x, 0.25 * SD_PI * j, y);
      else {
        pair_frame((double[3]){1.0, 0.0, 0.0}, (double[3]){0.0, 1.0, 0.0}, hand, E);
        return 1;
      }
      pair_frame(x, y, hand, E);
      return 1;
    }
  }
  return 0;
}

/* Q F = E, for frames F and E */
static void between(const double E[9], const double F[9], double Q[9])
{
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++)
      Q[3 * p + q] = E[3 * p] * F[3 * q] + E[3 * p + 1] * F[3 * q + 1] + E[3 * p + 2] * F[3 * q + 2];
}

static int holds(const int *perm, int count, int j)
{
  for (int k = 0; k < count; k++)
    if (perm[k] == j) return 1;
  return 0;
}

/* Are the images Q x of the spheres of the shape those of c? Then 1 and perm. */
static int map_onto(const sd_shape *s, const double Q[9], const cluster *c, double near, int *perm)
{
  for (int k = 0; k < s->n; k++) {
    double t[3];
    int found = -1;
    sd_multiply3(Q, s->x + 3 * k, t);
    /* the neighbour in order first: most often the same or the next index */
    for (int m = 0; m < s->n && found < 0; m++) {
      const int j = (k + m) % s->n;
      if (sd_distance_squared(c->x + 3 * j, t) <= near * near && fabs(c->a[j] - s->a[k]) <= near &&
          !holds(perm, k, j))
        found = j;
    }
    if (found < 0) return 0;
    perm[k] = found;
  }
  return 1;
}

/* --- the shape -------------------------------------------------------------------------------- */

static sd_status add_symmetry(sd_shape *s, const double g[9], int *capacity, const int *perm)
{
  if (s->symmetries == *capacity) {
    const size_t larger = *capacity ? 2 * (size_t) *capacity : 2;
    if (!sd_grow(&s->g, 9 * sizeof(double), larger) ||
        !sd_grow(&s->perm, sizeof(int) * (size_t) s->n, larger))
      return SD_ENOMEMORY;
    *capacity = (int) larger;
  }
  memcpy(s->g + 9 * s->symmetries, g, sizeof(double) * 9);
  memcpy(s->perm + (size_t) s->n * s->symmetries, perm, sizeof(int) * (size_t) s->n);
  s->symmetries++;
  return SD_OK;
}

/* How high does the clump stand in the frame? The three axes weigh differently: frames of one height
 * look the same. */
static double height_in(const sd_shape *s, const double E[9])
{
  const double weight[3] = {1.0, sqrt(2.0), sqrt(3.0)};
  double up[3], height = 0.0;
  sd_multiply3(E, weight, up);
  for (int k = 0; k < s->n; k++)
    height += (s->a[k] + s->size) * exp(sd_dot(up, s->x + 3 * k) / s->size);
  return height;
}

/* Frame and symmetries. Of all candidates the frame is the one in which the clump stands highest. Of
 * those that a symmetry makes as high, but for rounding, it is the first in the order of the spheres:
 * what is built in the frame, shells of points, must stand the same when a run goes on from a restart
 * file, with the clump turned. */
static sd_status find_frame(sd_shape *s)
{
  const cluster self = {s->n, s->rank, s->x, s->a};
  const double near = IMAGE * SD_SHAPE_TOLERANCE * s->size;
  double most = 0.0, E[9], Q[9];
  int capacity = 0;
  sd_status status = SD_OK;
  best_key(&self, near, s->pair);
  for (walk at = {0}; next_frame(&self, s->pair, near, &at, E);) most = fmax(most, height_in(s, E));
  for (walk at = {0}; next_frame(&self, s->pair, near, &at, s->frame);)
    if (height_in(s, s->frame) >= most * (1.0 - 1e-8)) break;
  int *perm = malloc(sizeof(int) * (size_t) s->n);
  if (!perm) return SD_ENOMEMORY;
  for (walk at = {0}; status == SD_OK && next_frame(&self, s->pair, near, &at, E);) {
    between(E, s->frame, Q);
    if (map_onto(s, Q, &self, near, perm)) status = add_symmetry(s, Q, &capacity, perm);
  }
  free(perm);
  return status;
}

/* Main axes, rank and sums of squares along the axes. Spheres within the tolerance of a line (a
 * point) are put there, and a sheet that is flat within the tolerance has no thickness: what little
 * they stand off says nothing of how the clump turns. */
static void find_axes(sd_shape *s)
{
  double S[9] = {0.0}, w[3], V[9];
  for (int k = 0; k < s->n; k++)
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++) S[3 * p + q] += s->x[3 * k + p] * s->x[3 * k + q];
  sd_eigen(3, S, w, V);
  for (int m = 0; m < 3; m++)
    for (int d = 0; d < 3; d++) s->axes[3 * m + d] = V[3 * d + m];
  /* handedness is that of the first two */
  sd_cross(s->axes, s->axes + 3, s->axes + 6);
  double extent[3] = {0.0, 0.0, 0.0};
  for (int k = 0; k < s->n; k++)
    for (int m = 0; m < 3; m++)
      extent[m] = fmax(extent[m], fabs(sd_dot(s->x + 3 * k, s->axes + 3 * m)));
  for (int m = 0; m < 3; m++) {
    const int counts = extent[m] > SD_SHAPE_TOLERANCE * s->size;
    s->squares[m] = counts ? w[m] : 0.0;
    if (counts && m < 2) s->rank = m + 1;
  }
  for (int k = 0; k < s->n; k++) {
    double *x = s->x + 3 * k;
    const double along = s->rank == 0 ? 0.0 : sd_dot(x, s->axes);
    for (int d = 0; d < 3 && s->rank < 2; d++) x[d] = along * s->axes[d];
    s->arm[2 * k] = s->rank > 0 ? along / w[0] : 0.0;
    s->arm[2 * k + 1] = s->rank == 2 ? sd_dot(s->axes + 3, x) / w[1] : 0.0;
  }
}

sd_status sd_shape_create(int n, const double *x, const double *a, sd_shape *s)
{
  *s = (sd_shape){.n = n};
  for (int k = 0; k < n; k++)
    if (!isfinite(x[3 * k]) || !isfinite(x[3 * k + 1]) || !isfinite(x[3 * k + 2]) ||
        !(a[k] > 0.0) || !isfinite(a[k]))
      return SD_ENOTFINITE;
  s->x = malloc(sizeof(double) * 3 * (size_t) n);
  s->a = malloc(sizeof(double) * (size_t) n);
  s->arm = malloc(sizeof(double) * 2 * (size_t) n);
  sd_status status = s->x && s->a && s->arm ? SD_OK : SD_ENOMEMORY;
  if (status == SD_OK) {
    double c[3];
    centre(n, x, c, s->x);
    memcpy(s->a, a, sizeof(double) * (size_t) n);
    s->size = sd_shape_size(n, x, a);
    s->thinnest = a[0];
    for (int k = 1; k < n; k++) s->thinnest = fmin(s->thinnest, a[k]);
    find_axes(s);
    status = find_frame(s);
  }
  if (status != SD_OK) sd_shape_free(s);
  return status;
}

void sd_shape_free(sd_shape *s)
{
  free(s->x);
  free(s->a);
  free(s->arm);
  free(s->g);
  free(s->perm);
  *s = (sd_shape){0};
}

int sd_shape_match(const sd_shape *s, int n, const double *x, const double *a, int *perm,
                   double *scratch)
{
  if (n != s->n) return 0;
  const double tolerance = SD_SHAPE_TOLERANCE * s->size, near = IMAGE * tolerance;
  double c[3], R[9], E[9], Q[9], *y = scratch, *ordered = scratch + 3 * n;
  int same = 1;
  for (int k = 0; k < n; k++) {
    same = same && fabs(a[k] - s->a[k]) <= tolerance;
    perm[k] = k;
  }
  if (same && sd_shape_pose(s, x, R, c) <= tolerance) return 1;

  centre(n, x, c, y);
  const cluster there = {n, s->rank, y, a};
  for (walk at = {0}; next_frame(&there, s->pair, near, &at, E);) {
    double third[3];
    between(E, s->frame, Q);
    sd_cross(Q, Q + 3, third);
    /* a mirror image is another shape */
    if (sd_dot(third, Q + 6) < 0.0 || !map_onto(s, Q, &there, near, perm)) continue;
    same = 1;
    for (int k = 0; k < n; k++) {
      memcpy(ordered + 3 * k, y + 3 * perm[k], 3 * sizeof(double));
      same = same && fabs(a[perm[k]] - s->a[k]) <= tolerance;
    }
    if (same && sd_shape_pose(s, ordered, R, c) <= tolerance) return 1;
  }
  return 0;
}
