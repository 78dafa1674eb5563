/* Pairs side by side: vectors of LANES numbers, and how rows of four numbers come into them. The
 * file that includes this one has defined LANES: 8 with AVX-512, otherwise 4, and AVX2 if it
 * may. */
#ifndef SD_SPH_LANES_H
#define SD_SPH_LANES_H

#include "sd_sph_kernel.h"

#include <math.h>
#include <string.h>
#if defined(AVX2) || LANES == 8
#include <immintrin.h>
#endif

typedef double vec __attribute__((vector_size(8 * LANES)));
typedef long long yes_no __attribute__((vector_size(8 * LANES)));
typedef double row4 __attribute__((vector_size(32)));
typedef double row4_unaligned __attribute__((vector_size(32), aligned(8), may_alias));
#define INLINE static inline __attribute__((always_inline))

/* A vector of f(lane, argument). */
#if LANES == 8
#define LANEWISE(f, a) {f(0, a), f(1, a), f(2, a), f(3, a), f(4, a), f(5, a), f(6, a), f(7, a)}
#else
#define LANEWISE(f, a) {f(0, a), f(1, a), f(2, a), f(3, a)}
#endif
#define SAME(lane, a) (a)
#define ROOT_OF(lane, a) sqrt(a[lane])

/* A row need not begin at a multiple of 32 bytes, and holds numbers of another type. */
INLINE row4 load(const double *p)
{
  return *(const row4_unaligned *) p;
}

INLINE void store(double *p, row4 a)
{
  *(row4_unaligned *) p = a;
}

INLINE vec all(double a)
{
  return (vec) LANEWISE(SAME, a);
}

INLINE yes_no same(long long a)
{
  return (yes_no) LANEWISE(SAME, a);
}

/* yes is all bits or none in each lane, as comparisons make it: no branch. */
INLINE vec where(yes_no yes, vec a, vec b)
{
  return (vec) ((yes & (yes_no) a) | (~yes & (yes_no) b));
}

#if LANES == 8
INLINE vec smaller(vec a, vec b)
{
  return _mm512_min_pd(a, b);
}

INLINE vec larger(vec a, vec b)
{
  return _mm512_max_pd(a, b);
}

INLINE vec root(vec a)
{
  return _mm512_sqrt_pd(a);
}

/* Two rows side by side, and the rows of a vector. */
INLINE vec beside(row4 a, row4 b)
{
  return _mm512_insertf64x4(_mm512_castpd256_pd512(a), b, 1);
}

INLINE row4 part(vec a, int k)
{
  return k ? _mm512_extractf64x4_pd(a, 1) : _mm512_castpd512_pd256(a);
}

/* In each half four rows of four become four columns: eight shuffles, two levels of pairs. */
INLINE void transpose(vec r[4])
{
  const __m512i left = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
  const __m512i right = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  const vec a = _mm512_unpacklo_pd(r[0], r[1]), b = _mm512_unpackhi_pd(r[0], r[1]);
  const vec c = _mm512_unpacklo_pd(r[2], r[3]), d = _mm512_unpackhi_pd(r[2], r[3]);
  r[0] = _mm512_permutex2var_pd(a, left, c);
  r[1] = _mm512_permutex2var_pd(b, left, d);
  r[2] = _mm512_permutex2var_pd(a, right, c);
  r[3] = _mm512_permutex2var_pd(b, right, d);
}
#else
INLINE vec smaller(vec a, vec b)
{
#ifdef AVX2
  return _mm256_min_pd(a, b);
#else
  return where(a < b, a, b);
#endif
}

INLINE vec larger(vec a, vec b)
{
#ifdef AVX2
  return _mm256_max_pd(a, b);
#else
  return where(a > b, a, b);
#endif
}

/* The compiler makes one instruction of these. */
INLINE vec root(vec a)
{
  return (vec) LANEWISE(ROOT_OF, a);
}

INLINE row4 part(vec a, int k)
{
  (void) k;
  return a;
}

