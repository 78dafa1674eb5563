#include "sd_shape.h"

#include "sd_linear.h"
#include "sd_tensor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Equal within this, relative to the size: keys of spheres and frames. Coarser than the tolerance of the shape, which is checked
 * sphere by sphere in the end; differences in between are so rare that only a needless second solve would be the price. */
static const double coarse = 1e-5;

/* Centroid of x [3n], and x from it */
static void centre(int n, const double *x, double c[3], double *out)
{
  for (int d = 0; d < 3; d++) {
    double s = 0.0;
    for (int k = 0; k < n; k++)
      s += x[3 * k + d] - x[d]; /* from the first: far from the origin no digits are lost */
    c[d] = x[d] + s / n;
  }
  for (int k = 0; k < n; k++)
    for (int d = 0; d < 3; d++) out[3 * k + d] = x[3 * k + d] - c[d];
}

static double distance_from_line(const double *x, const double e[3])
{
  double p[3];
  sd_cross(x, e, p);
  return sqrt(sd_dot(p, p));
}

/* Frame from spheres i, j: first axis towards i, second towards j, third by hand (+1, -1). Columns of E. */
static void pair_frame(const double *xi, const double *xj, int hand, double E[9])
{
  double e[3], f[3], h[3];
  const double r = sqrt(sd_dot(xi, xi));
  for (int d = 0; d < 3; d++) e[d] = xi[d] / r;
  const double along = sd_dot(xj, e);
  for (int d = 0; d < 3; d++) f[d] = xj[d] - along * e[d];
  const double across = sqrt(sd_dot(f, f));
  for (int d = 0; d < 3; d++) f[d] /= across;
  sd_cross(e, f, h);
  for (int d = 0; d < 3; d++) {
    E[3 * d] = e[d];
    E[3 * d + 1] = f[d];
    E[3 * d + 2] = hand * h[d];
  }
}

/* Any unit vector across e, turned by the angle */
static void across(const double e[3], double angle, double f[3])
{
  int least = 0;
  double h[3], u[3] = {0.0, 0.0, 0.0};
  for (int d = 1; d < 3; d++)
    if (fabs(e[d]) < fabs(e[least])) least = d;
  u[least] = 1.0;
  sd_cross(e, u, h);
  const double inv = 1.0 / sqrt(sd_dot(h, h));
  for (int d = 0; d < 3; d++) h[d] *= inv;
  sd_cross(h, e, u);
  for (int d = 0; d < 3; d++) f[d] = cos(angle) * u[d] + sin(angle) * h[d];
}

enum { PRINTS = 4 };

/* Numbers that two frames share only if the clump looks the same in both: the sum over all spheres of (1 + a) times a wave in a
 * general direction of the frame. Lengths in units of the size. */
static void fingerprint(const sd_shape *s, const double E[9], double print[PRINTS])
{
  static const double wave[PRINTS][4] = {{2.31, 1.17, 0.83, 0.4},
                                         {-0.97, 2.73, 1.61, 1.3},
                                         {1.43, -2.05, 2.57, 2.1},
                                         {3.07, 0.71, -3.41, 0.9}};
  const double inv = 1.0 / s->size;
  for (int m = 0; m < PRINTS; m++) {
    double k[3];
    sd_multiply3(E, wave[m], k);
    print[m] = 0.0;
    for (int i = 0; i < s->n; i++)
      print[m] += (1.0 + s->a[i] * inv) * cos(sd_dot(k, s->x + 3 * i) * inv + wave[m][3]);
    print[m] /= s->n;
  }
}

/* Map the spheres of the shape by Q onto the centres y [3n], b [n]: perm and 1, or 0. tolerance: a length. used [n]: scratch. */
static int map_onto(const sd_shape *s, const double Q[9], const double *y, const double *b,
                    double tolerance, int *perm, char *used)
{
  memset(used, 0, (size_t) s->n);
  for (int k = 0; k < s->n; k++) {
    double t[3];
    int found = -1;
    sd_multiply3(Q, s->x + 3 * k, t);
    /* the neighbour in order first: most often the same or the next index */
    for (int m = 0; m < s->n && found < 0; m++) {
      const int j = (k + m) % s->n;
      if (used[j] || fabs(b[j] - s->a[k]) > tolerance) continue;
      const double *p = y + 3 * j;
      if (fabs(p[0] - t[0]) <= tolerance && fabs(p[1] - t[1]) <= tolerance &&
          fabs(p[2] - t[2]) <= tolerance)
        found = j;
    }
    if (found < 0) return 0;
    used[found] = 1;
    perm[k] = found;
  }
  return 1;
}

