#include "sd_shape.h"

#include "sd_linear.h"

#include <math.h>

/* The main axes e of the shape and their images: sum over the spheres of arm x is (R e) up to
 * rounding, and for spheres that have moved a little it is near; made orthonormal, R = sum (image
 * of e) e^T. */
static void rotation(const sd_shape *s, const double *x, double R[9], double c[3])
{
  const int n = s->n;
  double u[3] = {0.0, 0.0, 0.0}, v[3] = {0.0, 0.0, 0.0}, w[3], sum[3] = {0.0, 0.0, 0.0};
  /* sums of arms vanish, so any origin will do */
  const double x0 = x[0], y0 = x[1], z0 = x[2];
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
    sd_normalize(u);
    double vv = 0.0;
    if (s->rank == 2) {
      const double along = sd_dot(u, v);
      for (int d = 0; d < 3; d++) v[d] -= along * u[d];
      vv = sd_dot(v, v);
    }
    if (vv > 0.0)
      sd_normalize(v);
    else
      sd_across(u, v);
    sd_cross(u, v, w);
    const double *e = s->axes;
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++) R[3 * p + q] = u[p] * e[q] + v[p] * e[3 + q] + w[p] * e[6 + q];
  }
}

/* Everything from the first sphere, which may be far from the origin: only differences matter. */
double sd_shape_pose(const sd_shape *s, const double *x, double R[9], double c[3])
{
  const int n = s->n;
  const double x0 = x[0], y0 = x[1], z0 = x[2];
  rotation(s, x, R, c);
  double worst = 0.0;
  const double cx = c[0] - x0, cy = c[1] - y0, cz = c[2] - z0;
  for (int k = 0; k < n; k++) {
    const double *X = s->x + 3 * k;
    const double dx = x[3 * k] - x0 - cx - (R[0] * X[0] + R[1] * X[1] + R[2] * X[2]);
    const double dy = x[3 * k + 1] - y0 - cy - (R[3] * X[0] + R[4] * X[1] + R[5] * X[2]);
    const double dz = x[3 * k + 2] - z0 - cz - (R[6] * X[0] + R[7] * X[1] + R[8] * X[2]);
    const double sq = dx * dx + dy * dy + dz * dz;
    /* also takes a NaN */
    if (!(sq <= worst)) worst = sq;
    if (isnan(worst)) return INFINITY;
  }
  return sqrt(worst);
}

int sd_shape_main_axes(const sd_shape *s, double E[9])
{
  const double *w = s->squares, gap = 0.01 * w[0], weight[3] = {1.0, sqrt(2.0), sqrt(3.0)};
  if (s->rank < 2 || w[0] - w[1] < gap || w[1] - w[2] < gap) return 0;
  double up[3];
  sd_multiply3(s->frame, weight, up);
  for (int m = 0; m < 3; m++) {
    const double *e = s->axes + 3 * m, sign = sd_dot(e, up) < 0.0 ? -1.0 : 1.0;
    for (int d = 0; d < 3; d++) E[3 * d + m] = sign * e[d];
  }
  return 1;
}

double sd_shape_fastest(const sd_shape *s, const double from[3], const double U[3], const double W[3], double most)
{
  const double reach = s->size + sqrt(sd_dot(from, from));
  const double bound = (sqrt(sd_dot(U, U)) + sqrt(sd_dot(W, W)) * reach) / s->thinnest;
  if (bound * bound <= most) return most;
  for (int k = 0; k < s->n; k++) {
    double arm[3], v[3];
    sd_minus(s->x + 3 * k, from, arm);
    sd_cross(W, arm, v);
    for (int d = 0; d < 3; d++) v[d] += U[d];
    most = fmax(most, sd_dot(v, v) / (s->a[k] * s->a[k]));
  }
  return most;
}
