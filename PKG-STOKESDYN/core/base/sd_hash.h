/* Numbers that look random and depend on their key alone, so that no order and no rank matters. */
#ifndef SD_HASH_H
#define SD_HASH_H

#include <stdint.h>

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

/* Adds row number `tag` to the fingerprint of many rows: sums[0] += sum_k g v_k with g in -1 ... 1 of
 * (tag, k), sums[1] += sum_k |v_k|. Two sets of rows whose sums[0] differ by less than 1e-8 of
 * sums[1] are the same but for rounding, whatever the order in which they were added. */
static inline void sd_hash_add_row(uint64_t tag, const double *v, int n, double sums[2])
{
  for (int k = 0; k < n; k++) {
    if (v[k] == 0.0) continue;    /* adds nothing, and most rows are full of them */
    const uint64_t key = sd_hash_mix(tag * SD_HASH_STEP + (uint64_t) (k + 1));
    sums[0] += (2.0 * sd_hash_unit(key) - 1.0) * v[k];
    sums[1] += v[k] < 0.0 ? -v[k] : v[k];
  }
}

#endif
