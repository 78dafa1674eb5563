/* Kernels of the engine ewald. */
#include "sd_ewald_internal.h"
#include "sd_tensor_lanes.h"

#include "sd_ewald_near_kernel.h"
#include "sd_ewald_own_kernel.h"
#include "sd_ewald_spread_kernel.h"
#include "sd_image_pair_kernel.h"
#include "sd_image_row_kernel.h"

/* k = 0: B is 0 there, and 1e-300 keeps 1/k^2 finite. */
static void periodic_row(double *const *f, const double *B, const double *k, double dkz, int half)
{
  double *restrict f0 = f[0], *restrict f1 = f[1], *restrict f2 = f[2];
  const double kx = k[0], ky = k[1], across = kx * kx + ky * ky + 1e-300;
  for (int e = 0; e < half; e++) {
    const double kz = k[2] + e * dkz, inverse = 1.0 / (across + kz * kz), b = B[e];
    for (int part = 2 * e; part < 2 * e + 2; part++) {
      const double dot = (kx * f0[part] + ky * f1[part] + kz * f2[part]) * inverse;
      f0[part] = b * (f0[part] - kx * dot);
      f1[part] = b * (f1[part] - ky * dot);
      f2[part] = b * (f2[part] - kz * dot);
    }
  }
}

static void open_row(double *const *f, const double *K, double sx, double sy, int half)
{
  double *restrict f0 = f[0], *restrict f1 = f[1], *restrict f2 = f[2];
  for (int e = 0; e < half; e++) {
    const double xx = K[e], yy = K[half + e], zz = K[2 * half + e];
    const double xy = sx * sy * K[3 * half + e], xz = sx * K[4 * half + e], yz = sy * K[5 * half + e];
    for (int part = 2 * e; part < 2 * e + 2; part++) {
      const double x = f0[part], y = f1[part], z = f2[part];
      f0[part] = xx * x + xy * y + xz * z;
      f1[part] = xy * x + yy * y + yz * z;
      f2[part] = xz * x + yz * y + zz * z;
    }
  }
}

const struct sd_ewald_kernels SD_KERNELS(sd_ewald) = {
    search, near_part, image_part, own_block, spread, interpolate, periodic_row, open_row,
    image_rows};
