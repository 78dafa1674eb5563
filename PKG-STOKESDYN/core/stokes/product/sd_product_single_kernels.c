/* Kernels of the fast product, of floats */
#define SD_SINGLE
#include "sd_product_kernels.c"
