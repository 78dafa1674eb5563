/* Kernels of the fast product, one source for every instruction set. A file that includes this one
 * has first included its sd_vectors_*.h, and defines SD_KERNELS, the name of the table made here.
 * The block of a pair (sd_pair_kernel.h) is the same for both of its spheres: the symmetric kernel
 * computes it once. */
#include "sd_pair_kernel.h"

/* Of the taper, which is a function of R/range; without taper it is not read. */
INLINE vec inverse_range(sd_taper kind, const sd_packed *p)
{
  return SET1(kind == SD_TAPER_NONE ? 0.0 : 1.0 / p->law.range);
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

/* All pairs of this part. A group of LANES targets meets itself one-sidedly, as its own lanes are
 * among the sources, and every later group once for both: a block serves two spheres, which is what
 * makes this about 1.4 times as fast as a loop over all targets. */
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

/* Row by row, LANES neighbours at a time. A neighbour has a row of its own, so its sums are its own
 * row's: nothing is written but u of the target, and no two targets meet. */
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
#define TAPERS(kernel, p, ...)                         \
  do {                                                 \
    if ((p)->law.taper == SD_TAPER_NONE)               \
      kernel(SD_TAPER_NONE, p, __VA_ARGS__);           \
    else if ((p)->law.taper == SD_TAPER_WENDLAND)      \
      kernel(SD_TAPER_WENDLAND, p, __VA_ARGS__);       \
    else                                               \
      kernel(SD_TAPER_SPHERICAL, p, __VA_ARGS__);      \
  } while (0)
#define LAWS(kernel, p, ...)                           \
  do {                                                 \
    if ((p)->law.tensor == SD_TENSOR_RPY)              \
      TAPERS(kernel, p, SD_TENSOR_RPY, __VA_ARGS__);   \
    else                                               \
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

/* out += L (L^T in), column of blocks after column of blocks: t = L_k^T in needs all of the column,
 * then L_k t is added while it is still in the cache. */
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
