/* The block of a pair in vectors: what the kernels of every sum over pairs share. For sources only.
 *
 * With y = 1/R, m = (a_i^2 + a_j^2) y^2, and everything times 8 pi, for pairs that do not overlap:
 *   U_i += (y + y m/3) F + (y - y m) y^2 r (r.F) + y^3 T x r
 *   W_i += y^3 F x r + y^3 [ 3/2 y^2 r (r.T) - T/2 ]
 * The sphere j gets the same from the force and the torque of i with -r for r. Pairs that overlap:
 * the other branches of sd_tensor.h, taken only when a lane of the vector overlaps. */
#ifndef SD_TENSOR_LANES_H
#define SD_TENSOR_LANES_H

#include "sd_lanes.h"

/* f and h = g/R^2 of the vector, times 4/3. over: lanes that overlap; R2 = 0 allowed there. */
NOT_INLINE void overlap(vec r2, vec ai, vec aj, vec *f, vec *h)
{
  const vec zero = all(0.0), one = all(1.0);
  const yes_no swap = ai <= aj;
  const vec A = where(swap, aj, ai), b = where(swap, ai, aj), d = A - b;
  const vec distance = root(r2), R = where(distance <= zero, one, distance);
  const vec iR = one / R, t = R - d, q = d * iR, s = t * (one + q);
  const vec iA = one / A, iAb = iA / where(b <= zero, one, b);
  const vec g = all(3.0 / 32.0) * s * (s * iR) * iAb;
  const yes_no inside = distance <= d, coincide = distance <= zero;
  const vec ff = (b - all(0.25) * t * (one - q)) * iAb - all(1.0 / 3.0) * g;
  const vec hh = g * iR * iR;
  *f = all(4.0 / 3.0) * where(coincide, iA, where(inside, iA, ff));
  *h = all(4.0 / 3.0) * where(coincide, zero, where(inside, zero, hh));
}

/* f and h of the force. squares = a_i^2 + a_j^2 */
INLINE void block(vec r2, vec ai, vec aj, vec squares, vec *f, vec *h)
{
  const vec y = inverse_root(r2), y2 = y * y, ym = y * (squares * y2);
  *f = y + ym * all(1.0 / 3.0);
  *h = (y - ym) * y2;
  const yes_no over = r2 <= squares + (ai + ai) * aj; /* (a_i + a_j)^2 */
  if (SELDOM(any(over))) {
    vec fo, ho;
    overlap(r2, ai, aj, &fo, &ho);
    *f = where(over, fo, *f);
    *h = where(over, ho, *h);
  }
}

/* The same of spheres of one radius, without a branch: those that overlap have
 * f = 4/3 (1/a - 9 R/(32 a^2)), h = 1/(8 a^2 R). */
typedef struct {
  vec squares, touch2, f0, f1, h0;
} alike;

INLINE alike alike_of(real a)
{
  const vec one = all(a), i = all(1.0) / one;
  return (alike){all(2.0) * one * one, all(4.0) * one * one, all(4.0 / 3.0) * i, all(-3.0 / 8.0) * i * i,
                 all(1.0 / 8.0) * i * i};
}

INLINE void block_alike(vec r2, const alike *a, vec *f, vec *h)
{
  const vec y = inverse_root(larger(r2, all((real) 1e-30))), y2 = y * y, ym = y * (a->squares * y2);
  const yes_no over = r2 <= a->touch2;
  *f = where(over, a->f0 + a->f1 * (r2 * y), y + ym * all(1.0 / 3.0));
  *h = where(over, a->h0 * y, (y - ym) * y2);
}

/* f, h of the force; c of the cross products, for the sphere i that turns under the force on j
 * (cij) and the other way round (cji), over R; k, e of the torque, e over R^2. */
typedef struct {
  vec f, h, cij, cji, k, e;
} grand;

