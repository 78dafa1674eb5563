/* What goes into the rows of the near part and what comes out of them (sd_ewald_pairs.h): loops over the
 * spheres, of the precision of its kernels. */
#ifndef SD_EWALD_ROWS_H
#define SD_EWALD_ROWS_H

#include "sd_ewald_near.h"

/* Coordinates of the row that stands for nothing: no force, and far from everything */
#define SD_NOWHERE 1e16

struct sd_ewald_rows {
  /* where the spheres of rows begin ... end - 1 stand, their radii, and w in the last number of a row; those
   * of nothing stand behind the last of all */
  void (*stand)(sd_ewald_pairs *p, long begin, long end);
  /* unit w F into the rows, and sums of w F over this rank; the rest as in sd_ewald_pairs.h */
  void (*load)(const sd_ewald_pairs *p, int n, const double *F, const double *ghosts, double *sums);
  void (*of_targets)(const sd_ewald_pairs *p, void *waves);
  /* of targets begin ... end - 1 */
  void (*take)(const sd_ewald_pairs *p, long begin, long end, const void *waves, const double *tail,
               const double *sums, double *u);
  /* what is near of the ghosts with radius, u [width] each */
  void (*of_ghosts)(const sd_ewald_pairs *p, int n, double *u);
};

extern const struct sd_ewald_rows sd_ewald_rows_doubles, sd_ewald_rows_floats;

#endif
