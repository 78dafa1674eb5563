/* Between sd_product.c and the kernels of each instruction set. */
#ifndef SD_PRODUCT_INTERNAL_H
#define SD_PRODUCT_INTERNAL_H

#include "sd_product.h"

/* One kind of product. Sums are times 8 pi and without w of the target; lengths are scaled.
 *   symmetric   columns, u += the part's share of all pairs
 *   list        rows, u = */
struct sd_kernel {
  /* doubles of a vector: padding of the columns */
  int lanes;
  void (*symmetric)(const sd_packed *p, int part, int parts);
  void (*list)(const sd_packed *p, const sd_pairs *pairs);
};

struct sd_kernels {
  struct sd_kernel forces, torques;
  /* out += L L^T in (sd_sparse.h): vectors of 4 doubles a sphere, blocks of 3 x 4 floats. NULL:
   * plain C has none */
  void (*sparse)(int columns, const long *first, const int *row, const float *value,
                 const double *in, double *out);
};

/* NULL: this build has none for it. isa is not SD_ISA_BEST. */
const struct sd_kernels *sd_kernels_of(sd_isa isa);
extern const struct sd_kernels sd_kernels_plain;

/* The kernels are written with the vector types of GCC and clang; the files of AVX2 and AVX-512
 * need the compiler's options for them (CMakeLists.txt). SD_PORTABLE_KERNELS: on x86-64 too what
 * other processors get; SD_NO_KERNELS: plain C, any compiler. */
#if defined(__GNUC__) && !defined(SD_NO_KERNELS)
#if defined(__x86_64__) && !defined(SD_PORTABLE_KERNELS)
#define SD_HAS_X86_KERNELS
extern const struct sd_kernels sd_kernels_baseline, sd_kernels_avx2, sd_kernels_avx512;
#else
#define SD_HAS_PORTABLE_KERNELS
extern const struct sd_kernels sd_kernels_baseline;
#endif
#endif

#endif
