/* Rows of four floats in vectors, each a part of 128 bits: of sd_rows.h where numbers are floats. */
#ifndef SD_SINGLE_ROWS_H
#define SD_SINGLE_ROWS_H

#include "sd_lanes.h"

/* Rows side by side, the rows of a vector, and in each part four rows of four that become four columns:
 * eight shuffles, two levels of pairs. WIDE: the instruction of a whole vector. */
#if LANES == 16
#define WIDE(op) PACKED(512, op)

INLINE vec four_beside(row4 a, row4 b, row4 c, row4 d)
{
  const __m256 low = _mm256_insertf128_ps(_mm256_castps128_ps256(a), b, 1);
  const __m256 high = _mm256_insertf128_ps(_mm256_castps128_ps256(c), d, 1);
  return _mm512_insertf32x8(_mm512_castps256_ps512(low), high, 1);
}

INLINE row4 part(vec a, int k)
{
  return k == 0 ? _mm512_castps512_ps128(a)
      : k == 1  ? _mm512_extractf32x4_ps(a, 1)
      : k == 2  ? _mm512_extractf32x4_ps(a, 2)
                : _mm512_extractf32x4_ps(a, 3);
}
#elif LANES == 8
#define WIDE(op) PACKED(256, op)

INLINE vec beside(row4 a, row4 b)
{
  return _mm256_insertf128_ps(_mm256_castps128_ps256(a), b, 1);
}

INLINE row4 part(vec a, int k)
{
  return k ? _mm256_extractf128_ps(a, 1) : _mm256_castps256_ps128(a);
}
#else
INLINE row4 part(vec a, int k)
{
  (void) k;
  return a;
}
#endif

INLINE void transpose(vec r[4])
{
#ifdef WIDE
  const vec a = WIDE(unpacklo)(r[0], r[1]), b = WIDE(unpackhi)(r[0], r[1]);
  const vec c = WIDE(unpacklo)(r[2], r[3]), d = WIDE(unpackhi)(r[2], r[3]);
  r[0] = WIDE(shuffle)(a, c, 0x44);
  r[1] = WIDE(shuffle)(a, c, 0xee);
  r[2] = WIDE(shuffle)(b, d, 0x44);
  r[3] = WIDE(shuffle)(b, d, 0xee);
#else
  const vec a = SHUFFLE(r[0], r[1], 0, 4, 1, 5), b = SHUFFLE(r[0], r[1], 2, 6, 3, 7);
  const vec c = SHUFFLE(r[2], r[3], 0, 4, 1, 5), d = SHUFFLE(r[2], r[3], 2, 6, 3, 7);
  r[0] = SHUFFLE(a, c, 0, 1, 4, 5);
  r[1] = SHUFFLE(a, c, 2, 3, 6, 7);
  r[2] = SHUFFLE(b, d, 0, 1, 4, 5);
  r[3] = SHUFFLE(b, d, 2, 3, 6, 7);
#endif
}

#ifdef WIDE
/* Rows of eight become columns. Of four rows transposed each 256 bits have four columns in one part, the four
 * others in the other. */
INLINE void columns_of_eight(vec r[8])
{
  transpose(r);
  transpose(r + 4);
  for (int c = 0; c < 4; c++) {
    const vec a = r[c], b = r[4 + c];
#if LANES == 16
    r[c] = _mm512_shuffle_f32x4(a, b, 0x88);
    r[4 + c] = _mm512_shuffle_f32x4(a, b, 0xdd);
#else
    r[c] = _mm256_permute2f128_ps(a, b, 0x20);
    r[4 + c] = _mm256_permute2f128_ps(a, b, 0x31);
#endif
  }
}

/* Rows of eight floats are half a vector, with row k + 4 beside row k, or a whole one: each is loaded at
 * once. */
#define GATHERS_EIGHT
INLINE void gather_eight(const real *rows, const int j[LANES], vec r[8])
{
  for (int k = 0; k < 8; k++) {
#if LANES == 16
    const int *at = j + k + k / 4 * 4;
    const __m256 low = _mm256_loadu_ps(rows + 8 * (long) at[0]);
    const __m256 high = _mm256_loadu_ps(rows + 8 * (long) at[4]);
    r[k] = _mm512_insertf32x8(_mm512_castps256_ps512(low), high, 1);
#else
    r[k] = load_any(rows + 8 * (long) j[k]);
#endif
  }
  columns_of_eight(r);
}
#endif

#endif
