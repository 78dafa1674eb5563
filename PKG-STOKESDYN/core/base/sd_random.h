/* Random numbers without a state: Philox4x32-10, a function of who asks, when and for what. The same
 * on any number of ranks, in any order and after a restart, which has nothing to keep.
 *
 *   counter = (tag, step), 64 bits each;  key = (seed, purpose and number of the draw), 32 bits each
 *
 * Two keys that differ in a single bit share nothing that tests of randomness have found.
 * Source: Salmon, Moraes, Dror & Shaw, SC11 (2011); Box & Muller 1958. */
#ifndef SD_RANDOM_H
#define SD_RANDOM_H

#include <stdint.h>

#include "sd_extern_c.h"

SD_BEGIN_C

/* What the numbers are for. tag: ID of the atom; lowest ID of the body; number of the row of two
 * points of a grid; sd_random_pair() of two spheres; ID of a grain */
typedef enum {
  SD_RANDOM_SPHERE = 1,
  SD_RANDOM_BODY,
  SD_RANDOM_GRID,
  SD_RANDOM_FILM,
  SD_RANDOM_EDDY,
  SD_RANDOM_DIFFERENCE
} sd_random_purpose;

typedef struct {
  uint32_t seed;
  sd_random_purpose purpose;
  uint64_t step;
} sd_random_key;

/* Ten rounds: 128 bits from a counter and a key */
void sd_random_bits(const uint32_t counter[4], const uint32_t key[2], uint32_t out[4]);

/* n independent standard normal numbers out [n] for this tag, n < 2^25; a shorter sequence is the
 * beginning of a longer one. Exact to the rounding of u = (bits + 1/2) 2^-53, so |out| < 8.7. */
void sd_random_normals(const sd_random_key *key, uint64_t tag, int n, double *out);

/* A tag for two that have tags, the lower first, and which of several pairs of them it is; of two
 * such pairs in 2^64 it is the same. */
uint64_t sd_random_pair(uint64_t first, uint64_t second, uint32_t which);

SD_END_C
#endif
