/* Between the sparse factor and its kernels, of which each instruction set has its own build. */
#ifndef SD_SPARSE_INTERNAL_H
#define SD_SPARSE_INTERNAL_H

#include "sd_isa.h"

/* A block by columns of floats. Width 3: each column has a fourth number, 0; width 6: the kernels
 * read the next two numbers with each column, which do no harm. */
static inline int sd_sparse_floats(int width)
{
  return width == 3 ? 12 : 36;
}

/* out += L (L^T in), one column of blocks after the other: t = L_k^T in needs all of it, then L_k t
 * is added while it is still in the cache. The numbers of a sphere stand every 4 (width 3) or 8
 * (width 6); those beyond its width are 0 in `in` and mean nothing in `out`. */
typedef void sd_sparse_product(int columns, const long *first, const int *row, const float *value,
                               const double *in, double *out);

struct sd_sparse_kernels {
  sd_sparse_product *three, *six;
};

SD_KERNEL_TABLES(struct sd_sparse_kernels, sd_sparse);

#endif
