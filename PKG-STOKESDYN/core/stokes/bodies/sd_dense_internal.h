/* Products with the blocks of bodies in vectors (sd_isa.h). */
#ifndef SD_DENSE_INTERNAL_H
#define SD_DENSE_INTERNAL_H

#include "sd_isa.h"

struct sd_dense_kernels {
  /* out [n] = A y of a symmetric A [n n]; each sum in the order of y, no aliasing */
  void (*times)(long n, const double *A, const double *y, double *out);
};

SD_KERNEL_TABLES(struct sd_dense_kernels, sd_dense);

#endif
