/* What the image of every sphere adds to the fast product: the formulas of sd_wall.h in vectors. The
 * spheres stand in the axes of the wall, at heights of at least their radii. A sphere meets its own
 * image as it meets any other, and no pair has another formula, so that there is no branch. The
 * functions of a pair serve both of its spheres, as c4 and c5, and i and j, change places. */
#include "sd_product_internal.h"

#if SD_LANES > 1 /* sd_product_plain.c has its own */
#include "sd_lanes.h"
#include "sd_product_loops.h"

/* c1 ... c5 and what both widths share of them */
typedef struct {
  vec x, y, z, c[5], u2, u3, u5;
} image;

INLINE void image_of(vec dx, vec dy, vec g, vec h, vec A, vec B, image *m)
{
  const vec z = g + h, u = inverse_root(dx * dx + dy * dy + z * z), u2 = u * u;
  const vec u3 = u * u2, u5 = u3 * u2, w = A + B, q = A * B;
  const vec e = all(12.0) * z * (A * h + B * g) + all(24.0) * q;
  const vec k = all(120.0) * q * z * u2, kz = k * z, s = all(2.0) * (h * g + w); /* Q = k u^5 */
  const vec v = all(12.0) * (B - A) * u5, two = all(2.0) * u3, Q = all(2.0) * k * u5;
  m->x = dx;
  m->y = dy;
  m->z = z;
  m->u2 = u2;
  m->u3 = u3;
  m->u5 = u5;
  m->c[0] = (e - kz) * u5 - (u + s * u3);
  m->c[1] = all(2.0) * u + all(4.0) * w * u3 + all(48.0) * q * u5;
  m->c[2] = (all(3.0) * s + u2 * (all(7.0) * kz - all(5.0) * e)) * u5 - u3;
  m->c[3] = g * (two + v) - Q;
  m->c[4] = h * (two - v) - Q;
}

/* u [3] += image of F, seen from i by c4 and c5 as they are, from j with these exchanged and x, y
 * turned round */
INLINE void image_add(const image *m, vec x, vec y, vec c4, vec c5, const vec *F, vec *u)
{
  const vec p = x * F[0] + y * F[1] - m->z * F[2];
  const vec along = m->c[2] * p - c4 * F[2], up = c5 * p - m->c[1] * F[2];
  u[0] = (u[0] + m->c[0] * F[0]) + along * x;
  u[1] = (u[1] + m->c[0] * F[1]) + along * y;
  u[2] = (u[2] + up) + (along * m->z - m->c[0] * F[2]);
}

/* Target i against the vectors of sources from j0 to j1. both: the sources receive from the target
 * as well. */
INLINE void image_tile(int both, const sd_packed *p, int i, int j0, int j1)
{
  const double *restrict px = p->x, *restrict py = p->y, *restrict pz = p->z, *restrict pa = p->a;
  const vec x = all(px[i]), y = all(py[i]), g = all(pz[i]), A = all(pa[i] * pa[i] / 6.0);
  vec F[3], u[3];
#pragma GCC unroll 3
  for (int k = 0; k < 3; k++) {
    F[k] = all(p->f[k][i]);
    u[k] = all(0.0);
  }
  for (int j = j0; j < j1; j += LANES) {
    const vec a = load(pa + j), B = a * a * all(1.0 / 6.0);
    image m;
    vec G[3];
    image_of(x - load(px + j), y - load(py + j), g, load(pz + j), A, B, &m);
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) G[k] = load(p->f[k] + j);
    image_add(&m, m.x, m.y, m.c[3], m.c[4], G, u);
    if (!both) continue;
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) G[k] = load(p->u[k] + j);
    image_add(&m, -m.x, -m.y, m.c[4], m.c[3], F, G);
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) store(p->u[k] + j, G[k]);
  }
#pragma GCC unroll 3
  for (int k = 0; k < 3; k++) p->u[k][i] += total(u[k]);
}

static void symmetric(const sd_packed *p, int part, int parts)
{
  share_of_pairs(p, part, parts, CHUNK, 1, image_tile);
}

/* The sphere itself, then its neighbours */
static void list(const sd_packed *p, const sd_pairs *pairs)
{
  for (int i = 0; i < pairs->n; i++) {
    const double *own = p->row + 8 * (long) i;
    const vec x = all(own[0]), y = all(own[1]), g = all(own[2]), A = all(own[3] * own[3] / 6.0);
    const long begin = pairs->first[i], end = pairs->first[i + 1];
    vec u[3] = {all(0.0), all(0.0), all(0.0)};
    for (long k = begin - LANES; k < end; k += LANES) {
      int rest[LANES];
      const int *j = k < begin ? itself(i, p->n, rest) : neighbors(pairs, k, end, p->n, rest);
      vec at[4], G[4];
      image m;
      gather(p->row, 8, j, at);
      gather(p->row + 4, 8, j, G);
      image_of(x - at[0], y - at[1], g, at[2], A, at[3] * at[3] * all(1.0 / 6.0), &m);
      image_add(&m, m.x, m.y, m.c[3], m.c[4], G, u);
    }
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) p->u[k][i] += total(u[k]);
  }
}

/* --- forces and torques --- */

