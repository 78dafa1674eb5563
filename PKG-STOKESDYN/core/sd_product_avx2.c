/* AVX2 with fused multiply-add: four doubles. */
#include "sd_product_internal.h"

#ifdef SD_HAS_X86_KERNELS
#include <immintrin.h>

#define SD_KERNELS sd_kernels_avx2
#define LANES 4
typedef __m256d vec;
typedef __m256d mask;
#define LOAD(p) _mm256_load_pd(p)
#define STORE(p, v) _mm256_store_pd(p, v)
#define SET1(v) _mm256_set1_pd(v)
#define LE(a, b) _mm256_cmp_pd(a, b, _CMP_LE_OQ)
#define EQ(a, b) _mm256_cmp_pd(a, b, _CMP_EQ_OQ)
#define ANY(m) (_mm256_movemask_pd(m) != 0)
#define SELECT(m, a, b) _mm256_blendv_pd(b, a, m)
#define MAX(a, b) _mm256_max_pd(a, b)
#define SQRT(v) _mm256_sqrt_pd(v)
#define RSQRT(v) reciprocal_root(v)
#define ROWS(row, j, x, y, z, a, f0, f1, f2) \
  columns(row, j, &(x), &(y), &(z), &(a), &(f0), &(f1), &(f2))

/* 1/sqrt(v): first guess in single precision, error e = 1 - v y^2, |e| < 8e-4; y (1-e)^(-1/2) by its series up to e^4. */
static inline __attribute__((always_inline)) vec reciprocal_root(vec v)
{
  const vec y = _mm256_cvtps_pd(_mm_rsqrt_ps(_mm256_cvtpd_ps(v))), e = SET1(1.0) - v * (y * y);
  return y + y * e * (SET1(0.5) + e * (SET1(0.375) + e * (SET1(0.3125) + e * SET1(35.0 / 128.0))));
}

static inline __attribute__((always_inline)) void
columns(const double *row, const int *j, vec *x, vec *y, vec *z, vec *a, vec *f0, vec *f1, vec *f2)
{
#define ROW(k, half) _mm256_load_pd(row + 8 * (long) j[k] + 4 * (half))
#define TRANSPOSE(half, c0, c1, c2, c3)                                                   \
  do {                                                                                    \
    const vec r0 = ROW(0, half), r1 = ROW(1, half), r2 = ROW(2, half), r3 = ROW(3, half); \
    const vec p0 = _mm256_unpacklo_pd(r0, r1), p1 = _mm256_unpackhi_pd(r0, r1);           \
    const vec p2 = _mm256_unpacklo_pd(r2, r3), p3 = _mm256_unpackhi_pd(r2, r3);           \
    c0 = _mm256_permute2f128_pd(p0, p2, 0x20);                                            \
    c1 = _mm256_permute2f128_pd(p1, p3, 0x20);                                            \
    c2 = _mm256_permute2f128_pd(p0, p2, 0x31);                                            \
    c3 = _mm256_permute2f128_pd(p1, p3, 0x31);                                            \
  } while (0)
  vec unused;
  TRANSPOSE(0, *x, *y, *z, *a);
  TRANSPOSE(1, *f0, *f1, *f2, unused);
  (void) unused;
#undef TRANSPOSE
#undef ROW
}

#include "sd_product_kernel.h"
#endif
