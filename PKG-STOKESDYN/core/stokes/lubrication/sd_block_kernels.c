/* Arithmetic of sd_block_cholesky.h in vectors of FLOATS floats.
 *
 * What is done to a block is done to whole rows of it, so that nothing has to be summed over lanes:
 * a row less rows of another block times numbers of a third. So the factor of a pivot is kept as
 * the upper U = G^T, and of column blocks the transposed ones, C_q^T. Rows of blocks that the factor keeps
 * stand one right behind the other, so that what is in the last lanes of a vector is the next row's: it gets
 * into the last lanes of results, which nobody reads. */
#include <math.h>

#include "sd_block_internal.h"
#include "sd_lanes.h"

/* The vector that begins at p */
#define AT(p) (*(floats *) (p))

enum { ROW = SD_BLOCK_LANES };

/* v - sum over k < count of s[stride k] b[k] */
INLINE floats less(floats v, int count, const float *s, int stride, const floats *b)
{
  for (int k = 0; k < count; k++) v -= s[stride * k] * b[k];
  return v;
}

/* A part of the rows of a block, one every `stride`: the vectors that begin at B */
INLINE void load_rows(const float *B, int stride, floats b[6])
{
  for (int k = 0; k < 6; k++) b[k] = AT(B + stride * k);
}

INLINE float six_of(const float *lanes)
{
  return lanes[0] + lanes[1] + lanes[2] + (lanes[3] + lanes[4] + lanes[5]);
}

/* --- the elimination of a node --- */

/* A = U^T U in its place, row by row from above; below the diagonal is rounding. part: 1 over the
 * diagonal of U */
static int factor(float *A, float part[6])
{
  for (int p = 0; p < 6; p++) {
    float *up = A + ROW * p;
    for (int h = 0; h < ROW; h += FLOATS) {
      floats v = AT(up + h);
      for (int k = 0; k < p; k++) v -= A[ROW * k + p] * AT(A + ROW * k + h);
      AT(up + h) = v;
    }
    if (!(up[p] > 0.0f)) return 0;
    part[p] = 1.0f / sqrtf(up[p]);
    for (int h = 0; h < ROW; h += FLOATS) AT(up + h) *= part[p];
  }
  return 1;
}

/* X = U^-1 from U X = 1, row by row from below */
static void block_invert(const float *U, const float part[6], float *X)
{
  for (int p = 5; p >= 0; p--) {
    float unit[ROW] = {0.0f};
    unit[p] = part[p];
    for (int h = 0; h < ROW; h += FLOATS) {
      floats v = AT(unit + h);
      for (int k = p + 1; k < 6; k++) v -= part[p] * U[ROW * p + k] * AT(X + ROW * k + h);
      AT(X + ROW * p + h) = v;
    }
  }
}

static int block_divide(float *pivot, float *inverse, int count, float *column)
{
  float part[6];
  if (!factor(pivot, part)) return 0;
  block_invert(pivot, part, inverse);
  for (int c = 0; c < count; c++)
    for (int h = 0; h < ROW; h += FLOATS) {
      float *B = column + SD_BLOCK * (long) c + h;
      floats b[6];
      for (int p = 0; p < 6; p++) {
        b[p] = part[p] * less(AT(B + ROW * p), p, pivot + p, ROW, b);
        AT(B + ROW * p) = b[p];
      }
    }
  return 1;
}

/* out -= A^T B */
INLINE void subtract_product(const float *A, const float *B, float *out)
{
  for (int h = 0; h < ROW; h += FLOATS) {
    floats b[6];
    load_rows(B + h, ROW, b);
    for (int p = 0; p < 6; p++)
      AT(out + ROW * p + h) = less(AT(out + ROW * p + h), 6, A + p, ROW, b);
  }
}

