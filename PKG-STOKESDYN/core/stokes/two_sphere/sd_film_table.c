#include "sd_film_table_internal.h"

const double sd_film_table[SD_FILM_KINDS][SD_FILM_RATIOS][SD_FILM_GAPS][SD_FILM_SCALARS] = {
#include "sd_film_table.inc"
};
