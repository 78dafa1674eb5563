/* Kernels of the engine ewald, of doubles; sd_ewald_single_kernels.c: the same of floats */
#include "sd_ewald_kernels.h"
#include "sd_rows.h"
#include "sd_steps.h"
#include "sd_tensor_lanes.h"

#include "sd_ewald_near_kernel.h"
#include "sd_ewald_near_groups_kernel.h"
#include "sd_ewald_stand_kernel.h"
#include "sd_ewald_spread_kernel.h"
#include "sd_ewald_runs_kernel.h"
#ifndef SD_SINGLE
#include "sd_ewald_own_kernel.h"
#include "sd_image_pair_kernel.h"
#include "sd_image_row_kernel.h"
#endif

/* k = 0: B is 0 there, and 1/k^2 stays finite. */
static void periodic_row(void *const *f, const void *table, const double *k, double dkz, int half)
{
  real *restrict f0 = f[0], *restrict f1 = f[1], *restrict f2 = f[2];
  const real *B = table;
  const real kx = (real) k[0], ky = (real) k[1], z0 = (real) k[2], step = (real) dkz;
  const real across = kx * kx + ky * ky + (sizeof(real) == sizeof(float) ? (real) 1e-37 : (real) 1e-300);
  for (int e = 0; e < half; e++) {
    const real kz = z0 + (real) e * step, inverse = 1 / (across + kz * kz), b = B[e];
    for (int part = 2 * e; part < 2 * e + 2; part++) {
      const real dot = (kx * f0[part] + ky * f1[part] + kz * f2[part]) * inverse;
      f0[part] = b * (f0[part] - kx * dot);
      f1[part] = b * (f1[part] - ky * dot);
      f2[part] = b * (f2[part] - kz * dot);
    }
  }
}

static void open_row(void *const *f, const void *table, double sign_x, double sign_y, int half)
{
  real *restrict f0 = f[0], *restrict f1 = f[1], *restrict f2 = f[2];
  const real *K = table, sx = (real) sign_x, sy = (real) sign_y;
  for (int e = 0; e < half; e++) {
    const real xx = K[e], yy = K[half + e], zz = K[2 * half + e];
    const real xy = sx * sy * K[3 * half + e], xz = sx * K[4 * half + e], yz = sy * K[5 * half + e];
    for (int part = 2 * e; part < 2 * e + 2; part++) {
      const real x = f0[part], y = f1[part], z = f2[part];
      f0[part] = xx * x + xy * y + xz * z;
      f1[part] = xy * x + yy * y + yz * z;
      f2[part] = xz * x + yz * y + zz * z;
    }
  }
}

#ifdef SD_SINGLE
const struct sd_ewald_kernels SD_KERNELS(sd_ewald_single) = {
    sizeof(real), near_part, BUNCH, BUNCH_UNLIKE, NEAR_GROUPS, GROUPS_NEAR, stand_on_grid, SPREAD, INTERPOLATE,
    periodic_row, open_row, NULL, NULL, NULL, NULL};
#else
const struct sd_ewald_kernels SD_KERNELS(sd_ewald) = {
    sizeof(real), near_part, BUNCH, BUNCH_UNLIKE, NEAR_GROUPS, GROUPS_NEAR, stand_on_grid, SPREAD, INTERPOLATE,
    periodic_row, open_row, search, own_block, image_part, image_rows};
#endif
