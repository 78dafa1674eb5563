/* Kernels of the fast product: RPY, without taper. The block of a pair (sd_tensor_lanes.h) is the same
 * for both of its spheres: the symmetric kernels compute it once. */
#include "sd_product_internal.h"

#if SD_LANES > 1 /* sd_product_plain.c has its own */
#include "sd_product_loops.h"
#include "sd_tensor_lanes.h"

/* Lanes of the columns j ... j + LANES - 1 that are column i itself take no part. */
NOT_INLINE void leave_out_self(int lane, vec *f, vec *h)
{
  const yes_no self = (vec) LANEWISE(NUMBER, 0) == all((double) lane);
  *f = where(self, all(0.0), *f);
  *h = where(self, all(0.0), *h);
}

/* Two targets, i and i + 1, against the vectors of sources from j0 to j1: what is loaded serves
 * twice. both: the sources receive from the targets as well. */
INLINE void tile(int both, const sd_packed *p, int i, int j0, int j1)
{
  const double *restrict px = p->x, *restrict py = p->y, *restrict pz = p->z, *restrict pa = p->a;
  const double *restrict p0 = p->f[0], *restrict p1 = p->f[1], *restrict p2 = p->f[2];
  double *restrict q0 = p->u[0], *restrict q1 = p->u[1], *restrict q2 = p->u[2];
  vec x[2], y[2], z[2], a[2], F0[2], F1[2], F2[2], u0[2], u1[2], u2[2];
#pragma GCC unroll 2
  for (int t = 0; t < 2; t++) {
    x[t] = all(px[i + t]);
    y[t] = all(py[i + t]);
    z[t] = all(pz[i + t]);
    a[t] = all(pa[i + t]);
    F0[t] = all(p0[i + t]);
    F1[t] = all(p1[i + t]);
    F2[t] = all(p2[i + t]);
    u0[t] = u1[t] = u2[t] = all(0.0);
  }
  for (int j = j0; j < j1; j += LANES) {
    const vec xj = load(px + j), yj = load(py + j), zj = load(pz + j), aj = load(pa + j);
    const vec G0 = load(p0 + j), G1 = load(p1 + j), G2 = load(p2 + j), aj2 = aj * aj;
    vec v0, v1, v2;
    if (both) {
      v0 = load(q0 + j);
      v1 = load(q1 + j);
      v2 = load(q2 + j);
    }
#pragma GCC unroll 2
    for (int t = 0; t < 2; t++) {
      const vec dx = x[t] - xj, dy = y[t] - yj, dz = z[t] - zj;
      const vec r2 = dx * dx + dy * dy + dz * dz;
      vec f, h;
      block(r2, a[t], aj, a[t] * a[t] + aj2, &f, &h);
      if (!both && i + t >= j && i + t < j + LANES) leave_out_self(i + t - j, &f, &h);
      const vec c = h * (dx * G0 + dy * G1 + dz * G2);
      u0[t] = (u0[t] + f * G0) + c * dx;
      u1[t] = (u1[t] + f * G1) + c * dy;
      u2[t] = (u2[t] + f * G2) + c * dz;
      if (both) {
        const vec e = h * (dx * F0[t] + dy * F1[t] + dz * F2[t]);
        v0 = (v0 + f * F0[t]) + e * dx;
        v1 = (v1 + f * F1[t]) + e * dy;
        v2 = (v2 + f * F2[t]) + e * dz;
      }
    }
    if (both) {
      store(q0 + j, v0);
      store(q1 + j, v1);
      store(q2 + j, v2);
    }
  }
#pragma GCC unroll 2
  for (int t = 0; t < 2; t++) {
    q0[i + t] += total(u0[t]);
    q1[i + t] += total(u1[t]);
    q2[i + t] += total(u2[t]);
  }
}

static void symmetric(const sd_packed *p, int part, int parts)
{
  share_of_pairs(p, part, parts, CHUNK, 2, tile);
}

/* Row by row, LANES neighbours at a time. A neighbour has a row of its own, so its sums are its own
 * row's: nothing is written but u of the target, and no two targets meet. */
