/* The kernels of the engine ewald in plain C: vectors of one number, for any compiler. */
#include <math.h>
#include <string.h>

#ifndef __GNUC__
#define __attribute__(x)
#define __builtin_expect(x, y) (x)
#define __builtin_memcpy memcpy
#endif
#define LANES 1
typedef double vec;
typedef int mask;
#define LOAD(p) (*(p))
#define STORE(p, v) (*(p) = (v))
#define SET1(v) ((double) (v))
#define LE(a, b) ((a) <= (b))
#define EQ(a, b) ((a) == (b))
#define ANY(m) (m)
#define BITS(m) ((unsigned) (m))
#define SELECT(m, a, b) ((m) ? (a) : (b))
#define MAX(a, b) fmax(a, b)
#define SQRT(v) sqrt(v)
#define RSQRT(v) (1.0 / sqrt(v))
#define ROWS(row, j, x, y, z, a, f0, f1, f2)  \
  do {                                        \
    const double *row_ = (row) + 8 * (long) *(j); \
    x = row_[0], y = row_[1], z = row_[2];    \
    a = row_[3];                              \
    f0 = row_[4], f1 = row_[5], f2 = row_[6]; \
  } while (0)
#define TORQUES(row, j, t0, t1, t2)           \
  do {                                        \
    const double *row_ = (row) + 4 * (long) *(j); \
    t0 = row_[0], t1 = row_[1], t2 = row_[2]; \
  } while (0)

#define SD_KERNELS sd_ewald_plain
#include "sd_ewald_kernel.h"
