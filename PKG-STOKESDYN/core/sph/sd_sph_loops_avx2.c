/* For x86-64 with AVX2 and FMA; sd_sph_dispatch.c asks the processor. Compiled to nothing
 * elsewhere. */
#if defined(__x86_64__) && defined(__GNUC__)
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma"))), apply_to = function)
#else
#pragma GCC target("avx2,fma")
#endif
#define LANES 4
#define AVX2
#define LOOPS sd_sph_loops_avx2
#include "sd_sph_loops.h"
#if defined(__clang__)
#pragma clang attribute pop
#endif
#else
typedef int sd_sph_loops_avx2_is_empty;
#endif