/* k l n of a sphere as source, for the other's spin from its force; and as target, for its own
 * velocity from the other's torque */
typedef struct {
  vec k, l, n;
} half_image;

INLINE half_image half_of(const image *m, vec difference, vec height, vec square)
{
  const vec v = all(12.0) * square * m->u5;
  return (half_image){difference * m->u3 - v * m->z,
                      all(5.0) * v * m->z * m->u2 - all(6.0) * height * m->u5,
                      all(0.0) - m->u3 - v};
}

/* u [6] += image of F [6]; me, it: half images of target and source */
INLINE void image_add_grand(const image *m, const half_image *me, const half_image *it, vec x, vec y,
                            vec c4, vec c5, const vec *F, vec *u)
{
  const vec d = m->u3 - all(3.0) * m->u5 * m->z * m->z, turn = m->u3 * F[5];
  const vec p = x * F[0] + y * F[1] - m->z * F[2], t = x * F[4] - y * F[3];
  const vec along = m->c[2] * p - c4 * F[2] - me->l * t;
  const vec up = c5 * p - m->c[1] * F[2] - me->n * t;
  u[0] = (u[0] + m->c[0] * F[0]) + (along * x + turn * y) - me->k * F[4];
  u[1] = (u[1] + m->c[0] * F[1]) + (along * y - turn * x) + me->k * F[3];
  u[2] = (u[2] + up) + (along * m->z - m->c[0] * F[2]);
  const vec s = it->l * p - it->n * F[2], r = x * F[3] + y * F[4];
  const vec self = all(1.5) * m->u3 + all(2.0) * d;
  const vec back = all(1.5) * m->u5 * (all(3.0) * r + m->z * F[5]);
  u[3] = (u[3] + it->k * F[1]) + s * y + (self * F[3] - back * x);
  u[4] = (u[4] - it->k * F[0]) - s * x + (self * F[4] - back * y);
  u[5] = u[5] + m->u3 * (x * F[1] - y * F[0]) +
      all(0.5) * (d * F[5] + all(3.0) * m->u5 * m->z * r);
}

INLINE void grand_image_tile(int both, const sd_packed *p, int i, int j0, int j1)
{
  const double *restrict px = p->x, *restrict py = p->y, *restrict pz = p->z, *restrict pa = p->a;
  const vec x = all(px[i]), y = all(py[i]), g = all(pz[i]), A = all(pa[i] * pa[i] / 6.0);
  vec F[6], u[6];
#pragma GCC unroll 6
  for (int k = 0; k < 6; k++) {
    F[k] = all(p->f[k][i]);
    u[k] = all(0.0);
  }
  for (int j = j0; j < j1; j += LANES) {
    const vec a = load(pa + j), B = a * a * all(1.0 / 6.0), h = load(pz + j);
    image m;
    vec G[6];
    image_of(x - load(px + j), y - load(py + j), g, h, A, B, &m);
    const half_image of_i = half_of(&m, g - h, g, A), of_j = half_of(&m, h - g, h, B);
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) G[k] = load(p->f[k] + j);
    image_add_grand(&m, &of_i, &of_j, m.x, m.y, m.c[3], m.c[4], G, u);
    if (!both) continue;
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) G[k] = load(p->u[k] + j);
    image_add_grand(&m, &of_j, &of_i, -m.x, -m.y, m.c[4], m.c[3], F, G);
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) store(p->u[k] + j, G[k]);
  }
#pragma GCC unroll 6
  for (int k = 0; k < 6; k++) p->u[k][i] += total(u[k]);
}

static void grand_symmetric(const sd_packed *p, int part, int parts)
{
  share_of_pairs(p, part, parts, GRAND_CHUNK, 1, grand_image_tile);
}

static void grand_list(const sd_packed *p, const sd_pairs *pairs)
{
  for (int i = 0; i < pairs->n; i++) {
    const double *own = p->row + 8 * (long) i;
    const vec x = all(own[0]), y = all(own[1]), g = all(own[2]), A = all(own[3] * own[3] / 6.0);
    const long begin = pairs->first[i], end = pairs->first[i + 1];
    vec u[6];
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) u[k] = all(0.0);
    for (long k = begin - LANES; k < end; k += LANES) {
      int rest[LANES];
      const int *j = k < begin ? itself(i, p->n, rest) : neighbors(pairs, k, end, p->n, rest);
      vec at[4], G[7];
      image m;
      gather(p->row, 8, j, at);
      gather(p->row + 4, 8, j, G);
      gather(p->torque_row, 4, j, G + 3);
      const vec B = at[3] * at[3] * all(1.0 / 6.0);
      image_of(x - at[0], y - at[1], g, at[2], A, B, &m);
      const half_image of_i = half_of(&m, g - at[2], g, A), of_j = half_of(&m, at[2] - g, at[2], B);
      image_add_grand(&m, &of_i, &of_j, m.x, m.y, m.c[3], m.c[4], G, u);
    }
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) p->u[k][i] += total(u[k]);
  }
}

const struct sd_kernels SD_KERNELS(sd_wall) = {{LANES, symmetric, list},
                                               {LANES, grand_symmetric, grand_list}};
#endif
