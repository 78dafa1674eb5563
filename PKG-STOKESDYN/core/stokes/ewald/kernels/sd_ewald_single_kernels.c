/* Kernels of the engine ewald, of floats */
#define SD_SINGLE
#include "sd_ewald_kernels.c"
