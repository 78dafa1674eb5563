#include "sd_random.h"

#include <math.h>

#include "sd_constants.h"

/* Both halves of a product of 32 by 32 bits */
static void random_multiply(uint32_t a, uint32_t b, uint32_t *high, uint32_t *low)
{
  const uint64_t product = (uint64_t) a * b;
  *high = (uint32_t) (product >> 32);
  *low = (uint32_t) product;
}

/* The key grows each round by the golden ratio and by sqrt(3) - 1, in units of 2^-32. */
void sd_random_bits(const uint32_t counter[4], const uint32_t key[2], uint32_t out[4])
{
  uint32_t c0 = counter[0], c1 = counter[1], c2 = counter[2], c3 = counter[3];
  uint32_t k0 = key[0], k1 = key[1];
  for (int round = 0; round < 10; round++) {
    uint32_t high0, low0, high2, low2;
    random_multiply(UINT32_C(0xD2511F53), c0, &high0, &low0);
    random_multiply(UINT32_C(0xCD9E8D57), c2, &high2, &low2);
    c0 = high2 ^ c1 ^ k0;
    c1 = low2;
    c2 = high0 ^ c3 ^ k1;
    c3 = low0;
    k0 += UINT32_C(0x9E3779B9);
    k1 += UINT32_C(0xBB67AE85);
  }
  out[0] = c0;
  out[1] = c1;
  out[2] = c2;
  out[3] = c3;
}

/* 0 < ... < 1 */
static double unit(uint32_t high, uint32_t low)
{
  const uint64_t bits = ((uint64_t) high << 32 | low) >> 11;
  return ((double) bits + 0.5) * 0x1p-53;
}

void sd_random_normals(const sd_random_key *key, uint64_t tag, int n, double *out)
{
  const uint32_t counter[4] = {(uint32_t) tag, (uint32_t) (tag >> 32), (uint32_t) key->step,
                               (uint32_t) (key->step >> 32)};
  for (int draw = 0; 2 * draw < n; draw++) {
    const uint32_t word[2] = {key->seed, (uint32_t) key->purpose << 24 | (uint32_t) draw};
    uint32_t bits[4];
    sd_random_bits(counter, word, bits);
    const double r = sqrt(-2.0 * log(unit(bits[0], bits[1])));
    const double angle = 2.0 * SD_PI * unit(bits[2], bits[3]);
    out[2 * draw] = r * cos(angle);
    if (2 * draw + 1 < n) out[2 * draw + 1] = r * sin(angle);
  }
}

uint64_t sd_random_pair(uint64_t first, uint64_t second, uint32_t which)
{
  const uint32_t counter[4] = {(uint32_t) first, (uint32_t) (first >> 32), (uint32_t) second,
                               (uint32_t) (second >> 32)};
  const uint32_t key[2] = {which, SD_RANDOM_FILM};
  uint32_t bits[4];
  sd_random_bits(counter, key, bits);
  return (uint64_t) bits[0] << 32 | bits[1];
}
