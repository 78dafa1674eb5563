/* The block of a pair, in vectors: what the kernels of every sum over pairs share. A file that
 * includes it has first included one of sd_vectors_*.h, which define
 *   LANES           doubles of a vector
 *   vec, mask       types; vec is a vector type of GCC and clang, so + - * / work on it
 *   LOAD STORE SET1 LE EQ ANY BITS SELECT MAX SQRT RSQRT   (SELECT(m, a, b): a where m; BITS: lane k
 *                   in bit k)
 *   ROWS(row, j, x, y, z, a, f0, f1, f2)   columns of the LANES rows j[0] ... of eight doubles
 *   TORQUES(row, j, t0, t1, t2)            the same of four doubles
 *
 * With y = 1/R, m = (a_i^2 + a_j^2) y^2, and everything times 8 pi, for pairs that do not overlap:
 *   U_i += (y + y m/3) F + (y - y m) y^2 r (r.F) + y^3 T x r
 *   W_i += y^3 F x r + y^3 [ 3/2 y^2 r (r.T) - T/2 ]
 * The sphere j gets the same from the force and the torque of i with -r for r. Pairs that overlap:
 * the other branches of sd_tensor.h, taken only when a lane of the vector overlaps. */
#ifndef SD_PAIR_KERNEL_H
#define SD_PAIR_KERNEL_H

#include "sd_product_internal.h"

#define INLINE static inline __attribute__((always_inline))

/* f and h = g/R^2 of the vector, times 4/3. over: lanes that overlap; R2 = 0 allowed there. */
static __attribute__((noinline)) void overlap(vec r2, vec ai, vec aj, vec *f, vec *h)
{
  const vec zero = SET1(0.0), one = SET1(1.0);
  const mask swap = LE(ai, aj);
  const vec A = SELECT(swap, aj, ai), b = SELECT(swap, ai, aj), d = A - b;
  const vec root = SQRT(r2), R = SELECT(LE(root, zero), one, root);
  const vec iR = one / R, t = R - d, q = d * iR, s = t * (one + q);
  const vec iA = one / A, iAb = iA / SELECT(LE(b, zero), one, b);
  const vec g = SET1(3.0 / 32.0) * s * (s * iR) * iAb;
  const mask inside = LE(root, d), coincide = LE(root, zero);
  const vec ff = (b - SET1(0.25) * t * (one - q)) * iAb - SET1(1.0 / 3.0) * g;
  const vec hh = g * iR * iR;
  *f = SET1(4.0 / 3.0) * SELECT(coincide, iA, SELECT(inside, iA, ff));
  *h = SET1(4.0 / 3.0) * SELECT(coincide, zero, SELECT(inside, zero, hh));
}

INLINE vec taper_factor(sd_taper kind, vec q)
{
  const vec one = SET1(1.0), s = MAX(one - q, SET1(0.0));
  if (kind == SD_TAPER_WENDLAND) return (s * s) * (s * s) * (one + SET1(4.0) * q);
  return s * s * (one + SET1(0.5) * q); /* 1 - 3q/2 + q^3/2 */
}

/* The block of a pair: what every kernel shares. squares = a_i^2 + a_j^2; inverse = 1/range. */
INLINE void block(sd_tensor tensor, sd_taper kind, vec inverse, vec r2, vec ai, vec aj, vec squares,
                  vec *f, vec *h)
{
  const vec y = RSQRT(r2), y2 = y * y;
  vec q = SET1(0.0), near;
  if (tensor == SD_TENSOR_RPY) {
    const vec ym = y * (squares * y2);
    *f = y + ym * SET1(1.0 / 3.0);
    *h = (y - ym) * y2;
    near = squares + (ai + ai) * aj; /* (a_i + a_j)^2 */
  } else {
    *f = y;
    *h = y * y2;
    near = SET1(1e-30); /* below it the first guess of the root may leave its range */
  }
  if (kind != SD_TAPER_NONE) q = r2 * y * inverse;
  const mask over = LE(r2, near);
  if (__builtin_expect(ANY(over), 0)) {
    vec fo, ho;
    if (tensor == SD_TENSOR_RPY)
      overlap(r2, ai, aj, &fo, &ho);
    else {
      const vec iR = SET1(1.0) / SQRT(r2);
      fo = iR;
      ho = iR * iR * iR;
    }
    *f = SELECT(over, fo, *f);
    *h = SELECT(over, ho, *h);
    if (kind != SD_TAPER_NONE) q = SELECT(over, SQRT(r2) * inverse, q);
  }
  if (kind != SD_TAPER_NONE) {
    const vec t = taper_factor(kind, q);
    *f *= t;
    *h *= t;
  }
}

INLINE double total(vec v)
{
  double lane[LANES] __attribute__((aligned(64))), s = 0.0;
  STORE(lane, v);
  for (int k = 0; k < LANES; k++) s += lane[k];
  return s;
}