/* The other branches: sd_rpy_radial_wt and sd_rpy_radial_wf with the same names. R2 = 0 allowed. */
NOT_INLINE void grand_overlap(vec r2, vec ai, vec aj, grand *out)
{
  const vec zero = all(0.0), one = all(1.0);
  overlap(r2, ai, aj, &out->f, &out->h);
  const yes_no swap = ai <= aj;
  const vec A = where(swap, aj, ai), b = where(swap, ai, aj), d = A - b;
  const vec distance = root(r2), R = where(distance <= zero, one, distance);
  const vec iR = one / R, t = R - d, q = d * iR, p = t * iR, s = t * (one + q), u = b + b - t;
  const vec iA = one / A, iA3 = iA * iA * iA, ib = one / where(b <= zero, one, b);
  const vec iAb = iA * ib, iAb3 = iAb * iAb * iAb * all(1.0 / 64.0);
  const yes_no inside = distance <= d;
  const vec g = all(3.0) * s * p * (one + q) * (all(6.0) * A * b - t * (R + d)) * iAb3;
  const vec lens = all(4.0) * u * u * (all(4.0) * q * (b + t) + p * (all(4.0) * b + t)) * iAb3;
  const vec body = t * (all(8.0) * b - all(3.0) * t), sixteenth = all(1.0 / 16.0) * iAb * iR;
  const vec large = (one + q) * (one + q) * (all(4.0) * b * d + body) * sixteenth * (iA * iA);
  const vec small = p * p * (all(4.0) * d * (all(3.0) * b - t) + body) * sixteenth * (ib * ib);
  const vec c_large = where(inside, iA3, large), c_small = where(inside, zero, small);
  out->k = where(inside, iA3, lens - all(1.0 / 3.0) * g);
  out->e = where(inside, zero, g * iR * iR);
  out->cij = where(swap, c_small, c_large); /* of equal radii both are the same, or act on R = 0 */
  out->cji = where(swap, c_large, c_small);
}

/* Of spheres of one radius, without a branch: those that overlap have
 *   c = (1/2 - 3 R/(16 a))/a^3,   k = (1 - 27 R/(32 a) + 5 R^3/(64 a^3))/a^3,
 *   e = (9/32 - 3 R^2/(64 a^2))/(a^4 R) */
INLINE void grand_alike(vec r2, const alike *a, grand *b)
{
  const vec y = inverse_root(larger(r2, all((real) 1e-30))), y2 = y * y, y3 = y * y2, R = r2 * y;
  const vec i = all(0.75) * a->f0, i3 = i * i * i, q = R * i, q2 = q * q;
  const yes_no over = r2 <= a->touch2;
  block_alike(r2, a, &b->f, &b->h);
  b->cij = b->cji = where(over, i3 * (all(0.5) - all(3.0 / 16.0) * q), y3);
  b->k = where(over, i3 * (all(1.0) - q * (all(27.0 / 32.0) - all(5.0 / 64.0) * q2)), all(-0.5) * y3);
  b->e = where(over, i3 * i * y * (all(9.0 / 32.0) - all(3.0 / 64.0) * q2), all(1.5) * y3 * y2);
}

INLINE void grand_block(vec r2, vec ai, vec aj, vec squares, grand *b)
{
  const vec y = inverse_root(r2), y2 = y * y, y3 = y * y2, ym = y3 * squares;
  b->f = y + ym * all(1.0 / 3.0);
  b->h = (y - ym) * y2;
  b->cij = b->cji = y3;
  b->k = all(-0.5) * y3;
  b->e = all(1.5) * y3 * y2;
  const yes_no over = r2 <= squares + (ai + ai) * aj; /* (a_i + a_j)^2 */
  if (SELDOM(any(over))) {
    grand o;
    grand_overlap(r2, ai, aj, &o);
    b->f = where(over, o.f, b->f);
    b->h = where(over, o.h, b->h);
    b->cij = where(over, o.cij, b->cij);
    b->cji = where(over, o.cji, b->cji);
    b->k = where(over, o.k, b->k);
    b->e = where(over, o.e, b->e);
  }
}

/* u [6] += block F [6] across d; cu, cw: c of the cross products in U and in W */
INLINE void grand_add(const grand *b, vec cu, vec cw, const vec d[3], const vec *F, vec *u)
{
  const vec dx = d[0], dy = d[1], dz = d[2];
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
