/* Instruction sets: which of them this processor has, and how kernels are compiled for each.
 *
 * A file NAME_kernels.c holds loops in the vectors of sd_lanes.h and ends with a table of them,
 *   const struct TYPE SD_KERNELS(NAME) = {...};
 * The build compiles it once for each set (add_kernels in CMakeLists.txt), with the options of the
 * compiler for it, SD_SET as its name and SD_LANES as the doubles of its vectors. Whoever calls
 * kernels declares the tables with SD_KERNEL_TABLES and takes one with SD_KERNELS_OF.
 *
 *   plain      1 double, for any compiler         avx2     4, with FMA
 *   baseline   2, what every processor has        avx512   8: F, DQ, VL */
#ifndef SD_ISA_H
#define SD_ISA_H

#include "sd_extern_c.h"

SD_BEGIN_C

/* BEST: the widest that build and processor have. From plain on each is faster than the one
 * before, on every processor that has both. */
typedef enum { SD_ISA_BEST, SD_ISA_PLAIN, SD_ISA_BASELINE, SD_ISA_AVX2, SD_ISA_AVX512 } sd_isa;

/* What SD_ISA_BEST stands for here; any other set as it is. */
sd_isa sd_isa_of(sd_isa isa);

/* Does this build hold kernels for it, and does the processor run them? SD_ISA_PLAIN: always. */
int sd_isa_supported(sd_isa isa);

/* Vectors are types of GCC and clang. SD_PORTABLE_KERNELS: on x86-64 too what other processors get;
 * SD_NO_KERNELS: as other compilers, plain alone. */
#if defined(__GNUC__) && !defined(SD_NO_KERNELS)
#define SD_HAS_VECTORS
#if defined(__x86_64__) && !defined(SD_PORTABLE_KERNELS)
#define SD_HAS_X86_KERNELS
#endif
#endif

/* What stands there will be wanted soon: it is brought into the cache, where that can be asked for. */
static inline void sd_fetch(const void *address)
{
#ifdef SD_HAS_VECTORS
  __builtin_prefetch(address);
#else
  (void) address;
#endif
}

/* The name of a table in its own file */
#define SD_KERNELS(name) SD_TABLE_NAME(name, SD_SET)
#define SD_TABLE_NAME(name, set) SD_TABLE_JOIN(name, set)
#define SD_TABLE_JOIN(name, set) name##_##set

#define SD_KERNEL_TABLES(type, name) \
  extern const type name##_plain, name##_baseline, name##_avx2, name##_avx512

/* The address of a table. least: the set that stands for plain where a file has no such kernels.
 * isa: supported, and not SD_ISA_BEST */
#if defined(SD_HAS_X86_KERNELS)
#define SD_KERNELS_OF(name, least, isa)      \
  ((isa) == SD_ISA_AVX512   ? &name##_avx512 \
   : (isa) == SD_ISA_AVX2   ? &name##_avx2   \
   : (isa) == SD_ISA_PLAIN  ? &name##_##least \
                            : &name##_baseline)
#elif defined(SD_HAS_VECTORS)
#define SD_KERNELS_OF(name, least, isa) \
  ((isa) == SD_ISA_PLAIN ? &name##_##least : &name##_baseline)
#else
#define SD_KERNELS_OF(name, least, isa) ((void) (isa), &name##_##least)
#endif

SD_END_C
#endif
