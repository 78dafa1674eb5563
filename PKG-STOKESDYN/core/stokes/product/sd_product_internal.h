/* Between sd_product.c and the kernels of each instruction set. */
#ifndef SD_PRODUCT_INTERNAL_H
#define SD_PRODUCT_INTERNAL_H

#include "sd_product.h"

/* One kind of product. Sums are times 8 pi and without w of the target; lengths are scaled.
 *   symmetric   columns, u += the part's share of all pairs
 *   list        rows, u +=; NULL: of floats there is none */
struct sd_kernel {
  /* of a number of the columns, but for those of u, which are of doubles */
  size_t bytes;
  /* numbers of a vector: padding of the columns */
  int lanes;
  void (*symmetric)(const sd_packed *p, int part, int parts);
  void (*list)(const sd_packed *p, const sd_pairs *pairs);
};

struct sd_kernels {
  struct sd_kernel forces, torques;
};

/* sd_wall: what images add, a sphere's own among them */
SD_KERNEL_TABLES(struct sd_kernels, sd_product);
SD_KERNEL_TABLES(struct sd_kernels, sd_product_single);
SD_KERNEL_TABLES(struct sd_kernels, sd_wall);

#endif
