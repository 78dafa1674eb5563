/* Kernels of the fast product of forces and torques (width 6 in sd_product.h); included by
 * sd_product_kernel.h, whose vectors they use.
 *
 * With y = 1/R and everything times 8 pi (undone at the end), for pairs that do not overlap:
 *   U_i += (y + y m/3) F + (y - y m) y^2 r (r.F) + y^3 T x r
 *   W_i += y^3 F x r + y^3 [ 3/2 y^2 r (r.T) - T/2 ]
 * The sphere j gets the same from the force and the torque of i with -r for r. */

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

/* Target i against the vectors of sources from j0 to j1. both: the sources receive from the target
 * as well. */
INLINE void grand_tile(int both, sd_taper kind, const sd_packed *p, int i, int j0, int j1)
{
  const double *restrict px = p->x, *restrict py = p->y, *restrict pz = p->z, *restrict pa = p->a;
  const vec inverse = inverse_range(kind, p);
  const vec x = SET1(px[i]), y = SET1(py[i]), z = SET1(pz[i]), a = SET1(pa[i]);
  vec F[6], u[6];
#pragma GCC unroll 6
  for (int k = 0; k < 6; k++) {
    F[k] = SET1(p->f[k][i]);
    u[k] = SET1(0.0);
  }
  for (int j = j0; j < j1; j += LANES) {
    const vec dx = x - LOAD(px + j), dy = y - LOAD(py + j), dz = z - LOAD(pz + j);
    const vec aj = LOAD(pa + j), r2 = dx * dx + dy * dy + dz * dz;
    vec G[6];
    grand b;
    grand_block(kind, inverse, r2, a, aj, a * a + aj * aj, &b);
    if (!both && i >= j && i < j + LANES) {
      vec f = b.f, k = b.k; /* the others are 0 or multiply r */
      leave_out_self(i - j, &f, &k);
      b.f = f;
      b.k = k;
    }
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) G[k] = LOAD(p->f[k] + j);
    grand_add(&b, b.cji, b.cij, dx, dy, dz, G, u);
    if (both) {
      vec v[6];
#pragma GCC unroll 6
      for (int k = 0; k < 6; k++) v[k] = LOAD(p->u[k] + j);
      grand_add(&b, -b.cij, -b.cji, dx, dy, dz, F, v);
#pragma GCC unroll 6
      for (int k = 0; k < 6; k++) STORE(p->u[k] + j, v[k]);
    }
  }
#pragma GCC unroll 6
  for (int k = 0; k < 6; k++) p->u[k][i] += total(u[k]);
}

enum { GRAND_CHUNK = 128 };

INLINE void grand_symmetric(sd_taper kind, const sd_packed *p, int part, int parts)
{
  for (int c = 0; c < p->padded; c += GRAND_CHUNK) {
    const int end = c + GRAND_CHUNK < p->padded ? c + GRAND_CHUNK : p->padded;
    for (int i = 0; i < end; i += LANES) {
      if (!mine(i / LANES, part, parts)) continue;
      const int from = i + LANES > c ? i + LANES : c;
      for (int t = i; t < i + LANES; t++) {
        if (i >= c) grand_tile(0, kind, p, t, i, i + LANES);
        if (from < end) grand_tile(1, kind, p, t, from, end);
      }
    }
  }
}

INLINE void grand_list(sd_taper kind, const sd_packed *p, const sd_pairs *pairs)
{
  const vec inverse = inverse_range(kind, p);
  for (int i = 0; i < pairs->n; i++) {
    const double *own = p->row + 8 * (long) i;
    const vec x = SET1(own[0]), y = SET1(own[1]), z = SET1(own[2]), a = SET1(own[3]);
    const long end = pairs->first[i + 1];
    vec u[6];
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) u[k] = SET1(0.0);
    for (long k = pairs->first[i]; k < end; k += LANES) {
      int rest[LANES];
      const int *j = neighbors(pairs, k, end, p->n, rest);
      vec xj, yj, zj, aj, F[6];
      grand b;
      ROWS(p->row, j, xj, yj, zj, aj, F[0], F[1], F[2]);
      TORQUES(p->torque_row, j, F[3], F[4], F[5]);
      const vec dx = x - xj, dy = y - yj, dz = z - zj, r2 = dx * dx + dy * dy + dz * dz;
      grand_block(kind, inverse, r2, a, aj, a * a + aj * aj, &b);
      grand_add(&b, b.cji, b.cij, dx, dy, dz, F, u);
    }
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) p->u[k][i] = total(u[k]);
  }
}

static void run_grand_symmetric(const sd_packed *p, int part, int parts)
{
  TAPERS(grand_symmetric, p, part, parts);
}

static void run_grand_list(const sd_packed *p, const sd_pairs *pairs)
{
  TAPERS(grand_list, p, pairs);
}
