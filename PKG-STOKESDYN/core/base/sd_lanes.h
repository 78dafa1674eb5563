/* Vectors of LANES numbers, as the instruction set of a file of kernels has them (sd_isa.h), and the
 * few operations that + - * / and comparisons do not cover. For sources only.
 *
 *   real     a number: double; float in a file that defines SD_SINGLE before, with twice as many in a
 *            vector
 *   vec      a vector; multiply-adds are fused by the compiler where the set has them
 *   yes_no   what comparisons of two vectors make
 *   row4     four numbers, for rows of four
 *   floats   FLOATS floats, at any address
 *
 * A file that cannot do with as few lanes as a set has defines LEAST_LANES before; the compiler then
 * makes one vector of several. SD_LANES 1: plain C, in which a vector is a number. */
#ifndef SD_LANES_H
#define SD_LANES_H

#include <math.h>
#include <string.h>

#include "sd_isa.h"
#include "sd_real.h"

#if defined(SD_SINGLE) && SD_LANES > 1
#define LANES (2 * SD_LANES)
#elif defined(LEAST_LANES) && SD_LANES < LEAST_LANES
#define LANES LEAST_LANES
#else
#define LANES SD_LANES
#endif
#define FLOATS (SD_LANES == 1 ? 1 : SD_LANES == 2 ? 4 : 8)

/* How many lanes so many bytes have; the instruction `op` of a register of so many bits (nothing: 128) */
#ifdef SD_SINGLE
#define LANES_OF(bytes) ((bytes) / 4)
#define PACKED(bits, op) _mm##bits##_##op##_ps
#define MASK(yes) _mm512_movepi32_mask((__m512i) (yes))
#else
#define LANES_OF(bytes) ((bytes) / 8)
#define PACKED(bits, op) _mm##bits##_##op##_pd
#define MASK(yes) _mm512_movepi64_mask((__m512i) (yes))
#endif

#ifdef SD_HAS_X86_KERNELS
#include <immintrin.h>
#if LANES == LANES_OF(64) && defined(__AVX512DQ__)
#define SD_AVX512
#elif LANES == LANES_OF(32) && defined(__AVX2__)
#define SD_AVX2
#elif LANES == LANES_OF(16) && defined(__SSE2__)
#define SD_SSE2
#endif
#endif

#if LANES == 1 && !defined(__GNUC__)
#define INLINE static inline
#define NOT_INLINE static
#define ALIGNED(bytes)
#define SELDOM(condition) (condition)
#else
#define INLINE static inline __attribute__((always_inline))
#define NOT_INLINE static __attribute__((noinline))
#define ALIGNED(bytes) __attribute__((aligned(bytes)))
#define SELDOM(condition) __builtin_expect(condition, 0)
#endif

/* LANEWISE: a vector of f(lane, argument). LANE: a number of a vector. */
#ifdef SD_SINGLE
typedef int truth;
#define ROOT_OF(lane, a) sqrtf(LANE(a, lane))
#else
typedef long long truth;
#define ROOT_OF(lane, a) sqrt(LANE(a, lane))
#endif
#if LANES == 1
typedef real vec;
typedef truth yes_no;
#define LANEWISE(f, a) {f(0, a)}
#define LANE(v, k) (v)
#else
enum { VEC_BYTES = LANES * (int) sizeof(real) };
typedef real vec __attribute__((vector_size(VEC_BYTES)));
typedef real vec_anywhere __attribute__((vector_size(VEC_BYTES), aligned(sizeof(real)), may_alias));
typedef truth yes_no __attribute__((vector_size(VEC_BYTES)));
#define LANE(v, k) (v)[k]
#if LANES == 2
#define LANEWISE(f, a) {f(0, a), f(1, a)}
#elif LANES == 4
#define LANEWISE(f, a) {f(0, a), f(1, a), f(2, a), f(3, a)}
#elif LANES == 8
#define LANEWISE(f, a) {f(0, a), f(1, a), f(2, a), f(3, a), f(4, a), f(5, a), f(6, a), f(7, a)}
#else
#define LANEWISE(f, a)                                                            \
  {f(0, a), f(1, a), f(2, a),  f(3, a),  f(4, a),  f(5, a),  f(6, a),  f(7, a),     \
   f(8, a), f(9, a), f(10, a), f(11, a), f(12, a), f(13, a), f(14, a), f(15, a)}
#endif
#endif
#if SD_LANES == 1
typedef float floats;
#else
typedef float floats __attribute__((vector_size(4 * FLOATS), aligned(4), may_alias));
#endif
#define SAME(lane, a) (a)
#define NUMBER(lane, a) (lane)

INLINE vec all(real a)
{
  return (vec) LANEWISE(SAME, a);
}

/* --- memory --- */

/* From and to a multiple of the vector's size */
INLINE vec load(const real *p)
{
  return *(const vec *) p;
}

INLINE void store(real *p, vec a)
{
  *(vec *) p = a;
}

/* From and to anywhere */
INLINE vec load_any(const real *p)
{
#if LANES == 1
  return *p;
#else
  return *(const vec_anywhere *) p;
#endif
}

