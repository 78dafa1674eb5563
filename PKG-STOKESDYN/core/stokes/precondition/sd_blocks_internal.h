/* Between the blocks of clumps and their kernel, of which each instruction set has its own build. */
#ifndef SD_BLOCKS_INTERNAL_H
#define SD_BLOCKS_INTERNAL_H

#include "sd_isa.h"

struct sd_blocks_kernels {
  /* out [size] = A in; A [size size] by columns */
  void (*multiply)(long size, const double *A, const double *in, double *out);
};

SD_KERNEL_TABLES(struct sd_blocks_kernels, sd_blocks);

#endif
