/* Kernels of a field: a sphere and the points of a row, which are neighbours in memory and along x.
 * With y = 1/R and everything times 8 pi the tensor of a sphere of radius a and a point is
 *
 *   outside   f = y + a^2 y^3/3,  h = y^3 - a^2 y^5,  c = y^3      u = f F + h r (r.F) + c T x r
 *   inside    f = 4/(3a),         h = 0,              c = 1/a^3 */
#include "sd_field_internal.h"
#include "sd_lanes.h"

/* What does not depend on the point */
typedef struct {
  double a2, inside_f, inside_c;
} constants;

INLINE constants constants_of(const double *s)
{
  const double a = s[3], ia = a > 0.0 ? 1.0 / a : 0.0;
  return (constants){a * a, 4.0 / 3.0 * ia, ia * ia * ia};
}

INLINE void point_block(vec r2, const constants *k, vec *f, vec *h, vec *c)
{
  const vec a2 = all(k->a2), y = inverse_root(r2), y2 = y * y, y3 = y * y2, q = a2 * y2;
  const yes_no inside = r2 <= a2;
  *f = where(inside, all(k->inside_f), y + y * q * all(1.0 / 3.0));
  *h = where(inside, all(0.0), y3 - y3 * q);
  *c = where(inside, all(k->inside_c), y3);
}

INLINE void add_flow(int turns, const double *s, vec f, vec h, vec c, vec dx, vec dy, vec dz, vec *u)
{
  const vec F0 = all(s[4]), F1 = all(s[5]), F2 = all(s[6]);
  const vec e = h * (dx * F0 + dy * F1 + dz * F2);
  u[0] = (u[0] + f * F0) + e * dx;
  u[1] = (u[1] + f * F1) + e * dy;
  u[2] = (u[2] + f * F2) + e * dz;
  if (!turns) return;
  const vec T0 = all(s[7]), T1 = all(s[8]), T2 = all(s[9]);
  u[0] += c * (T1 * dz - T2 * dy);
  u[1] += c * (T2 * dx - T0 * dz);
  u[2] += c * (T0 * dy - T1 * dx);
}

/* x of the points i ... i + LANES - 1 of every row */
INLINE vec along(const sd_field_part *p, int i)
{
  return all(p->lo[0]) + (all((double) i) + (vec) LANEWISE(NUMBER, 0)) * all(p->step[0]);
}

/* --- all pairs --- */

INLINE void direct_with(int turns, const sd_field_part *p)
{
  for (int k = 0; k < p->points[2]; k++)
    for (int j = 0; j < p->points[1]; j++) {
      const vec y = all(p->lo[1] + j * p->step[1]), z = all(p->lo[2] + k * p->step[2]);
      const long row = ((long) k * p->points[1] + j) * p->stride;
      for (int i = 0; i < p->points[0]; i += LANES) {
        const vec x = along(p, i);
        vec u[3] = {all(0.0), all(0.0), all(0.0)};
        for (int m = 0; m < p->n; m++) {
          const double *s = p->source + (long) SD_FIELD_ROW * m;
          const constants of = constants_of(s);
          const vec dx = x - all(s[0]), dy = y - all(s[1]), dz = z - all(s[2]);
          vec f, h, c;
          point_block(dx * dx + dy * dy + dz * dz, &of, &f, &h, &c);
          add_flow(turns, s, f, h, c, dx, dy, dz, u);
        }
        for (int d = 0; d < 3; d++) {
          double *out = p->u[d] + row + i;
          store_any(out, load_any(out) + u[d]);
        }
      }
    }
}

static void direct(const sd_field_part *p)
{
  if (p->turns)
    direct_with(1, p);
  else
    direct_with(0, p);
}

/* --- within the range --- */

/* The points of a direction nearer than `half` to x: first and end */
INLINE int points_near(const sd_field_part *p, int d, double x, double half, int *end)
{
  const double from = (x - half - p->lo[d]) / p->step[d], to = (x + half - p->lo[d]) / p->step[d];
  const double most = p->points[d];
  *end = to < 0.0 ? 0 : to >= most ? p->points[d] : (int) floor(to) + 1;
  return from <= 0.0 ? 0 : from >= most ? p->points[d] : (int) ceil(from);
}

