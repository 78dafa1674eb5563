/* The kernels of the engine ewald with the vectors that every processor has. */
#include "sd_product_internal.h"

#if defined(SD_HAS_X86_KERNELS) || defined(SD_HAS_PORTABLE_KERNELS)
#include "sd_vectors_baseline.h"

#define SD_KERNELS sd_ewald_baseline
#include "sd_ewald_kernel.h"
#endif
