/* The kernels of the engine ewald with the vectors of AVX2. */
#include "sd_product_internal.h"

#ifdef SD_HAS_X86_KERNELS
#include "sd_vectors_avx2.h"

#define SD_KERNELS sd_ewald_avx2
#include "sd_ewald_kernel.h"
#endif