static void list(const sd_packed *p, const sd_pairs *pairs)
{
  for (int i = 0; i < pairs->n; i++) {
    const double *own = p->row + 8 * (long) i;
    const vec x = all(own[0]), y = all(own[1]), z = all(own[2]), a = all(own[3]);
    const vec a2 = a * a;
    vec u0 = all(0.0), u1 = u0, u2 = u0;
    const long end = pairs->first[i + 1];
    for (long k = pairs->first[i]; k < end; k += LANES) {
      int rest[LANES];
      const int *j = neighbors(pairs, k, end, p->n, rest);
      vec at[4], F[4], f, h;
      gather(p->row, 8, j, at);
      gather(p->row + 4, 8, j, F);
      const vec dx = x - at[0], dy = y - at[1], dz = z - at[2], aj = at[3];
      block(dx * dx + dy * dy + dz * dz, a, aj, a2 + aj * aj, &f, &h);
      const vec c = h * (dx * F[0] + dy * F[1] + dz * F[2]);
      u0 = (u0 + f * F[0]) + c * dx;
      u1 = (u1 + f * F[1]) + c * dy;
      u2 = (u2 + f * F[2]) + c * dz;
    }
    /* w_i and the units are the caller's; there are no columns here, so the sums go to its u */
    p->u[0][i] += total(u0);
    p->u[1][i] += total(u1);
    p->u[2][i] += total(u2);
  }
}

/* --- forces and torques --- */

/* Target i against the vectors of sources from j0 to j1. both: the sources receive from the target
 * as well. */
INLINE void grand_tile(int both, const sd_packed *p, int i, int j0, int j1)
{
  const double *restrict px = p->x, *restrict py = p->y, *restrict pz = p->z, *restrict pa = p->a;
  const vec x = all(px[i]), y = all(py[i]), z = all(pz[i]), a = all(pa[i]);
  vec F[6], u[6];
#pragma GCC unroll 6
  for (int k = 0; k < 6; k++) {
    F[k] = all(p->f[k][i]);
    u[k] = all(0.0);
  }
  for (int j = j0; j < j1; j += LANES) {
    const vec dx = x - load(px + j), dy = y - load(py + j), dz = z - load(pz + j);
    const vec aj = load(pa + j), r2 = dx * dx + dy * dy + dz * dz;
    vec G[6];
    grand b;
    grand_block(r2, a, aj, a * a + aj * aj, &b);
    if (!both && i >= j && i < j + LANES) {
      vec f = b.f, k = b.k; /* the others are 0 or multiply r */
      leave_out_self(i - j, &f, &k);
      b.f = f;
      b.k = k;
    }
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) G[k] = load(p->f[k] + j);
    grand_add(&b, b.cji, b.cij, dx, dy, dz, G, u);
    if (both) {
      vec v[6];
#pragma GCC unroll 6
      for (int k = 0; k < 6; k++) v[k] = load(p->u[k] + j);
      /* seen from the source, r is -r and the two cross products change places */
      grand_add(&b, -b.cij, -b.cji, dx, dy, dz, F, v);
#pragma GCC unroll 6
      for (int k = 0; k < 6; k++) store(p->u[k] + j, v[k]);
    }
  }
#pragma GCC unroll 6
  for (int k = 0; k < 6; k++) p->u[k][i] += total(u[k]);
}

static void grand_symmetric(const sd_packed *p, int part, int parts)
{
  share_of_pairs(p, part, parts, GRAND_CHUNK, 1, grand_tile);
}

static void grand_list(const sd_packed *p, const sd_pairs *pairs)
{
  for (int i = 0; i < pairs->n; i++) {
    const double *own = p->row + 8 * (long) i;
    const vec x = all(own[0]), y = all(own[1]), z = all(own[2]), a = all(own[3]);
    const long end = pairs->first[i + 1];
    vec u[6];
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) u[k] = all(0.0);
    for (long k = pairs->first[i]; k < end; k += LANES) {
      int rest[LANES];
      const int *j = neighbors(pairs, k, end, p->n, rest);
      vec at[4], F[7];
      grand b;
      gather(p->row, 8, j, at);
      gather(p->row + 4, 8, j, F);
      gather(p->torque_row, 4, j, F + 3);
      const vec dx = x - at[0], dy = y - at[1], dz = z - at[2], aj = at[3];
      const vec r2 = dx * dx + dy * dy + dz * dz;
      grand_block(r2, a, aj, a * a + aj * aj, &b);
      grand_add(&b, b.cji, b.cij, dx, dy, dz, F, u);
    }
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) p->u[k][i] += total(u[k]);
  }
}

const struct sd_kernels SD_KERNELS(sd_product) = {{LANES, symmetric, list},
                                                  {LANES, grand_symmetric, grand_list}};
#endif
