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
#ifdef __AVX__
#include <immintrin.h>
#else
#include <emmintrin.h> /* SSE2 alone, which takes a compiler 0.2 s less to read */
#endif
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
/* A loop that is copied for some of its arguments, which are constants in a copy. Sanitizers, with whose
 * checks all copies compile for minutes, find in one what they find in all; and where there are vectors,
 * plain C need not be quick. */
#if defined(SD_SMALL) || (defined(SD_HAS_VECTORS) && SD_LANES == 1)
#define COPIED NOT_INLINE
#else
#define COPIED INLINE
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

/* --- rows of four numbers (sd_rows.h) --- */

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
#endif

#endif
