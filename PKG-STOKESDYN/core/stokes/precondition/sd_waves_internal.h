/* Between the long waves and their kernels, of which each instruction set has its own build. */
#ifndef SD_WAVES_INTERNAL_H
#define SD_WAVES_INTERNAL_H

#include "sd_isa.h"
#include "sd_waves.h"

/* Of this rank's rows of Z: y [SD_WAVES_COLUMNS] = Z^T F; F -= Z y; and the rows of some spheres as
 * they are, [width count][SD_WAVES_COLUMNS] */
struct sd_waves_kernels {
  void (*multiply)(const sd_waves *p, const double *F, double *y);
  void (*subtract)(const sd_waves *p, const double *y, double *F);
  void (*rows)(const sd_waves *p, const int *sphere, int count, double *rows);
};

SD_KERNEL_TABLES(struct sd_waves_kernels, sd_waves);

#endif
