/* The kernels of the engine ewald with the vectors of AVX-512. */
#include "sd_product_internal.h"

#ifdef SD_HAS_X86_KERNELS
#include "sd_vectors_avx512.h"

#define SD_KERNELS sd_ewald_avx512
#include "sd_ewald_kernel.h"
#endif
