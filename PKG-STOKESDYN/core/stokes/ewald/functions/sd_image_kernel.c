#include "sd_image_kernel.h"

#include "sd_constants.h"
#include "sd_grid.h"
#include "sd_padded.h"
#include "sd_radial.h"
#include "sd_window.h"

/* I, J of G = I 1 + J R R; (1/R d/dR)^n L, n = 1, 2 */
static void image_numbers(const sd_ewald *e, double distance, double *number)
{
  const sd_filter filter = {e->images.xi, e->a_ref};
  const sd_filtered f = sd_filtered_at(&filter, distance * distance, 3, 0);
  sd_filtered_stokeslet(&f, 0, number, number + 1);
  number[2] = f.L[0][1];
  number[3] = f.L[0][2];
}

/* R[0] is along the axis of the grid, which is that of the wall times its sign. */
static double value(const sd_ewald *e, int kernel, const double *number, const double *R)
{
  const double unit = 1.0 / (8.0 * SD_PI), sign = e->images.wall.sign * unit;
  const double I = unit * number[0], J = unit * number[1], L1 = number[2], L2 = unit * number[3];
  switch (kernel) {
    case SD_IMAGE_G11: return I + J * R[1] * R[1];
    case SD_IMAGE_G22: return I + J * R[2] * R[2];
    case SD_IMAGE_G12: return -J * R[1] * R[2];
    case SD_IMAGE_GZZ: return I + J * R[0] * R[0];
    case SD_IMAGE_L11: return unit * L1 + L2 * R[1] * R[1];
    case SD_IMAGE_L22: return unit * L1 + L2 * R[2] * R[2];
    case SD_IMAGE_L12: return -L2 * R[1] * R[2];
    case SD_IMAGE_LZZ: return unit * L1 + L2 * R[0] * R[0];
    case SD_IMAGE_L1Z: return L2 * R[0] * R[1];
    case SD_IMAGE_L2Z: return L2 * R[0] * R[2];
    case SD_IMAGE_L1: return sign * L1 * R[1];
    default: return sign * L1 * R[2];
  }
}

sd_status sd_image_kernel(const sd_ewald *e, const int *size, const int *y, const int *z,
                          double *table)
{
  static const int odd[SD_IMAGE_KERNELS][3] = {
      [SD_IMAGE_G12] = {0, 1, 1}, [SD_IMAGE_L12] = {0, 1, 1}, [SD_IMAGE_L1Z] = {0, 1, 0},
      [SD_IMAGE_L2Z] = {0, 0, 1}, [SD_IMAGE_L1] = {0, 1, 0},  [SD_IMAGE_L2] = {0, 0, 1}};
  const sd_padded images = {
      .ewald = e,
      .last = sd_padded_last_of(e->images.xi),
      .kernels = SD_IMAGE_KERNELS,
      .numbers = image_numbers,
      .value = value,
      .odd = odd,
      .across = 1,
      .start = 2.0 * (e->box.origin[0] - e->images.wall.at) - e->points * e->spacing};
  return sd_padded_table(&images, size, y, z, table);
}

void sd_image_slopes(const sd_ewald *e, int size, double *gamma)
{
  for (int m = 0; m < size; m++) {
    const int wave = sd_grid_wave(m, size);
    const double theta = 2.0 * SD_PI * wave / size;
    gamma[m] = e->spacing * sd_window_slope(e->points, e->beta, theta) +
        e->a_ref * e->a_ref / 3.0 * theta / e->spacing;
    if (2 * m == size) gamma[m] = 0.0; /* no partner */
  }
}
