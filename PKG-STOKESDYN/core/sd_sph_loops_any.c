/* For any processor the compiler can make code for. */
/* Vectors of four are never passed between functions, so their calling convention does not matter. */
#pragma GCC diagnostic ignored "-Wpsabi"
#define LOOPS sd_sph_loops_any
#include "sd_sph_loops.h"
