/* What a slab adds to a wave along it: columns of the grid across it, one for each lateral wave,
 * between the transform along the slab and the one across it. A periodic box has copies of the
 * spheres above and below; they are taken away and the walls put in, by four moments of each
 * column and four functions:
 *
 *   t1 = e^-kz/W, t2 = (k z + c) t1, t3 = e^-k(top - z)/W, t4 = (k (top - z) + c) t3
 *   m_n = sum over planes of t_n f             for f_l, f_z~; of f_t for n = 1, 3
 *   u = sum of t_n times combinations of m_n   (sd_slab_wave.h has W, c = shift)
 *
 * exact but for the windows' aliasing; and at each wall a small matrix of planes, since the near
 * part takes images filtered (SD_CORNERS). Waves k = 0 have that corner alone; what walls do to
 * the mean is summed over the spheres (sd_mobility_slab.c). */
#ifndef SD_COLUMNS_H
#define SD_COLUMNS_H

#include "sd_columns_internal.h"
#include "sd_grid.h"
#include "sd_slab.h"
#include "sd_status.h"

SD_BEGIN_C

/* Zero-initialise; sd_columns_free in the end. */
typedef struct {
  const struct sd_columns_kernels *kernels;
  sd_slab slab;
  /* this rank's waves: first along the grid's second direction; of the third first, many, and in
   * groups */
  int y0, z0, depth, groups;
  /* has this rank k = 0? */
  int mean;
  /* planes that a corner reaches, its sums of planes */
  int corner_planes, corner_sums;
  /* by y and group: [SD_COLUMN_NUMBERS][SD_COLUMN_WAVES];
   * [corner_sums][SD_CORNERS][SD_COLUMN_WAVES] */
  double *numbers, *corner;
  /* k = 0: by sum of planes, along, across, and times z z' */
  double *corner_mean[3];
  /* [3 planes] forces at k = 0; work of the kernels */
  double *forces, *work;
} sd_columns;

/* y, z [2]: first and end of the waves that this rank has, of the grid's second and third
 * direction, whose first is across the slab. SD_OK or SD_ENOMEMORY. */
sd_status sd_columns_create(sd_columns *c, const sd_slab *slab,
                            const struct sd_columns_kernels *kernels, const int *y, const int *z);

/* As sd_grid_sweep: ctx is an sd_columns. */
void sd_columns_apply(void *ctx, int y, double *const *fields);

void sd_columns_free(sd_columns *c);

SD_END_C
#endif