#if defined(__clang__) || __GNUC__ >= 12
#define SHUFFLE(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#else
#define SHUFFLE(a, b, i, j, k, l) __builtin_shuffle(a, b, (yes_no){i, j, k, l})
#endif

/* Four rows of four become four columns: eight shuffles, two levels of pairs. */
INLINE void transpose(vec r[4])
{
  const vec a = SHUFFLE(r[0], r[1], 0, 4, 2, 6), b = SHUFFLE(r[0], r[1], 1, 5, 3, 7);
  const vec c = SHUFFLE(r[2], r[3], 0, 4, 2, 6), d = SHUFFLE(r[2], r[3], 1, 5, 3, 7);
  r[0] = SHUFFLE(a, c, 0, 1, 4, 5);
  r[1] = SHUFFLE(b, d, 0, 1, 4, 5);
  r[2] = SHUFFLE(a, c, 2, 3, 6, 7);
  r[3] = SHUFFLE(b, d, 2, 3, 6, 7);
}
#endif

/* Column c of rows j[0 .. LANES-1], `columns` apart, becomes r[c]. */
INLINE void gather_from(const double *rows, int columns, const int j[LANES], vec r[4])
{
  for (int k = 0; k < 4; k++) {
    const row4 first = load(rows + (size_t) columns * j[k]);
#if LANES == 8
    r[k] = beside(first, load(rows + (size_t) columns * j[k + 4]));
#else
    r[k] = first;
#endif
  }
  transpose(r);
}

INLINE void gather(const double *rows, const int j[LANES], vec r[4])
{
  gather_from(rows, 4, j, r);
}

/* Takes column[0..3] of each lane from row j of that lane. One after the other: a filler may be
 * there more than once. */
INLINE void take_from(double *rows, const int j[LANES], vec column[4])
{
  transpose(column);
  for (int k = 0; k < LANES; k++) {
    double *row = rows + 4 * (size_t) j[k];
    store(row, load(row) - part(column[k % 4], k / 4));
  }
}

/* The sums over the lanes of sum[0..3]. */
INLINE row4 over_lanes(vec sum[4])
{
  transpose(sum);
  const vec total = (sum[0] + sum[1]) + (sum[2] + sum[3]);
#if LANES == 8
  return part(total, 0) + part(total, 1);
#else
  return total;
#endif
}

INLINE double sum_of(vec a)
{
  vec sum[4] = {a, all(0.0), all(0.0), all(0.0)};
  return over_lanes(sum)[0];
}

INLINE double least_of(vec a)
{
  double least = a[0];
  for (int k = 1; k < LANES; k++) least = fmin(least, a[k]);
  return least;
}

/* Appends those of j that are inside to a list; the others are overwritten by the next. */
INLINE int *keep(int *last, const int j[LANES], yes_no inside)
{
#if LANES == 8
  const __mmask8 kept = _mm512_movepi64_mask((__m512i) inside);
  const __m256i all_j = _mm256_loadu_si256((const __m256i *) j);
  _mm256_storeu_si256((__m256i *) last, _mm256_maskz_compress_epi32(kept, all_j));
  return last + __builtin_popcount(kept);
#else
  for (int k = 0; k < LANES; k++) {
    *last = j[k];
    last -= inside[k];
  }
  return last;
#endif
}

/* K and G of sd_sph_kernel.h for q <= 2. */
INLINE vec K(sd_sph_kernel kernel, vec q)
{
  if (kernel == SD_SPH_CUBICSPLINE) {
    const vec outer = 2.0 - q, inner = larger(1.0 - q, all(0.0));
    return outer * outer * outer - 4.0 * (inner * inner * inner);
  }
  const vec t = 1.0 - 0.5 * q, t2 = t * t;
  return t2 * t2 * (2.0 * q + 1.0);
}

INLINE vec G(sd_sph_kernel kernel, vec q)
{
  if (kernel == SD_SPH_CUBICSPLINE) {
    const vec outer = 2.0 - q;
    return where(q < 1.0, 9.0 * q - 12.0, -3.0 * (outer * outer) / q);
  }
  const vec t = 1.0 - 0.5 * q;
  return -5.0 * (t * t * t);
}

#endif