static void invariants(int n, const double *x, const double *a, double v[6])
{
  for (int m = 0; m < 6; m++) v[m] = 0.0;
  for (int k = 0; k < n; k++) {
    const double sq = sd_dot(x + 3 * k, x + 3 * k);
    v[0] = fmax(v[0], sqrt(sq) + a[k]);
    v[1] += a[k];
    v[2] += a[k] * a[k];
    v[3] += sq;
    v[4] += sq * a[k];
    v[5] += sq * sq;
  }
  v[1] /= n;
  v[2] = sqrt(v[2] / n);
  v[3] = sqrt(v[3] / n);
  v[4] = cbrt(v[4] / n);
  v[5] = sqrt(sqrt(v[5] / n));
}

/* Directed pairs that may span the frame, by preference; ties remain when the shape is symmetric. Each entry of the key is a
 * length: distance of i from the centroid (largest), its radius, distance of j from the line of i (largest), its radius,
 * distance i-j. */
enum { KEYS = 5 };
static void pair_key(const double *x, const double *a, int i, int j, double key[KEYS])
{
  const double r = sqrt(sd_dot(x + 3 * i, x + 3 * i));
  double e[3], d[3];
  for (int p = 0; p < 3; p++) {
    e[p] = x[3 * i + p] / r;
    d[p] = x[3 * i + p] - x[3 * j + p];
  }
  key[0] = r;
  key[1] = a[i];
  key[2] = distance_from_line(x + 3 * j, e);
  key[3] = a[j];
  key[4] = sqrt(sd_dot(d, d));
}

/* -1, 0, 1: is the key smaller, equal within tolerance, larger? */
static int compare(const double *key, const double *other, int count, double tolerance)
{
  for (int m = 0; m < count; m++) {
    if (key[m] > other[m] + tolerance) return 1;
    if (key[m] < other[m] - tolerance) return -1;
  }
  return 0;
}

static sd_status add_symmetry(sd_shape *s, const double E[9], int *capacity, const int *perm)
{
  if (s->symmetries == *capacity) {
    const int larger = *capacity ? 2 * *capacity : 1;
    double *g = realloc(s->g, sizeof(double) * 9 * (size_t) larger);
    if (g) s->g = g;
    int *p = realloc(s->perm, sizeof(int) * (size_t) s->n * (size_t) larger);
    if (p) s->perm = p;
    if (!g || !p) return SD_ENOMEMORY;
    *capacity = larger;
  }
  double *g = s->g + 9 * s->symmetries; /* E frame^T */
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      g[3 * p + q] = 0.0;
      for (int m = 0; m < 3; m++) g[3 * p + q] += E[3 * p + m] * s->frame[3 * q + m];
    }
  memcpy(s->perm + (size_t) s->n * s->symmetries, perm, sizeof(int) * (size_t) s->n);
  s->symmetries++;
  return SD_OK;
}

