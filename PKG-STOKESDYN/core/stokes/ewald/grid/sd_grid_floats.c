/* The way of the numbers through a grid of floats */
#define SD_SINGLE
#include "sd_grid_fields.c"
