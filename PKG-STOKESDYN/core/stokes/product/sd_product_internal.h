/* Between sd_product.c and the kernels of each instruction set. */
#ifndef SD_PRODUCT_INTERNAL_H
#define SD_PRODUCT_INTERNAL_H

#include "sd_product.h"

struct sd_kernels {
  int lanes; /* doubles of a vector: padding of the columns */
  void (*symmetric)(const sd_packed *p, int part, int parts);       /* columns: u += */
  void (*targets)(const sd_packed *p, int i0, int i1);              /* columns: u += */
  void (*list)(const sd_packed *p, const sd_pairs *pairs);          /* rows: u = */
  void (*grand_symmetric)(const sd_packed *p, int part, int parts); /* the same with torques */
  void (*grand_targets)(const sd_packed *p, int i0, int i1);
  void (*grand_list)(const sd_packed *p, const sd_pairs *pairs);
  /* out += L L^T in (sd_precondition.h): vectors of 4 doubles a sphere, blocks of 3 x 4 floats */
  void (*sparse)(int columns, const long *first, const int *row, const float *value,
                 const double *in, double *out);
};

/* NULL: this build has none for it. isa is not SD_ISA_BEST. */
const struct sd_kernels *sd_kernels_of(sd_isa isa);

/* The kernels are written with the vector types of GCC and clang; the files of AVX2 and AVX-512 need the compiler's options for
 * them (CMakeLists.txt). SD_PORTABLE_KERNELS: on x86-64 too what other processors get; SD_NO_KERNELS: plain C, any compiler. */
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