/* f, h of the force; c of the cross products, for the sphere i that turns under the force on j
 * (cij) and the other way round (cji), over R; k, e of the torque, e over R^2. */
typedef struct {
  vec f, h, cij, cji, k, e;
} grand;

/* The other branches: sd_rpy_radial_wt and sd_rpy_radial_wf with the same names. R2 = 0 allowed. */
static __attribute__((noinline)) void grand_overlap(vec r2, vec ai, vec aj, grand *out)
{
  const vec zero = SET1(0.0), one = SET1(1.0);
  overlap(r2, ai, aj, &out->f, &out->h);
  const mask swap = LE(ai, aj);
  const vec A = SELECT(swap, aj, ai), b = SELECT(swap, ai, aj), d = A - b;
  const vec root = SQRT(r2), R = SELECT(LE(root, zero), one, root);
  const vec iR = one / R, t = R - d, q = d * iR, p = t * iR, s = t * (one + q), u = b + b - t;
  const vec iA = one / A, iA3 = iA * iA * iA, ib = one / SELECT(LE(b, zero), one, b);
  const vec iAb = iA * ib, iAb3 = iAb * iAb * iAb * SET1(1.0 / 64.0);
  const mask inside = LE(root, d);
  const vec g = SET1(3.0) * s * p * (one + q) * (SET1(6.0) * A * b - t * (R + d)) * iAb3;
  const vec lens = SET1(4.0) * u * u * (SET1(4.0) * q * (b + t) + p * (SET1(4.0) * b + t)) * iAb3;
  const vec body = t * (SET1(8.0) * b - SET1(3.0) * t), sixteenth = SET1(1.0 / 16.0) * iAb * iR;
  const vec large = (one + q) * (one + q) * (SET1(4.0) * b * d + body) * sixteenth * (iA * iA);
  const vec small = p * p * (SET1(4.0) * d * (SET1(3.0) * b - t) + body) * sixteenth * (ib * ib);
  const vec c_large = SELECT(inside, iA3, large), c_small = SELECT(inside, zero, small);
  out->k = SELECT(inside, iA3, lens - SET1(1.0 / 3.0) * g);
  out->e = SELECT(inside, zero, g * iR * iR);
  out->cij = SELECT(swap, c_small, c_large); /* of equal radii both are the same, or act on R = 0 */
  out->cji = SELECT(swap, c_large, c_small);
}

INLINE void grand_block(sd_taper kind, vec inverse, vec r2, vec ai, vec aj, vec squares, grand *b)
{
  const vec y = RSQRT(r2), y2 = y * y, y3 = y * y2, ym = y3 * squares;
  b->f = y + ym * SET1(1.0 / 3.0);
  b->h = (y - ym) * y2;
  b->cij = b->cji = y3;
  b->k = SET1(-0.5) * y3;
  b->e = SET1(1.5) * y3 * y2;
  vec q = SET1(0.0);
  if (kind != SD_TAPER_NONE) q = r2 * y * inverse;
  const mask over = LE(r2, squares + (ai + ai) * aj); /* (a_i + a_j)^2 */
  if (__builtin_expect(ANY(over), 0)) {
    grand o;
    grand_overlap(r2, ai, aj, &o);
    b->f = SELECT(over, o.f, b->f);
    b->h = SELECT(over, o.h, b->h);
    b->cij = SELECT(over, o.cij, b->cij);
    b->cji = SELECT(over, o.cji, b->cji);
    b->k = SELECT(over, o.k, b->k);
    b->e = SELECT(over, o.e, b->e);
    if (kind != SD_TAPER_NONE) q = SELECT(over, SQRT(r2) * inverse, q);
  }
  if (kind != SD_TAPER_NONE) {
    const vec t = taper_factor(kind, q);
    b->f *= t;
    b->h *= t;
    b->cij *= t;
    b->cji *= t;
    b->k *= t;
    b->e *= t;
  }
}

/* u [6] += block F [6]; cu, cw: c of the cross products in U and in W */
INLINE void grand_add(const grand *b, vec cu, vec cw, vec dx, vec dy, vec dz, const vec *F, vec *u)
{
  const vec c = b->h * (dx * F[0] + dy * F[1] + dz * F[2]);
  const vec e = b->e * (dx * F[3] + dy * F[4] + dz * F[5]);
  u[0] = (u[0] + b->f * F[0]) + c * dx + cu * (F[4] * dz - F[5] * dy);
  u[1] = (u[1] + b->f * F[1]) + c * dy + cu * (F[5] * dx - F[3] * dz);
  u[2] = (u[2] + b->f * F[2]) + c * dz + cu * (F[3] * dy - F[4] * dx);
  u[3] = (u[3] + b->k * F[3]) + e * dx + cw * (F[1] * dz - F[2] * dy);
  u[4] = (u[4] + b->k * F[4]) + e * dy + cw * (F[2] * dx - F[0] * dz);
  u[5] = (u[5] + b->k * F[5]) + e * dz + cw * (F[0] * dy - F[1] * dx);
}

#endif
