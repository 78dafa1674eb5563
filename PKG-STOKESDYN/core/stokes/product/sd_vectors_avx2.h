/* AVX2 with fused multiply-add: four doubles. For kernels: see sd_pair_kernel.h. */
#ifndef SD_VECTORS_AVX2_H
#define SD_VECTORS_AVX2_H

#include <immintrin.h>

#define LANES 4
typedef __m256d vec;
typedef __m256d mask;
#define LOAD(p) _mm256_load_pd(p)
#define STORE(p, v) _mm256_store_pd(p, v)
#define SET1(v) _mm256_set1_pd(v)
#define LE(a, b) _mm256_cmp_pd(a, b, _CMP_LE_OQ)
#define EQ(a, b) _mm256_cmp_pd(a, b, _CMP_EQ_OQ)
#define ANY(m) (_mm256_movemask_pd(m) != 0)
#define BITS(m) ((unsigned) _mm256_movemask_pd(m))
#define SELECT(m, a, b) _mm256_blendv_pd(b, a, m)
#define MAX(a, b) _mm256_max_pd(a, b)
#define SQRT(v) _mm256_sqrt_pd(v)
#define RSQRT(v) reciprocal_root(v)
#define ROWS(row, j, x, y, z, a, f0, f1, f2)                 \
  do {                                                       \
    vec unused_;                                             \
    columns(row, 8, j, &(x), &(y), &(z), &(a));              \
    columns((row) + 4, 8, j, &(f0), &(f1), &(f2), &unused_); \
  } while (0)
#define TORQUES(row, j, t0, t1, t2)                    \
  do {                                                 \
    vec unused_;                                       \
    columns(row, 4, j, &(t0), &(t1), &(t2), &unused_); \
  } while (0)

/* 1/sqrt(v): first guess in single precision, error e = 1 - v y^2, |e| < 8e-4; y (1-e)^(-1/2) by
 * its series up to e^4. */
static inline __attribute__((always_inline)) vec reciprocal_root(vec v)
{
  const vec y = _mm256_cvtps_pd(_mm_rsqrt_ps(_mm256_cvtpd_ps(v))), e = SET1(1.0) - v * (y * y);
  return y + y * e * (SET1(0.5) + e * (SET1(0.375) + e * (SET1(0.3125) + e * SET1(35.0 / 128.0))));
}

/* Rows p0 ... p3 of four doubles become columns. */
static inline __attribute__((always_inline)) void transpose(const double *p0, const double *p1,
                                                            const double *p2, const double *p3,
                                                            vec *c0, vec *c1, vec *c2, vec *c3)
{
  const vec r0 = LOAD(p0), r1 = LOAD(p1), r2 = LOAD(p2), r3 = LOAD(p3);
  const vec even01 = _mm256_unpacklo_pd(r0, r1), odd01 = _mm256_unpackhi_pd(r0, r1);
  const vec even23 = _mm256_unpacklo_pd(r2, r3), odd23 = _mm256_unpackhi_pd(r2, r3);
  *c0 = _mm256_permute2f128_pd(even01, even23, 0x20);
  *c1 = _mm256_permute2f128_pd(odd01, odd23, 0x20);
  *c2 = _mm256_permute2f128_pd(even01, even23, 0x31);
  *c3 = _mm256_permute2f128_pd(odd01, odd23, 0x31);
}

/* Columns of the rows j[0] ... j[3], each of so many doubles, from the one named on. */
static inline __attribute__((always_inline)) void
columns(const double *row, int width, const int *j, vec *c0, vec *c1, vec *c2, vec *c3)
{
  transpose(row + width * (long) j[0], row + width * (long) j[1], row + width * (long) j[2],
            row + width * (long) j[3], c0, c1, c2, c3);
}

#endif
