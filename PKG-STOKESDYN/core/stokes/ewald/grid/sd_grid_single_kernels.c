/* Kernels of the grid, of floats */
#define SD_SINGLE
#include "sd_grid_kernels.c"
