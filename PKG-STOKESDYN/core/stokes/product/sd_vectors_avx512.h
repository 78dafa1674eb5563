/* AVX-512: eight doubles; the only set with a reciprocal square root in double precision, to 14
 * bits. For kernels: see sd_pair_kernel.h. */
#ifndef SD_VECTORS_AVX512_H
#define SD_VECTORS_AVX512_H

#include <immintrin.h>

#define LANES 8
typedef __m512d vec;
typedef __mmask8 mask;
#define LOAD(p) _mm512_load_pd(p)
#define STORE(p, v) _mm512_store_pd(p, v)
#define SET1(v) _mm512_set1_pd(v)
#define LE(a, b) _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ)
#define EQ(a, b) _mm512_cmp_pd_mask(a, b, _CMP_EQ_OQ)
#define ANY(m) ((m) != 0)
#define BITS(m) ((unsigned) (m))
#define SELECT(m, a, b) _mm512_mask_blend_pd(m, b, a)
#define MAX(a, b) _mm512_max_pd(a, b)
#define SQRT(v) _mm512_sqrt_pd(v)
#define RSQRT(v) reciprocal_root(v)
#define ROWS(row, j, x, y, z, a, f0, f1, f2) \
  columns(row, j, &(x), &(y), &(z), &(a), &(f0), &(f1), &(f2))
#define TORQUES(row, j, t0, t1, t2) torque_columns(row, j, &(t0), &(t1), &(t2))

/* 1/sqrt(v): with the error e = 1 - v y^2 of the first guess, |e| < 2^-13, y (1-e)^(-1/2) by its
 * series up to e^3. */
static inline __attribute__((always_inline)) vec reciprocal_root(vec v)
{
  const vec y = _mm512_rsqrt14_pd(v), e = SET1(1.0) - v * (y * y);
  return y + y * e * (SET1(0.5) + e * (SET1(0.375) + e * SET1(0.3125)));
}

/* Transpose eight rows of eight: eight loads and 22 shuffles, where seven gathers would be 56
 * loads. */
static inline __attribute__((always_inline)) void
columns(const double *row, const int *j, vec *x, vec *y, vec *z, vec *a, vec *f0, vec *f1, vec *f2)
{
#define ROW(k) _mm512_load_pd(row + 8 * (long) j[k])
  const vec r0 = ROW(0), r1 = ROW(1), r2 = ROW(2), r3 = ROW(3);
  const vec r4 = ROW(4), r5 = ROW(5), r6 = ROW(6), r7 = ROW(7);
#undef ROW
  const vec a0 = _mm512_unpacklo_pd(r0, r1), a1 = _mm512_unpackhi_pd(r0, r1);
  const vec a2 = _mm512_unpacklo_pd(r2, r3), a3 = _mm512_unpackhi_pd(r2, r3);
  const vec a4 = _mm512_unpacklo_pd(r4, r5), a5 = _mm512_unpackhi_pd(r4, r5);
  const vec a6 = _mm512_unpacklo_pd(r6, r7), a7 = _mm512_unpackhi_pd(r6, r7);
  /* pairs of lanes now hold columns (0 2 4 6) in a0 a2 a4 a6 and (1 3 5 7) in the others */
  const vec b0 = _mm512_shuffle_f64x2(a0, a2, 0x88), b1 = _mm512_shuffle_f64x2(a0, a2, 0xdd);
  const vec b2 = _mm512_shuffle_f64x2(a4, a6, 0x88), b3 = _mm512_shuffle_f64x2(a4, a6, 0xdd);
  const vec c0 = _mm512_shuffle_f64x2(a1, a3, 0x88), c1 = _mm512_shuffle_f64x2(a1, a3, 0xdd);
  const vec c2 = _mm512_shuffle_f64x2(a5, a7, 0x88), c3 = _mm512_shuffle_f64x2(a5, a7, 0xdd);
  *x = _mm512_shuffle_f64x2(b0, b2, 0x88);
  *f0 = _mm512_shuffle_f64x2(b0, b2, 0xdd);
  *z = _mm512_shuffle_f64x2(b1, b3, 0x88);
  *f2 = _mm512_shuffle_f64x2(b1, b3, 0xdd);
  *y = _mm512_shuffle_f64x2(c0, c2, 0x88);
  *f1 = _mm512_shuffle_f64x2(c0, c2, 0xdd);
  *a = _mm512_shuffle_f64x2(c1, c3, 0x88);
}

/* Four rows in each half of four vectors, then pairs of columns, then the columns. */
static inline __attribute__((always_inline)) void torque_columns(const double *row, const int *j,
                                                                 vec *t0, vec *t1, vec *t2)
{
#define ROW(k) _mm256_load_pd(row + 4 * (long) j[k])
#define ROWS_OF(k) _mm512_insertf64x4(_mm512_castpd256_pd512(ROW(k)), ROW(k + 4), 1)
  const vec r0 = ROWS_OF(0), r1 = ROWS_OF(1), r2 = ROWS_OF(2), r3 = ROWS_OF(3);
#undef ROWS_OF
#undef ROW
  const vec even01 = _mm512_unpacklo_pd(r0, r1), even23 = _mm512_unpacklo_pd(r2, r3);
  const vec odd01 = _mm512_unpackhi_pd(r0, r1), odd23 = _mm512_unpackhi_pd(r2, r3);
  const __m512i low = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13),
                high = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  *t0 = _mm512_permutex2var_pd(even01, low, even23);
  *t1 = _mm512_permutex2var_pd(odd01, low, odd23);
  *t2 = _mm512_permutex2var_pd(even01, high, even23);
}

#endif
