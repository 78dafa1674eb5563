/* The kernels of sd_block_cholesky.h with the vectors that every processor has. */
#include "sd_product_internal.h"

#if defined(SD_HAS_X86_KERNELS) || defined(SD_HAS_PORTABLE_KERNELS)
#define LANES 4
typedef float vec __attribute__((vector_size(16), aligned(4), may_alias));
#define SD_KERNELS sd_block_baseline
#include "sd_block_kernel.h"
#endif
