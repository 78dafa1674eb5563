/* Numbers that look random and depend on their key alone, so that no order and no rank matters. */
#ifndef SD_HASH_H
#define SD_HASH_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* 2^64 over the golden ratio: its multiples spread keys that follow one another evenly. */
#define SD_HASH_STEP UINT64_C(0x9e3779b97f4a7c15)

/* Finaliser of splitmix64 (Stafford's variant 13 of that of MurmurHash3): every bit of x reaches
 * every bit of the result, one to one; 0 stays 0. */
static inline uint64_t sd_hash_mix(uint64_t x)
{
  x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
  return x ^ (x >> 31);
}

/* 0 <= ... < 1, from its 53 highest bits */
static inline double sd_hash_unit(uint64_t x)
{
  return (double) (x >> 11) * 0x1p-53;
}

#ifdef __cplusplus
}
#endif
#endif
