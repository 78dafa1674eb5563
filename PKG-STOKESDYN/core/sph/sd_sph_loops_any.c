/* For any processor the compiler can make code for. */
#define LANES 4
#define LOOPS sd_sph_loops_any
#include "sd_sph_loops.h"
