/* Vectors of pairs side by side: what the loops of SPH have beside sd_lanes.h. */
#ifndef SD_SPH_LANES_H
#define SD_SPH_LANES_H

#include "sd_sph_kernel.h"

#define LEAST_LANES 4 /* rows have four numbers */
#include "sd_rows.h"

INLINE yes_no same(long long a)
{
  return (yes_no) LANEWISE(SAME, a);
}

/* Takes column[0..3] of each lane from row j of that lane. One after the other: a filler may be
 * there more than once. */
INLINE void take_from(double *rows, const int j[LANES], vec column[4])
{
  transpose(column);
  for (int k = 0; k < LANES; k++) {
    double *row = rows + 4 * (size_t) j[k];
    store4(row, load4(row) - part(column[k % 4], k / 4));
  }
}

/* The sums over the lanes of sum[0..3]. */
INLINE row4 over_lanes(vec sum[4])
{
  transpose(sum);
  const vec total = (sum[0] + sum[1]) + (sum[2] + sum[3]);
#if LANES == 8
  return part(total, 0) + part(total, 1);
#else
  return total;
#endif
}

INLINE double sum_of(vec a)
{
  vec sum[4] = {a, all(0.0), all(0.0), all(0.0)};
  return over_lanes(sum)[0];
}

INLINE double least_of(vec a)
{
  double least = a[0];
  for (int k = 1; k < LANES; k++) least = a[k] < least ? a[k] : least;
  return least;
}

INLINE double largest_of(vec a)
{
  return -least_of(-a);
}

/* K and G of sd_sph_kernel.h for q <= 2. */
INLINE vec K(sd_sph_kernel kernel, vec q)
{
  if (kernel == SD_SPH_CUBICSPLINE) {
    const vec outer = 2.0 - q, inner = larger(1.0 - q, all(0.0));
    return outer * outer * outer - 4.0 * (inner * inner * inner);
  }
  const vec t = 1.0 - 0.5 * q, t2 = t * t;
  return t2 * t2 * (2.0 * q + 1.0);
}

INLINE vec G(sd_sph_kernel kernel, vec q)
{
  if (kernel == SD_SPH_CUBICSPLINE) {
    const vec outer = 2.0 - q;
    return where(q < 1.0, 9.0 * q - 12.0, -3.0 * (outer * outer) / q);
  }
  const vec t = 1.0 - 0.5 * q;
  return -5.0 * (t * t * t);
}

#endif
