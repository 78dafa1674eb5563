/* What every processor has: SSE2 on x86-64 (two doubles), the compiler's own choice elsewhere. For
 * kernels: see sd_pair_kernel.h. */
#ifndef SD_VECTORS_BASELINE_H
#define SD_VECTORS_BASELINE_H

#include "sd_product_internal.h"

#define LANES 2
#define SQRT(v) roots(v)
#define RSQRT(v) (SET1(1.0) / roots(v))

#ifdef SD_HAS_X86_KERNELS
#include <emmintrin.h>
typedef __m128d vec;
typedef __m128d mask;
#define LOAD(p) _mm_load_pd(p)
#define STORE(p, v) _mm_store_pd(p, v)
#define SET1(v) _mm_set1_pd(v)
#define LE(a, b) _mm_cmple_pd(a, b)
#define EQ(a, b) _mm_cmpeq_pd(a, b)
#define ANY(m) (_mm_movemask_pd(m) != 0)
#define BITS(m) ((unsigned) _mm_movemask_pd(m))
#define SELECT(m, a, b) _mm_or_pd(_mm_and_pd(m, a), _mm_andnot_pd(m, b))
#define MAX(a, b) _mm_max_pd(a, b)
static inline __attribute__((always_inline)) vec roots(vec v)
{
  return _mm_sqrt_pd(v);
}
#else
#include <math.h>
#include <stdint.h>
typedef double vec __attribute__((vector_size(16)));
typedef int64_t mask __attribute__((vector_size(16)));
#define LOAD(p) (*(const vec *) (p))
#define STORE(p, v) (*(vec *) (p) = (v))
#define SET1(v) ((vec){(v), (v)})
#define LE(a, b) ((a) <= (b))
#define EQ(a, b) ((a) == (b))
#define ANY(m) (((m)[0] | (m)[1]) != 0)
#define BITS(m) ((unsigned) (((m)[0] & 1) | ((m)[1] & 2)))
#define SELECT(m, a, b) ((vec) (((m) & (mask) (a)) | (~(m) & (mask) (b))))
#define MAX(a, b) SELECT((a) > (b), a, b)
static inline __attribute__((always_inline)) vec roots(vec v)
{
  return (vec){sqrt(v[0]), sqrt(v[1])};
}
#endif

/* Two rows become columns element by element: there is no shuffle that would be quicker. */
#define COLUMN(row, width, j, k) \
  ((vec){(row)[(width) * (long) (j)[0] + (k)], (row)[(width) * (long) (j)[1] + (k)]})
#define ROWS(row, j, x, y, z, a, f0, f1, f2) \
  do {                                       \
    x = COLUMN(row, 8, j, 0);                \
    y = COLUMN(row, 8, j, 1);                \
    z = COLUMN(row, 8, j, 2);                \
    a = COLUMN(row, 8, j, 3);                \
    f0 = COLUMN(row, 8, j, 4);               \
    f1 = COLUMN(row, 8, j, 5);               \
    f2 = COLUMN(row, 8, j, 6);               \
  } while (0)
#define TORQUES(row, j, t0, t1, t2) \
  do {                              \
    t0 = COLUMN(row, 4, j, 0);      \
    t1 = COLUMN(row, 4, j, 1);      \
    t2 = COLUMN(row, 4, j, 2);      \
  } while (0)

#endif
