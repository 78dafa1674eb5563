/* The product with a full matrix. */
#include "sd_precondition_internal.h"

#include "sd_lanes.h"

/* Four columns at a time: what they are added to is read and written once for all four. */
static void blocks_multiply(long size, const double *A, const double *in, double *out)
{
  memset(out, 0, sizeof(double) * (size_t) size);
  for (long q = 0; q < size; q += 4) {
    const long last = size - 1 - q;    /* columns beyond it count as 0 */
    const double *a = A + size * q, *b = a + size * (last > 0), *c = b + size * (last > 1),
                 *d = c + size * (last > 2);
    const double u = in[q], v = last > 0 ? in[q + 1] : 0.0, w = last > 1 ? in[q + 2] : 0.0,
                 x = last > 2 ? in[q + 3] : 0.0;
    long p = 0;
    for (; p + LANES <= size; p += LANES)
      store_any(out + p,
                load_any(out + p) + (load_any(a + p) * u + load_any(b + p) * v) +
                    (load_any(c + p) * w + load_any(d + p) * x));
    for (; p < size; p++) out[p] += (a[p] * u + b[p] * v) + (c[p] * w + d[p] * x);
  }
}

const struct sd_blocks_kernels SD_KERNELS(sd_blocks) = {blocks_multiply};
