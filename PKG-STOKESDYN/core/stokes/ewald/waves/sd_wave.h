/* What the wave part multiplies the transformed forces with: of a periodic box, or of an open one.
 *
 *   periodic   u^ = H/(k^2 V w^2) (1 - kk/k^2) f^,   0 at k = 0 and where k has no partner (Nyquist)
 *   open       u^ = K f^, K the transform of the pair's wave part in open space (sd_radial.h) at the
 *              offsets of the grid, on a grid of twice the size (a convolution without neighbours)
 *
 * Above a wall the first direction is across it, the fields are also there times the height, and an
 * open box has the images of sd_image_kernel.h.
 *
 * w: transform of the window, once for spreading and once for interpolation; viscosity 1. */
#ifndef SD_WAVE_H
#define SD_WAVE_H

#include "sd_ewald.h"
#include "sd_status.h"

SD_BEGIN_C

struct sd_ewald_kernels;

/* Zero-initialise; sd_wave_free in the end. */
typedef struct {
  /* whose numbers are those of the tables and of what these are multiplied with */
  const struct sd_ewald_kernels *kernels;
  /* this rank has the waves y0 ... of y and z0 ... of z, of these `depth` */
  int periodic, size[3], y0, z0, depth;
  /* open: the smallest |wave number| along y of this rank's planes */
  int first_row;
  /* 2 pi times the reciprocal vectors, rows */
  double k[3][3];
  /* periodic: [y][size x][depth]; open: rows of one octant [rows][half x][6][depth] */
  void *table;
  /* periodic: [depth] */
  double *roots;
  /* wall: rows [rows][half x][SD_IMAGE_KERNELS][2][depth], and gamma [size x]; else NULL */
  double *images, *gamma;
} sd_wave;

/* size: points of the transform; y, z: first and end of the waves that this rank has. SD_OK or
 * SD_ENOMEMORY. */
sd_status sd_wave_create(sd_wave *w, const sd_ewald *e, const struct sd_ewald_kernels *kernels,
                         const int *size, const int *y, const int *z);

/* As sd_grid_multiply: ctx is an sd_wave. */
void sd_wave_multiply(void *ctx, int y, int depth, void *const *plane);

/* The same of a periodic box, of doubles alone, with the root of B over that of the number of points: applied
 * to the transform of independent standard normal numbers, and transformed back, it gives velocities on the
 * grid whose covariance is what sd_wave_multiply convolves with. */
void sd_wave_multiply_root(void *ctx, int y, int depth, void *const *plane);

void sd_wave_free(sd_wave *w);

SD_END_C
#endif
