/* Of sd_lanes.h for vectors of FLOATS floats, where single precision is enough: twice as many numbers
 * in a vector, or as many in half of one. For sources only. */
#ifndef SD_FLOAT_LANES_H
#define SD_FLOAT_LANES_H

#include "sd_lanes.h"

#if FLOATS == 1
#define FLOATWISE(a) {a}
typedef int float_bits;
#else
#if FLOATS == 4
#define FLOATWISE(a) {a, a, a, a}
#else
#define FLOATWISE(a) {a, a, a, a, a, a, a, a}
#endif
typedef int float_bits __attribute__((vector_size(4 * FLOATS)));
#endif
#if FLOATS == 8 && defined(__AVX2__) && defined(SD_HAS_X86_KERNELS)
#define SD_EIGHT_FLOATS
#elif FLOATS == 4 && defined(__SSE2__) && defined(SD_HAS_X86_KERNELS)
#define SD_FOUR_FLOATS
#endif

INLINE floats all_floats(float a)
{
  return (floats) FLOATWISE(a);
}

INLINE floats load_floats(const float *p)
{
  return *(const floats *) p;
}

INLINE void store_floats(float *p, floats a)
{
  *(floats *) p = a;
}

/* x where a <= most, 0 elsewhere */
INLINE floats floats_within(floats a, floats most, floats x)
{
#if FLOATS == 1
  return a <= most ? x : 0.0f;
#elif defined(SD_EIGHT_FLOATS)
  return _mm256_and_ps(_mm256_cmp_ps(a, most, _CMP_LE_OQ), x);
#else
  return (floats) ((a <= most) & (float_bits) x);
#endif
}

INLINE floats larger_floats(floats a, floats b)
{
#if FLOATS == 1
  return a > b ? a : b;
#elif defined(SD_EIGHT_FLOATS)
  return _mm256_max_ps(a, b);
#elif defined(SD_FOUR_FLOATS)
  return _mm_max_ps(a, b);
#else
  const float_bits yes = a > b;
  return (floats) ((yes & (float_bits) a) | (~yes & (float_bits) b));
#endif
}

INLINE floats smaller_floats(floats a, floats b)
{
#if defined(SD_EIGHT_FLOATS)
  return _mm256_min_ps(a, b);
#elif defined(SD_FOUR_FLOATS)
  return _mm_min_ps(a, b);
#else
  return -larger_floats(-a, -b);
#endif
}

/* Those lanes where a <= b: lane k in bit k */
INLINE unsigned float_hits(floats a, floats b)
{
#if FLOATS == 1
  return a <= b;
#elif defined(SD_EIGHT_FLOATS)
  return (unsigned) _mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ));
#elif defined(SD_FOUR_FLOATS)
  return (unsigned) _mm_movemask_ps(_mm_cmple_ps(a, b));
#else
  const float_bits yes = a <= b;
  unsigned hits = 0;
  for (int k = 0; k < FLOATS; k++) hits |= (unsigned) (yes[k] != 0) << k;
  return hits;
#endif
}

/* 1/sqrt(a), for a from 1e-30 to 1e30, to the last bit or two. A guess of 11 bits or more, and the
 * series of inverse_root() up to e^2. */
INLINE floats inverse_root_floats(floats a)
{
#if defined(SD_EIGHT_FLOATS) || defined(SD_FOUR_FLOATS)
#ifdef SD_EIGHT_FLOATS
  const floats y = _mm256_rsqrt_ps(a);
#else
  const floats y = _mm_rsqrt_ps(a);
#endif
  const floats e = 1.0f - a * (y * y);
  return y + y * e * (0.5f + 0.375f * e);
#elif FLOATS == 1
  return 1.0f / sqrtf(a);
#else
  floats y = a;
  for (int k = 0; k < FLOATS; k++) y[k] = 1.0f / sqrtf(a[k]);
  return y;
#endif
}

#endif