/* value[f] of three polynomials of one degree */
INLINE void horner3(int count, int degree, const double (*c)[SD_RADIAL_TERMS], vec t, vec *value)
{
#pragma GCC unroll 3
  for (int f = 0; f < count; f++) value[f] = all(c[f][degree]);
#pragma GCC unroll 40
  for (int k = degree - 1; k >= 0; k--)
#pragma GCC unroll 3
    for (int f = 0; f < count; f++) value[f] = value[f] * t + all(c[f][k]);
}

/* A point has b = 0 and a sphere b = a^2/6, since a_ref is 0. */
INLINE void polynomials_of_source(const sd_field_part *p, double a2, int degree,
                                  double (*c)[SD_RADIAL_TERMS])
{
  const double b = a2 / 6.0;
  for (int k = 0; k <= degree; k++) {
    c[0][k] = p->coefficient[SD_I0][k] - b * p->coefficient[SD_I1][k];
    c[1][k] = p->coefficient[SD_J0][k] - b * p->coefficient[SD_J1][k];
    c[2][k] = p->coefficient[SD_K0][k];
  }
}

/* Lanes beyond the range get nothing; those beyond the end of a row nobody reads. */
INLINE void near_with(int turns, int degree, const sd_field_part *p)
{
  const double range2 = p->range * p->range;
  const vec most = all(range2), twice = all(2.0 / range2), one = all(1.0), zero = all(0.0);
  for (int m = 0; m < p->n; m++) {
    const double *s = p->source + (long) SD_FIELD_ROW * m;
    const constants of = constants_of(s);
    double c[3][SD_RADIAL_TERMS];
    polynomials_of_source(p, of.a2, degree, c);
    int end_z, end_y, end_x;
    for (int k = points_near(p, 2, s[2], p->range, &end_z); k < end_z; k++) {
      const double dz = p->lo[2] + k * p->step[2] - s[2], left = range2 - dz * dz;
      if (!(left > 0.0)) continue;
      for (int j = points_near(p, 1, s[1], sqrt(left), &end_y); j < end_y; j++) {
        const double dy = p->lo[1] + j * p->step[1] - s[1], rest = left - dy * dy;
        if (!(rest > 0.0)) continue;
        const long row = ((long) k * p->points[1] + j) * p->stride;
        for (int i = points_near(p, 0, s[0], sqrt(rest), &end_x); i < end_x; i += LANES) {
          const vec dx = along(p, i) - all(s[0]), r2 = dx * dx + all(dy * dy + dz * dz);
          const yes_no far = r2 > most;
          vec f, h, g, D[3], u[3];
          point_block(r2, &of, &f, &h, &g);
          horner3(turns ? 3 : 2, degree, (const double (*)[SD_RADIAL_TERMS]) c,
                  smaller(r2, most) * twice - one, D);
          f = where(far, zero, f - D[0]);
          h = where(far, zero, h - D[1]);
          if (turns) g = where(far, zero, g - D[2]);
          for (int d = 0; d < 3; d++) u[d] = load_any(p->u[d] + row + i);
          add_flow(turns, s, f, h, g, dx, all(dy), all(dz), u);
          for (int d = 0; d < 3; d++) store_any(p->u[d] + row + i, u[d]);
        }
      }
    }
  }
}

/* A copy for each degree, as in sd_ewald_near_kernel.h */
#define OF_DEGREE(d)                                   \
  static void near_forces_##d(const sd_field_part *p)  \
  {                                                    \
    near_with(0, d, p);                                \
  }                                                    \
  static void near_torques_##d(const sd_field_part *p) \
  {                                                    \
    near_with(1, d, p);                                \
  }
SD_NEAR_DEGREES(OF_DEGREE)
#undef OF_DEGREE

static void near_part(const sd_field_part *p)
{
#define OF_DEGREE(d)       \
  if (p->degree == (d)) {  \
    if (p->turns)          \
      near_torques_##d(p); \
    else                   \
      near_forces_##d(p);  \
    return;                \
  }
  SD_NEAR_DEGREES(OF_DEGREE)
#undef OF_DEGREE
}

const struct sd_field_kernels SD_KERNELS(sd_field) = {direct, near_part};
