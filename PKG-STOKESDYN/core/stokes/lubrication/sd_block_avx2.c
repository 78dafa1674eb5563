/* The kernels of sd_block_cholesky.h with the vectors of AVX2. */
#include "sd_product_internal.h"

#ifdef SD_HAS_X86_KERNELS
#define LANES 8
typedef float vec __attribute__((vector_size(32), aligned(4), may_alias));
#define SD_KERNELS sd_block_avx2
#include "sd_block_kernel.h"
#endif
