/* Kernels of the fast product, one source for every instruction set. A file that includes this one
 * first defines
 *   SD_KERNELS      name of the table that it makes
 *   LANES           doubles of a vector
 *   vec, mask       types; vec is a vector type of GCC and clang, so + - * / work on it
 *   LOAD STORE SET1 LE EQ ANY SELECT MAX SQRT RSQRT   (SELECT(m, a, b): a where m)
 *   ROWS(row, j, x, y, z, a, f0, f1, f2)   columns of the LANES rows j[0] ... of eight doubles
 *   TORQUES(row, j, t0, t1, t2)            the same of four doubles
 *
 * With y = 1/R, m = (a_i^2 + a_j^2) y^2, and everything times 4/3 (undone at the end, with w_i/(6
 * pi)):
 *   far       u_i += (y + y m/3) F_j + (y - y m) y^2 r (r.F_j)
 *   overlap   the other branches of sd_rpy_radial, taken only when a lane of the vector overlaps
 * The block of a pair is the same for both of its spheres: the symmetric kernel computes it
 * once. */
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

INLINE vec inverse_range(sd_taper kind, const sd_packed *p)
{
  return SET1(kind == SD_TAPER_NONE ? 0.0 : 1.0 / p->law.range);
}

INLINE double total(vec v)
{
  double lane[LANES] __attribute__((aligned(64))), s = 0.0;
  STORE(lane, v);
  for (int k = 0; k < LANES; k++) s += lane[k];
  return s;
}

/* Lanes of the columns j ... j + LANES - 1 that are column i itself take no part. */
static __attribute__((noinline)) void leave_out_self(int lane, vec *f, vec *h)
{
  double id[LANES] __attribute__((aligned(64)));
  for (int k = 0; k < LANES; k++) id[k] = k;
  const mask self = EQ(LOAD(id), SET1((double) lane));
  *f = SELECT(self, SET1(0.0), *f);
  *h = SELECT(self, SET1(0.0), *h);
}

/* Two targets, i and i + 1, against the vectors of sources from j0 to j1: what is loaded serves
 * twice. both: the sources receive from the targets as well. */
INLINE void tile(int both, sd_tensor tensor, sd_taper kind, const sd_packed *p, int i,
                 int j0, int j1)
{
  const double *restrict px = p->x, *restrict py = p->y, *restrict pz = p->z, *restrict pa = p->a;
  const double *restrict p0 = p->f[0], *restrict p1 = p->f[1], *restrict p2 = p->f[2];
  double *restrict q0 = p->u[0], *restrict q1 = p->u[1], *restrict q2 = p->u[2];
  const vec inverse = inverse_range(kind, p);
  vec x[2], y[2], z[2], a[2], F0[2], F1[2], F2[2], u0[2], u1[2], u2[2];
#pragma GCC unroll 2
  for (int t = 0; t < 2; t++) {
    x[t] = SET1(px[i + t]);
    y[t] = SET1(py[i + t]);
    z[t] = SET1(pz[i + t]);
    a[t] = SET1(pa[i + t]);
    F0[t] = SET1(p0[i + t]);
    F1[t] = SET1(p1[i + t]);
    F2[t] = SET1(p2[i + t]);
    u0[t] = u1[t] = u2[t] = SET1(0.0);
  }
  for (int j = j0; j < j1; j += LANES) {
    const vec xj = LOAD(px + j), yj = LOAD(py + j), zj = LOAD(pz + j), aj = LOAD(pa + j);
    const vec G0 = LOAD(p0 + j), G1 = LOAD(p1 + j), G2 = LOAD(p2 + j), aj2 = aj * aj;
    vec v0, v1, v2;
    if (both) {
      v0 = LOAD(q0 + j);
      v1 = LOAD(q1 + j);
      v2 = LOAD(q2 + j);
    }
#pragma GCC unroll 2
    for (int t = 0; t < 2; t++) {
      const vec dx = x[t] - xj, dy = y[t] - yj, dz = z[t] - zj;
      const vec r2 = dx * dx + dy * dy + dz * dz;
      vec f, h;
      block(tensor, kind, inverse, r2, a[t], aj, a[t] * a[t] + aj2, &f, &h);
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
      STORE(q0 + j, v0);
      STORE(q1 + j, v1);
      STORE(q2 + j, v2);
    }
  }
#pragma GCC unroll 2
  for (int t = 0; t < 2; t++) {
    q0[i + t] += total(u0[t]);
    q1[i + t] += total(u1[t]);
    q2[i + t] += total(u2[t]);
  }
}

/* Sources are taken in chunks that stay in the first-level cache while all targets pass. */
enum { CHUNK = 256 };

/* Groups of LANES columns: does the pair of a group with any later one belong to this part? In
 * turn, there and back, so that the sums of (groups - I) over a part's groups are equal. */
INLINE int mine(int group, int part, int parts)
{
  const int turn = group % (2 * parts);
  return turn == part || turn == 2 * parts - 1 - part;
}