INLINE void store_any(real *p, vec a)
{
#if LANES == 1
  *p = a;
#else
  *(vec_anywhere *) p = a;
#endif
}

/* --- choices --- */

/* Lane k in bit k */
INLINE unsigned bits(yes_no yes)
{
#if defined(SD_AVX512)
  return MASK(yes);
#elif defined(SD_AVX2)
  return (unsigned) PACKED(256, movemask)((vec) yes);
#elif defined(SD_SSE2)
  return (unsigned) PACKED(, movemask)((vec) yes);
#else
  unsigned all_bits = 0;
  for (int k = 0; k < LANES; k++) all_bits |= (unsigned) (LANE(yes, k) != 0) << k;
  return all_bits;
#endif
}

INLINE int any(yes_no yes)
{
  return bits(yes) != 0;
}

/* a where yes, b elsewhere: no branch */
INLINE vec where(yes_no yes, vec a, vec b)
{
#if LANES == 1
  return yes ? a : b;
#elif defined(SD_AVX512)
  return PACKED(512, mask_blend)(MASK(yes), b, a);
#elif defined(SD_AVX2)
  return PACKED(256, blendv)(b, a, (vec) yes);
#else
  return (vec) ((yes & (yes_no) a) | (~yes & (yes_no) b));
#endif
}

/* The second where one of them is no number */
INLINE vec smaller(vec a, vec b)
{
#if defined(SD_AVX512)
  return PACKED(512, min)(a, b);
#elif defined(SD_AVX2)
  return PACKED(256, min)(a, b);
#elif defined(SD_SSE2)
  return PACKED(, min)(a, b);
#else
  return where(a < b, a, b);
#endif
}

INLINE vec larger(vec a, vec b)
{
#if defined(SD_AVX512)
  return PACKED(512, max)(a, b);
#elif defined(SD_AVX2)
  return PACKED(256, max)(a, b);
#elif defined(SD_SSE2)
  return PACKED(, max)(a, b);
#else
  return where(a > b, a, b);
#endif
}

/* Appends those of j that are hits to a list, which has room for LANES more; returns how many. */
INLINE int keep(int *list, const int j[LANES], unsigned hits)
{
#if defined(SD_AVX512) && LANES == 8
  const __m256i all_j = _mm256_loadu_si256((const __m256i *) j);
  _mm256_storeu_si256((__m256i *) list, _mm256_maskz_compress_epi32((__mmask8) hits, all_j));
  return __builtin_popcount(hits);
#else
  int many = 0;
  for (int k = 0; k < LANES; k++) { /* without a branch: half of them are hits */
    list[many] = j[k];
    many += hits >> k & 1;
  }
  return many;
#endif
}

/* Of the numbers j, j + 1 ... in the same way; not by way of memory, whose eight stores a vector would
 * have to wait for */
INLINE int keep_next(int *list, int j, unsigned hits)
{
#ifdef SD_AVX512
  const __m256i all_j = _mm256_add_epi32(_mm256_set1_epi32(j), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
  _mm256_storeu_si256((__m256i *) list, _mm256_maskz_compress_epi32((__mmask8) hits, all_j));
  return __builtin_popcount(hits);
#else
  int next[LANES];
  for (int k = 0; k < LANES; k++) next[k] = j + k;
  return keep(list, next, hits);
#endif
}

/* --- roots --- */

INLINE vec root(vec a)
{
#ifdef SD_AVX512
  return PACKED(512, sqrt)(a);
#else
  return (vec) LANEWISE(ROOT_OF, a); /* the compiler makes one instruction of these */
#endif
}

/* 1/sqrt(a), for a from 1e-30 to 1e30. A first guess y with the error e = 1 - a y^2, then
 * y (1-e)^(-1/2) by its series: up to e^3 with AVX-512, which guesses 14 bits; up to e^4 with the
 * guess in single precision that AVX2 has, |e| < 8e-4. Of floats up to e and to e^2. */
INLINE vec inverse_root(vec a)
{
#if defined(SD_SINGLE) && defined(SD_AVX512)
  const vec y = _mm512_rsqrt14_ps(a), e = 1.0f - a * (y * y);
  return y + y * e * 0.5f;
#elif defined(SD_SINGLE) && defined(SD_AVX2)
  const vec y = _mm256_rsqrt_ps(a), e = 1.0f - a * (y * y);
  return y + y * e * (0.5f + e * 0.375f);
#elif defined(SD_AVX512)
  const vec y = _mm512_rsqrt14_pd(a), e = 1.0 - a * (y * y);
  return y + y * e * (0.5 + e * (0.375 + e * 0.3125));
#elif defined(SD_AVX2)
  const vec y = _mm256_cvtps_pd(_mm_rsqrt_ps(_mm256_cvtpd_ps(a))), e = 1.0 - a * (y * y);
  return y + y * e * (0.5 + e * (0.375 + e * (0.3125 + e * (35.0 / 128.0))));
#else
  return all(1.0) / root(a);
#endif
}

/* The sum over the lanes */
INLINE real total(vec a)
{
#if defined(SD_SINGLE) && defined(SD_AVX512)
  return _mm512_reduce_add_ps(a);
#else
  real sum = 0.0;
  for (int k = 0; k < LANES; k++) sum += LANE(a, k);
  return sum;
#endif
}

/* --- rows of four numbers and columns --- */

#if defined(__clang__) || __GNUC__ >= 12
#define SHUFFLE(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#else
#define SHUFFLE(a, b, ...) __builtin_shuffle(a, b, (yes_no){__VA_ARGS__})
#endif

#if LANES >= 4
typedef real row4 __attribute__((vector_size(4 * sizeof(real))));
typedef real row4_anywhere __attribute__((vector_size(4 * sizeof(real)), aligned(sizeof(real)), may_alias));

INLINE row4 load4(const real *p)
{
  return *(const row4_anywhere *) p;
}

INLINE void store4(real *p, row4 a)
{
  *(row4_anywhere *) p = a;
}

#ifdef SD_SINGLE
#include "sd_single_rows.h"
#elif LANES == 8
/* Two rows side by side, and the rows of a vector */
INLINE vec beside(row4 a, row4 b)
{
#ifdef SD_AVX512
  return _mm512_insertf64x4(_mm512_castpd256_pd512(a), b, 1);
#else
  return (vec){a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]};
#endif
}

