/* The smooth part of images in a plane wall (sd_image_wave.h), as what the transform of a padded grid
 * is multiplied with.
 *
 * The first direction of the grid is across the wall. Forces f of the grid, and the same times the
 * height of each point, f' = z f, have in (1) of sd_image_wave.h a kernel of R alone; of velocities
 * u + z u' likewise:
 *
 *   u_t = -G_tt f_t - L_t f'_z        u'_t = 2 (L_tt f'_t - L_tz f'_z) + L_t f_z
 *   u_z = -G_zz f_z - L_t.f'_t        u'_z = 2 (L_tz.f'_t - L_zz f'_z) + L_t.f_t
 *
 * What a sphere's operators and its torque do to the heights, they do to z f by themselves. R is the
 * difference of two points along the wall and the sum of their heights across it: there the
 * transform is of the reversed field. */
#ifndef SD_IMAGE_KERNEL_H
#define SD_IMAGE_KERNEL_H

#include "sd_ewald.h"
#include "sd_status.h"

SD_BEGIN_C

/* Directions 1 and 2 of the grid are along the wall. Without a factor -i for each of them in which
 * a kernel is odd */
enum {
  SD_IMAGE_G11,
  SD_IMAGE_G22,
  SD_IMAGE_G12,
  SD_IMAGE_GZZ,
  SD_IMAGE_L11,
  SD_IMAGE_L22,
  SD_IMAGE_L12,
  SD_IMAGE_LZZ,
  SD_IMAGE_L1Z,
  SD_IMAGE_L2Z,
  SD_IMAGE_L1,
  SD_IMAGE_L2,
  SD_IMAGE_KERNELS
};

/* In the frame of the grid; size, y, z, table and status as of sd_padded_table, across. */
sd_status sd_image_kernel(const sd_ewald *e, const int *size, const int *y, const int *z,
                          double *table);

/* gamma [size]: with it z f of the windows is freed of what they do to it,
 *   z f - i gamma f,   u + i gamma u',     gamma = d ln w^/dk + a_ref^2 k/3                     */
void sd_image_slopes(const sd_ewald *e, int size, double *gamma);

SD_END_C
#endif
