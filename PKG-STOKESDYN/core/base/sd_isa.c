#include "sd_isa.h"

int sd_isa_supported(sd_isa isa)
{
  if (isa == SD_ISA_BEST || isa == SD_ISA_PLAIN) return 1;
#if defined(SD_HAS_X86_KERNELS)
  if (isa == SD_ISA_AVX512)
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl");
  if (isa == SD_ISA_AVX2) return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#endif
#if defined(SD_HAS_VECTORS)
  return isa == SD_ISA_BASELINE;
#else
  return 0;
#endif
}

sd_isa sd_isa_of(sd_isa isa)
{
  if (isa != SD_ISA_BEST) return isa;
  isa = SD_ISA_AVX512;
  while (!sd_isa_supported(isa)) isa--;
  return isa;
}