/* Frame and symmetries when the centres span a plane or space. */
static sd_status find_frame(sd_shape *s, int *perm, char *used)
{
  const double tolerance = coarse * s->size;
  double best[KEYS] = {0.0}, print[PRINTS] = {0.0};
  int found = 0, capacity = 0;
  sd_status status = SD_OK;
  /* First sphere: largest distance from the centroid, then radius; then the best pair. */
  double far = 0.0;
  for (int i = 0; i < s->n; i++) far = fmax(far, sqrt(sd_dot(s->x + 3 * i, s->x + 3 * i)));
  for (int pass = 0; pass < 3; pass++) {
    /* pass 0: the best key. 1: among pairs with this key, the frame with the best fingerprint. 2: all frames that look the
     * same. */
    if (pass == 1) found = 0;
    for (int i = 0; i < s->n; i++) {
      const double r = sqrt(sd_dot(s->x + 3 * i, s->x + 3 * i));
      if (r < far - tolerance || (pass && compare((double[2]){r, s->a[i]}, best, 2, tolerance)))
        continue;
      for (int j = 0; j < s->n; j++) {
        double key[KEYS];
        if (j == i) continue;
        pair_key(s->x, s->a, i, j, key);
        if (pass == 0) {
          if (found && compare(key, best, KEYS, tolerance) <= 0) continue;
          memcpy(best, key, sizeof(key));
          found = 1;
          continue;
        }
        if (compare(key, best, KEYS, tolerance) != 0) continue;
        for (int hand = 1; hand >= -1; hand -= 2) {
          double E[9], p[PRINTS];
          pair_frame(s->x + 3 * i, s->x + 3 * j, hand, E);
          fingerprint(s, E, p);
          if (pass == 1) {
            if (found && compare(p, print, PRINTS, coarse) <= 0) continue;
            memcpy(print, p, sizeof(p));
            memcpy(s->frame, E, sizeof(E));
            s->pair[0] = i;
            s->pair[1] = j;
            found = 1;
          } else if (compare(p, print, PRINTS, 2 * coarse) == 0) {
            double g[9];
            for (int u = 0; u < 3; u++)
              for (int v = 0; v < 3; v++)
                g[3 * u + v] = E[3 * u] * s->frame[3 * v] + E[3 * u + 1] * s->frame[3 * v + 1] +
                    E[3 * u + 2] * s->frame[3 * v + 2];
            if (!map_onto(s, g, s->x, s->a, tolerance, perm, used)) continue;
            status = add_symmetry(s, E, &capacity, perm);
            if (status != SD_OK) return status;
          }
        }
      }
    }
  }
  return SD_OK;
}

/* Centres on one line: the axis towards the end with the better fingerprint; eight azimuths and both hands stand for the full
 * symmetry (nothing here has harmonics above the third), and the reverse direction if it looks the same. */
