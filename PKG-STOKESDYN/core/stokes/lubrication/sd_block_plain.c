/* The kernels of sd_block_cholesky.h in plain C: vectors of one number, for any compiler. */
#ifndef __GNUC__
#define __attribute__(x)
#endif
#define LANES 1
typedef float vec;
#define SD_KERNELS sd_block_plain
#include "sd_block_kernel.h"
