/* Rows of the near part of floats */
#define SD_SINGLE
#include "sd_ewald_rows.c"
