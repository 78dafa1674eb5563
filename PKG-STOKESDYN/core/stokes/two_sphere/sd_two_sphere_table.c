#include "sd_two_sphere_table_internal.h"

const double sd_two_sphere_table[SD_TWO_SPHERE_RATIOS][SD_TWO_SPHERE_GAPS]
                                [SD_TWO_SPHERE_FUNCTIONS] = {
#include "sd_two_sphere_table.inc"
};
