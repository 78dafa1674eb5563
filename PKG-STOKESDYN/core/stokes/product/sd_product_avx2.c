/* The product with the vectors of AVX2. */
#include "sd_product_internal.h"

#ifdef SD_HAS_X86_KERNELS
#include "sd_vectors_avx2.h"

#define SD_KERNELS sd_kernels_avx2
#include "sd_product_kernel.h"
#endif