static sd_status find_line(sd_shape *s, int *perm, char *used)
{
  const double tolerance = coarse * s->size;
  double print = 0.0;
  int capacity = 0;
  for (int pass = 0; pass < 2; pass++)
    for (int way = 1; way >= -1; way -= 2) {
      double e[3], sum = 0.0;
      for (int d = 0; d < 3; d++) e[d] = way * s->axes[d];
      for (int k = 0; k < s->n; k++) {
        const double z = sd_dot(e, s->x + 3 * k) / s->size;
        sum += (1.0 + s->a[k] / s->size) * cos(2.31 * z + 0.4) / s->n;
      }
      if (pass == 0 && (way == 1 || sum > print + coarse)) print = sum;
      if (pass == 0 || fabs(sum - print) > coarse) continue;
      for (int m = 0; m < 8; m++)
        for (int hand = 1; hand >= -1; hand -= 2) {
          double f[3], E[9], g[9];
          across(e, 0.25 * SD_PI * m, f);
          pair_frame(e, f, hand, E);
          if (s->symmetries == 0) memcpy(s->frame, E, sizeof(E));
          for (int u = 0; u < 3; u++)
            for (int v = 0; v < 3; v++)
              g[3 * u + v] = E[3 * u] * s->frame[3 * v] + E[3 * u + 1] * s->frame[3 * v + 1] +
                  E[3 * u + 2] * s->frame[3 * v + 2];
          if (!map_onto(s, g, s->x, s->a, tolerance, perm, used)) continue;
          const sd_status status = add_symmetry(s, E, &capacity, perm);
          if (status != SD_OK) return status;
        }
    }
  return SD_OK;
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
  int *perm = malloc(sizeof(int) * (size_t) n);
  char *used = malloc((size_t) n);
  sd_status status = s->x && s->a && s->arm && perm && used ? SD_OK : SD_ENOMEMORY;
  if (status == SD_OK) {
    double c[3], S[9] = {0.0}, w[3], V[9];
    centre(n, x, c, s->x);
    memcpy(s->a, a, sizeof(double) * (size_t) n);
    invariants(n, s->x, a, s->invariant);
    s->size = s->invariant[0];
    for (int k = 0; k < n; k++)
      for (int p = 0; p < 3; p++)
        for (int q = 0; q < 3; q++) S[3 * p + q] += s->x[3 * k + p] * s->x[3 * k + q];
    sd_eigen(3, S, w, V);
    for (int m = 0; m < 2; m++) {
      double furthest = 0.0;
      for (int d = 0; d < 3; d++) s->axes[3 * m + d] = V[3 * d + m];
      for (int k = 0; k < n; k++)
        furthest = fmax(furthest, fabs(sd_dot(s->axes + 3 * m, s->x + 3 * k)));
      if (furthest > SD_SHAPE_TOLERANCE * s->size) s->rank = m + 1;
    }
    if (s->rank < 2) across(s->axes, 0.0, s->axes + 3);
    sd_cross(s->axes, s->axes + 3, s->axes + 6);
    for (int k = 0; k < n; k++)
      for (int m = 0; m < 2; m++)
        s->arm[2 * k + m] = m < s->rank ? sd_dot(s->axes + 3 * m, s->x + 3 * k) / w[m] : 0.0;
    if (s->rank == 2)
      status = find_frame(s, perm, used);
    else if (s->rank == 1)
      status = find_line(s, perm, used);
    else {
      int capacity = 0;
      for (int d = 0; d < 9; d++) s->frame[d] = d % 4 == 0;
      for (int k = 0; k < n; k++) perm[k] = k;
      status = add_symmetry(s, s->frame, &capacity, perm);
    }
  }
  free(perm);
  free(used);
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

void sd_shape_rotation(const sd_shape *s, const double *x, double R[9], double c[3])
{
  const int n = s->n;
  double u[3] = {0.0, 0.0, 0.0}, v[3] = {0.0, 0.0, 0.0}, w[3], sum[3] = {0.0, 0.0, 0.0};
  const double x0 = x[0], y0 = x[1], z0 = x[2]; /* sums of arms vanish, so any origin will do */
  for (int k = 0; k < n; k++) {
    const double r[3] = {x[3 * k] - x0, x[3 * k + 1] - y0, x[3 * k + 2] - z0};
    const double p = s->arm[2 * k], q = s->arm[2 * k + 1];
    for (int d = 0; d < 3; d++) {
      sum[d] += r[d];
      u[d] += p * r[d];
      v[d] += q * r[d];
    }
  }
  c[0] = x0 + sum[0] / n;
  c[1] = y0 + sum[1] / n;
  c[2] = z0 + sum[2] / n;
  const double uu = sd_dot(u, u);
  if (s->rank == 0 || !(uu > 0.0)) {
    for (int d = 0; d < 9; d++) R[d] = d % 4 == 0;
  } else {
    const double inv = 1.0 / sqrt(uu);
    for (int d = 0; d < 3; d++) u[d] *= inv;
    double vv = 0.0;
    if (s->rank == 2) {
      const double along = sd_dot(u, v);
      for (int d = 0; d < 3; d++) v[d] -= along * u[d];
      vv = sd_dot(v, v);
    }
    if (vv > 0.0) {
      const double i = 1.0 / sqrt(vv);
      for (int d = 0; d < 3; d++) v[d] *= i;
    } else
      across(u, 0.0, v);
    sd_cross(u, v, w);
    const double *e = s->axes;
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++) R[3 * p + q] = u[p] * e[q] + v[p] * e[3 + q] + w[p] * e[6 + q];
  }
}