INLINE void symmetric(sd_taper kind, const sd_packed *p, sd_tensor tensor, int part, int parts)
{
  for (int c = 0; c < p->padded; c += CHUNK) {
    const int end = c + CHUNK < p->padded ? c + CHUNK : p->padded;
    for (int i = 0; i < end; i += LANES) {
      if (!mine(i / LANES, part, parts)) continue;
      const int from = i + LANES > c ? i + LANES : c;
      for (int t = i; t < i + LANES; t += 2) {
        if (i >= c) tile(0, tensor, kind, p, t, i, i + LANES);
        if (from < end) tile(1, tensor, kind, p, t, from, end);
      }
    }
  }
}

/* The next LANES neighbours from k on; what is missing before end is the row that stands for
 * nothing. */
INLINE const int *neighbors(const sd_pairs *pairs, long k, long end, int nothing, int *rest)
{
  const int *j = pairs->neighbor + k;
  if (end - k >= LANES) return j;
  for (int l = 0; l < LANES; l++) rest[l] = k + l < end ? j[l] : nothing;
  return rest;
}

INLINE void list(sd_taper kind, const sd_packed *p, sd_tensor tensor, const sd_pairs *pairs)
{
  const vec inverse = inverse_range(kind, p);
  for (int i = 0; i < pairs->n; i++) {
    const double *own = p->row + 8 * (long) i;
    const vec x = SET1(own[0]), y = SET1(own[1]), z = SET1(own[2]), a = SET1(own[3]);
    const vec a2 = a * a;
    vec u0 = SET1(0.0), u1 = u0, u2 = u0;
    const long end = pairs->first[i + 1];
    for (long k = pairs->first[i]; k < end; k += LANES) {
      int rest[LANES];
      const int *j = neighbors(pairs, k, end, p->n, rest);
      vec xj, yj, zj, aj, F0, F1, F2, f, h;
      ROWS(p->row, j, xj, yj, zj, aj, F0, F1, F2);
      const vec dx = x - xj, dy = y - yj, dz = z - zj, r2 = dx * dx + dy * dy + dz * dz;
      block(tensor, kind, inverse, r2, a, aj, a2 + aj * aj, &f, &h);
      const vec c = h * (dx * F0 + dy * F1 + dz * F2);
      u0 = (u0 + f * F0) + c * dx;
      u1 = (u1 + f * F1) + c * dy;
      u2 = (u2 + f * F2) + c * dz;
    }
    /* w_i and the units are the caller's; there are no columns here, so the sums go to its u */
    p->u[0][i] = total(u0);
    p->u[1][i] = total(u1);
    p->u[2][i] = total(u2);
  }
}

/* One copy of each kernel for each law, so that the loops hold no branch on it. */
#define TAPERS(kernel, p, ...)                       \
  do {                                               \
    if ((p)->law.taper == SD_TAPER_NONE)             \
      kernel(SD_TAPER_NONE, p, __VA_ARGS__);         \
    else if ((p)->law.taper == SD_TAPER_WENDLAND)    \
      kernel(SD_TAPER_WENDLAND, p, __VA_ARGS__);     \
    else                                             \
      kernel(SD_TAPER_SPHERICAL, p, __VA_ARGS__);    \
  } while (0)
#define LAWS(kernel, p, ...)                         \
  do {                                               \
    if ((p)->law.tensor == SD_TENSOR_RPY)            \
      TAPERS(kernel, p, SD_TENSOR_RPY, __VA_ARGS__); \
    else                                             \
      TAPERS(kernel, p, SD_TENSOR_OSEEN, __VA_ARGS__); \
  } while (0)

static void run_symmetric(const sd_packed *p, int part, int parts)
{
  LAWS(symmetric, p, part, parts);
}

static void run_list(const sd_packed *p, const sd_pairs *pairs)
{
  LAWS(list, p, pairs);
}

#include "sd_grand_kernel.h"

/* The sparse factor: the fourth lane is padding. */
typedef double quad __attribute__((vector_size(32)));
typedef float quad_float __attribute__((vector_size(16)));

INLINE quad block_column(const float *value)
{
  quad_float v;
  __builtin_memcpy(&v, value, sizeof(v));
  return __builtin_convertvector(v, quad);
}

static void run_sparse(int columns, const long *first, const int *row, const float *value,
                       const double *in, double *out)
{
  for (int k = 0; k < columns; k++) {
    quad s0 = {0.0, 0.0, 0.0, 0.0}, s1 = s0, s2 = s0;
    for (long l = first[k]; l < first[k + 1]; l++) { /* t = L^T in */
      quad v;
      __builtin_memcpy(&v, in + 4 * (long) row[l], sizeof(v));
      s0 += block_column(value + 12 * l) * v;
      s1 += block_column(value + 12 * l + 4) * v;
      s2 += block_column(value + 12 * l + 8) * v;
    }
    const double t0 = s0[0] + s0[1] + s0[2], t1 = s1[0] + s1[1] + s1[2], t2 = s2[0] + s2[1] + s2[2];
    for (long l = first[k]; l < first[k + 1]; l++) { /* out += L t */
      double *o = out + 4 * (long) row[l];
      quad v;
      __builtin_memcpy(&v, o, sizeof(v));
      v += block_column(value + 12 * l) * t0 + block_column(value + 12 * l + 4) * t1 +
          block_column(value + 12 * l + 8) * t2;
      __builtin_memcpy(o, &v, sizeof(v));
    }
  }
}

const struct sd_kernels SD_KERNELS = {
    {LANES, run_symmetric, run_list},
    {LANES, run_grand_symmetric, run_grand_list},
    run_sparse};