INLINE row4 part(vec a, int k)
{
#ifdef SD_AVX512
  return k ? _mm512_extractf64x4_pd(a, 1) : _mm512_castpd512_pd256(a);
#else
  return k ? (row4){a[4], a[5], a[6], a[7]} : (row4){a[0], a[1], a[2], a[3]};
#endif
}

/* In each half four rows of four become four columns: eight shuffles, two levels of pairs. */
INLINE void transpose(vec r[4])
{
  const vec a = SHUFFLE(r[0], r[1], 0, 8, 2, 10, 4, 12, 6, 14);
  const vec b = SHUFFLE(r[0], r[1], 1, 9, 3, 11, 5, 13, 7, 15);
  const vec c = SHUFFLE(r[2], r[3], 0, 8, 2, 10, 4, 12, 6, 14);
  const vec d = SHUFFLE(r[2], r[3], 1, 9, 3, 11, 5, 13, 7, 15);
  r[0] = SHUFFLE(a, c, 0, 1, 8, 9, 4, 5, 12, 13);
  r[1] = SHUFFLE(b, d, 0, 1, 8, 9, 4, 5, 12, 13);
  r[2] = SHUFFLE(a, c, 2, 3, 10, 11, 6, 7, 14, 15);
  r[3] = SHUFFLE(b, d, 2, 3, 10, 11, 6, 7, 14, 15);
}
#else
INLINE row4 part(vec a, int k)
{
  (void) k;
  return a;
}

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
INLINE void gather(const real *rows, int columns, const int j[LANES], vec r[4])
{
  for (int k = 0; k < 4; k++) {
    const row4 first = load4(rows + columns * (long) j[k]);
#if LANES == 16
    r[k] = four_beside(first, load4(rows + columns * (long) j[k + 4]),
                       load4(rows + columns * (long) j[k + 8]), load4(rows + columns * (long) j[k + 12]));
#elif LANES == 8
    r[k] = beside(first, load4(rows + columns * (long) j[k + 4]));
#else
    r[k] = first;
#endif
  }
  transpose(r);
}

/* Rows j[0 .. LANES-1] += column[0..3]. One after the other: a row may be there more than once. */
INLINE void add_to_rows(real *rows, int columns, const int j[LANES], vec column[4])
{
  transpose(column);
#pragma GCC unroll 16
  for (int k = 0; k < LANES; k++) {
    real *row = rows + columns * (long) j[k];
    store4(row, load4(row) + part(column[k % 4], k / 4));
  }
}
#else
INLINE void gather(const real *rows, int columns, const int j[LANES], vec r[4])
{
#if LANES == 2
  const real *a = rows + columns * (long) j[0], *b = rows + columns * (long) j[1];
  for (int c = 0; c < 4; c += 2) { /* two rows of two at a time */
    const vec first = load_any(a + c), second = load_any(b + c);
    r[c] = SHUFFLE(first, second, 0, 2);
    r[c + 1] = SHUFFLE(first, second, 1, 3);
  }
#else
  for (int c = 0; c < 4; c++) r[c] = rows[columns * (long) j[0] + c];
#endif
}

INLINE void add_to_rows(real *rows, int columns, const int j[LANES], vec column[4])
{
  for (int k = 0; k < LANES; k++)
    for (int c = 0; c < 4; c++) rows[columns * (long) j[k] + c] += LANE(column[c], k);
}
#endif

/* Columns 0 ... 7 of rows of eight */
#ifndef GATHERS_EIGHT
INLINE void gather_eight(const real *rows, const int j[LANES], vec r[8])
{
  gather(rows, 8, j, r);
  gather(rows + 4, 8, j, r + 4);
}
#endif

#endif