/* out = -A^T B; returns the sum of its squares */
INLINE float set_product(const float *A, const float *B, float *out)
{
  float lanes[ROW];
  for (int h = 0; h < ROW; h += FLOATS) {
    const floats none = {0.0f};
    floats b[6], squares = none;
    load_rows(B + h, ROW, b);
    for (int p = 0; p < 6; p++) {
      const floats v = less(none, 6, A + p, ROW, b);
      squares += v * v;
      AT(out + ROW * p + h) = v;
    }
    AT(lanes + h) = squares;
  }
  return six_of(lanes);
}

static void block_subtract(const float *column, float *pivot, int count, sd_block_target *target)
{
  subtract_product(column, column, pivot);
  for (int t = 0; t < count; t++) {
    const float *other = column + SD_BLOCK * (long) (t + 1);
    if (target[t].way == SD_BLOCK_NEW)
      target[t].square = set_product(column, other, target[t].to);
    else if (target[t].way == SD_BLOCK_TURNED)
      subtract_product(other, column, target[t].to);
    else
      subtract_product(column, other, target[t].to);
  }
}

/* --- to apply it: blocks as the factor keeps them --- */

/* Blocks that are wanted so many later are fetched: back is against the order in which a processor foresees
 * what is wanted. */
enum { KEPT_ROW = 6, AHEAD = 24 };

INLINE void fetch_block(const float *first, long e)
{
  enum { LINE = 16 };
  for (int k = 0; k < SD_BLOCK_KEPT && e >= 0; k += LINE) sd_fetch(first + SD_BLOCK_KEPT * e + k);
}

/* v -= A^T y, A by rows */
INLINE void forward(const float *A, const float *y, float *v)
{
  for (int h = 0; h < ROW; h += FLOATS) {
    floats a[6];
    load_rows(A + h, KEPT_ROW, a);
    AT(v + h) = less(AT(v + h), 6, y, 1, a);
  }
}

/* A v of its rows, added to what is in the lanes of `sums` */
INLINE void backward(const float *A, const float *v, float *sums)
{
  for (int k = 0; k < SD_BLOCK; k += FLOATS)
    AT(sums + k) += AT(A + KEPT_ROW * (k / ROW) + k % ROW) * AT(v + k % ROW);
}

static void block_forth(const sd_block_cholesky *f, long begin, long end)
{
  float *v = f->vector;
  for (long k = begin; k < end; k++) {
    float *at = v + ROW * (long) f->order[k], y[ROW] = {0.0f};
    for (int c = 0; c < 6; c++) at[c] = -at[c];
    forward(f->inverse + SD_BLOCK_KEPT * k, at, y);
    for (int h = 0; h < ROW; h += FLOATS) AT(at + h) = AT(y + h);
    for (long e = f->first[k]; e < f->first[k + 1]; e++)
      forward(f->column + SD_BLOCK_KEPT * e, y, v + ROW * (long) f->row[e]);
  }
}

static void block_back(const sd_block_cholesky *f, long begin, long end)
{
  float *v = f->vector;
  for (long k = end - 1; k >= begin; k--) {
    float *at = v + ROW * (long) f->order[k], sums[SD_BLOCK] = {0.0f}, x[SD_BLOCK] = {0.0f};
    fetch_block(f->inverse, k - AHEAD);
    for (long e = f->first[k + 1] - 1; e >= f->first[k]; e--) {
      fetch_block(f->column, e - AHEAD);
      sd_fetch(v + ROW * (long) f->row[e < AHEAD ? 0 : e - AHEAD]);
      backward(f->column + SD_BLOCK_KEPT * e, v + ROW * (long) f->row[e], sums);
    }
    for (int c = 0; c < 6; c++) at[c] -= six_of(sums + ROW * c);
    backward(f->inverse + SD_BLOCK_KEPT * k, at, x);
    for (int c = 0; c < 6; c++) at[c] = six_of(x + ROW * c);
  }
}

const struct sd_block_kernels SD_KERNELS(sd_block) = {block_divide, block_subtract, block_forth, block_back};