double sd_shape_pose(const sd_shape *s, const double *x, double R[9], double c[3])
{
  const int n = s->n;
  const double x0 = x[0], y0 = x[1], z0 = x[2];
  sd_shape_rotation(s, x, R, c);
  double worst = 0.0;
  const double cx = c[0] - x0, cy = c[1] - y0, cz = c[2] - z0;
  for (int k = 0; k < n; k++) {
    const double *X = s->x + 3 * k;
    const double dx = x[3 * k] - x0 - cx - (R[0] * X[0] + R[1] * X[1] + R[2] * X[2]);
    const double dy = x[3 * k + 1] - y0 - cy - (R[3] * X[0] + R[4] * X[1] + R[5] * X[2]);
    const double dz = x[3 * k + 2] - z0 - cz - (R[6] * X[0] + R[7] * X[1] + R[8] * X[2]);
    const double sq = dx * dx + dy * dy + dz * dz;
    if (!(sq <= worst))
      worst = sq; /* also takes a NaN, and keeps it: no later comparison is true */
    if (isnan(worst)) return INFINITY;
  }
  return sqrt(worst);
}

int sd_shape_match(const sd_shape *s, int n, const double *x, const double *a, int *perm,
                   double *scratch)
{
  if (n != s->n) return 0;
  const double tolerance = SD_SHAPE_TOLERANCE * s->size;
  double c[3], R[9], v[6];
  int same = 1;
  for (int k = 0; k < n && same; k++) same = fabs(a[k] - s->a[k]) <= tolerance;
  if (same && sd_shape_pose(s, x, R, c) <= tolerance) {
    for (int k = 0; k < n; k++) perm[k] = k;
    return 1;
  }
  double *y = scratch, *z = scratch + 3 * n;
  centre(n, x, c, y);
  invariants(n, y, a, v);
  for (int m = 0; m < 6; m++)
    if (!(fabs(v[m] - s->invariant[m]) <= coarse * s->size)) return 0;

  char *used = (char *) z; /* n bytes of the 24 n */
  double *ordered = z;     /* free again after the mapping */
  const double near = coarse * s->size;
  double key[KEYS], other[KEYS], E[9], B[9], Q[9];
  if (s->rank == 2) {
    pair_key(s->x, s->a, s->pair[0], s->pair[1], key);
    pair_frame(s->x + 3 * s->pair[0], s->x + 3 * s->pair[1], 1, E);
  } else if (s->rank == 1) {
    pair_frame(s->axes, s->axes + 3, 1, E);
  }
  /* Candidate rotations: each directed pair there with the key of the pair that spans the frame here. Lines: both directions. */
  for (int i = 0; i < (s->rank == 2 ? n : 2); i++) {
    const double r = sqrt(sd_dot(y + 3 * i, y + 3 * i));
    if (s->rank == 2 && (fabs(r - key[0]) > near || fabs(a[i] - key[1]) > near)) continue;
    for (int j = 0; j < (s->rank == 2 ? n : 1); j++) {
      if (s->rank == 2) {
        if (j == i) continue;
        pair_key(y, a, i, j, other);
        if (compare(key, other, KEYS, near) != 0) continue;
        pair_frame(y + 3 * i, y + 3 * j, 1, B);
      } else if (s->rank == 1) {
        double far = 0.0, e[3], f[3];
        int end = 0;
        for (int k = 0; k < n; k++)
          if (sd_dot(y + 3 * k, y + 3 * k) > far) {
            far = sd_dot(y + 3 * k, y + 3 * k);
            end = k;
          }
        for (int d = 0; d < 3; d++) e[d] = (i ? -1.0 : 1.0) * y[3 * end + d] / sqrt(far);
        across(e, 0.0, f);
        pair_frame(e, f, 1, B);
      } else
        for (int d = 0; d < 9; d++) B[d] = E[d] = d % 4 == 0;
      for (int p = 0; p < 3; p++)
        for (int q = 0; q < 3; q++)
          Q[3 * p + q] =
              B[3 * p] * E[3 * q] + B[3 * p + 1] * E[3 * q + 1] + B[3 * p + 2] * E[3 * q + 2];
      if (!map_onto(s, Q, y, a, near, perm, used)) continue;
      for (int k = 0; k < n; k++) memcpy(ordered + 3 * k, y + 3 * perm[k], 3 * sizeof(double));
      if (sd_shape_pose(s, ordered, R, c) <= tolerance) return 1;
    }
  }
  return 0;
}
