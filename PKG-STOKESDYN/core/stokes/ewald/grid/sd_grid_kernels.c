/* Kernels of the grid, of doubles; sd_grid_single_kernels.c: the same of floats.
 *
 * Two real lines a and b of n points are the parts of one complex line, Z = A + i B. Of real lines
 * conj A(n - k) is A(k), and so
 *
 *   A(k) = (Z(k) + conj Z(n - k))/2,   B(k) = (Z(k) - conj Z(n - k))/2i,   conj Z(n - k) = A(k) - i B(k) */
#include "sd_grid_internal.h"
#include "sd_lanes.h"

#if LANES == 16
#define BACKWARDS 14, 15, 12, 13, 10, 11, 8, 9, 6, 7, 4, 5, 2, 3, 0, 1
#define SWAPPED 1, 0, 3, 2, 5, 4, 7, 6, 9, 8, 11, 10, 13, 12, 15, 14
#elif LANES == 8
#define BACKWARDS 6, 7, 4, 5, 2, 3, 0, 1
#define SWAPPED 1, 0, 3, 2, 5, 4, 7, 6
#elif LANES == 4
#define BACKWARDS 2, 3, 0, 1
#define SWAPPED 1, 0, 3, 2
#elif LANES == 2
#define BACKWARDS 0, 1
#define SWAPPED 1, 0
#endif

/* Waves that have a partner, which is another one, end here. */
static int end_of_partners(int n, int waves)
{
  return waves < (n + 1) / 2 ? waves : (n + 1) / 2;
}

/* One of them at a time */
static void part_wave(const real *z, const real *partner, real *a, real *b)
{
  const real half = (real) 0.5, re = half * z[0], im = half * z[1], pr = half * partner[0], pi = half * partner[1];
  a[0] = re + pr;
  a[1] = im - pi;
  b[0] = im + pi;
  b[1] = pr - re;
}

static void join_wave(const real *a, const real *b, real *z, real *partner)
{
  z[0] = a[0] - b[1];
  z[1] = a[1] + b[0];
  partner[0] = a[0] + b[1];
  partner[1] = b[0] - a[1];
}

#if LANES > 1
/* Waves of a vector, and what their parts are multiplied with */
enum { WAVES = LANES / 2 };
#define ODD_MINUS(lane, a) ((lane) % 2 ? -(a) : (a))

/* From wave `first` on, as many as are in a vector */
INLINE void part_waves(const real *both, int n, int first, real *a, real *b)
{
  const vec sign = LANEWISE(ODD_MINUS, (real) 0.5), z = all((real) 0.5) * load_any(both + 2 * first);
  const vec there = load_any(both + 2 * (n - first - WAVES + 1)), partner = sign * SHUFFLE(there, there, BACKWARDS);
  const vec difference = z - partner, sign_of_b = LANEWISE(ODD_MINUS, (real) 1.0);
  store_any(a + 2 * first, z + partner);
  store_any(b + 2 * first, sign_of_b * SHUFFLE(difference, difference, SWAPPED));
}

INLINE void join_waves(const real *a, const real *b, int n, int first, real *both)
{
  const vec sign = LANEWISE(ODD_MINUS, (real) 1.0), A = load_any(a + 2 * first), B = load_any(b + 2 * first);
  const vec turned = sign * SHUFFLE(B, B, SWAPPED), partner = sign * (A + turned);
  store_any(both + 2 * first, A - turned);
  store_any(both + 2 * (n - first - WAVES + 1), SHUFFLE(partner, partner, BACKWARDS));
}
#else
enum { WAVES = 1 };
#define part_waves(both, n, k, a, b) part_wave((both) + 2 * (k), (both) + 2 * ((n) - (k)), (a) + 2 * (k), (b) + 2 * (k))
#define join_waves(a, b, n, k, both) join_wave((a) + 2 * (k), (b) + 2 * (k), (both) + 2 * (k), (both) + 2 * ((n) - (k)))
#endif

/* Waves 0 and n/2 are their own partners, and real. */
static void part_real(const real *z, real *a, real *b)
{
  a[0] = z[0];
  b[0] = z[1];
  a[1] = b[1] = 0;
}

static void join_real(const real *a, const real *b, real *z)
{
  z[0] = a[0];
  z[1] = b[0];
}

/* The last vector begins where it ends with the last wave, so that some are found twice. */
static void part(const void *both, int n, int waves, void *a_line, void *b_line)
{
  const real *z = both;
  real *a = a_line, *b = b_line;
  const int end = end_of_partners(n, waves);
  part_real(z, a, b);
  if (end > WAVES)
    for (int k = 1; k < end; k += WAVES) part_waves(z, n, k < end - WAVES ? k : end - WAVES, a, b);
  else
    for (int k = 1; k < end; k++) part_wave(z + 2 * k, z + 2 * (n - k), a + 2 * k, b + 2 * k);
  if (end < waves) part_real(z + 2 * end, a + 2 * end, b + 2 * end);
}

static void join(const void *a_line, const void *b_line, int n, int waves, void *both)
{
  const real *a = a_line, *b = b_line;
  real *z = both;
  const int end = end_of_partners(n, waves);
  join_real(a, b, z);
  if (end > WAVES)
    for (int k = 1; k < end; k += WAVES) join_waves(a, b, n, k < end - WAVES ? k : end - WAVES, z);
  else
    for (int k = 1; k < end; k++) join_wave(a + 2 * k, b + 2 * k, z + 2 * k, z + 2 * (n - k));
  if (end < waves)
    join_real(a + 2 * end, b + 2 * end, z + 2 * end);
  else if (n - end + 1 > end)
    memset(z + 2 * end, 0, 2 * sizeof(real) * (size_t) (n - 2 * end + 1));
}

static void add_rows(const void *a_row, const void *b_row, int n, void *const *line)
{
  const real *restrict a = a_row, *restrict b = b_row;
  real *restrict x = line[0], *restrict y = line[1], *restrict z = line[2];
  for (int k = 0; k < n; k++) {
    x[2 * k] += a[3 * k];
    x[2 * k + 1] += b[3 * k];
    y[2 * k] += a[3 * k + 1];
    y[2 * k + 1] += b[3 * k + 1];
    z[2 * k] += a[3 * k + 2];
    z[2 * k + 1] += b[3 * k + 2];
  }
}

static void take_rows(void *a_row, void *b_row, int n, void *const *line)
{
  real *restrict a = a_row, *restrict b = b_row;
  const real *restrict x = line[0], *restrict y = line[1], *restrict z = line[2];
  for (int k = 0; k < n; k++) {
    a[3 * k] = x[2 * k];
    b[3 * k] = x[2 * k + 1];
    a[3 * k + 1] = y[2 * k];
    b[3 * k + 1] = y[2 * k + 1];
    a[3 * k + 2] = z[2 * k];
    b[3 * k + 2] = z[2 * k + 1];
  }
}

#ifdef SD_SINGLE
const struct sd_grid_kernels SD_KERNELS(sd_grid_single) = {part, join, add_rows, take_rows};
#else
const struct sd_grid_kernels SD_KERNELS(sd_grid) = {part, join, add_rows, take_rows};
#endif
