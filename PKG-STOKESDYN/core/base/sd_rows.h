/* Rows of four numbers, as spheres have them, and vectors with one number of each of many rows. */
#ifndef SD_ROWS_H
#define SD_ROWS_H

#include "sd_lanes.h"

#if LANES >= 4
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
#define ROW(k) load4(rows + columns * (long) j[k])
INLINE void gather(const real *rows, int columns, const int j[LANES], vec r[4])
{
#if LANES == 8 && !defined(SD_SINGLE)
  /* Side by side stand rows of which whole quarters of vectors make columns: that takes no index. */
  const vec e = beside(ROW(0), ROW(2)), f = beside(ROW(1), ROW(3));
  const vec g = beside(ROW(4), ROW(6)), h = beside(ROW(5), ROW(7));
  const vec a = SHUFFLE(e, f, 0, 8, 2, 10, 4, 12, 6, 14), b = SHUFFLE(e, f, 1, 9, 3, 11, 5, 13, 7, 15);
  const vec c = SHUFFLE(g, h, 0, 8, 2, 10, 4, 12, 6, 14), d = SHUFFLE(g, h, 1, 9, 3, 11, 5, 13, 7, 15);
  r[0] = SHUFFLE(a, c, 0, 1, 4, 5, 8, 9, 12, 13);
  r[1] = SHUFFLE(b, d, 0, 1, 4, 5, 8, 9, 12, 13);
  r[2] = SHUFFLE(a, c, 2, 3, 6, 7, 10, 11, 14, 15);
  r[3] = SHUFFLE(b, d, 2, 3, 6, 7, 10, 11, 14, 15);
#else
  for (int k = 0; k < 4; k++)
#if LANES == 16
    r[k] = four_beside(ROW(k), ROW(k + 4), ROW(k + 8), ROW(k + 12));
#elif LANES == 8
    r[k] = beside(ROW(k), ROW(k + 4));
#else
    r[k] = ROW(k);
#endif
  transpose(r);
#endif
}
#undef ROW

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
