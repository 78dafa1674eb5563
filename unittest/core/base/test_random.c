/* Random numbers: the published bits, the moments of normal numbers, and that keys share nothing. */
#include "check.h"

#include "sd_random.h"

#include <string.h>

static void check_bits(const uint32_t counter[4], const uint32_t key[2], const uint32_t expected[4])
{
  uint32_t out[4];
  sd_random_bits(counter, key, out);
  assert_memory_equal(out, expected, sizeof(out));
}

/* Known answers of the authors' own test, Random123, kat_vectors: philox4x32 10 */
static void bits_are_the_published_ones(void **state)
{
  (void) state;
  const uint32_t zeros[4] = {0}, ones[4] = {~UINT32_C(0), ~UINT32_C(0), ~UINT32_C(0), ~UINT32_C(0)};
  const uint32_t pi[6] = {0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344, 0xa4093822, 0x299f31d0};
  check_bits(zeros, zeros, (uint32_t[4]){0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
  check_bits(ones, ones, (uint32_t[4]){0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
  check_bits(pi, pi + 4, (uint32_t[4]){0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
}

/* Of n numbers: moments 0, 1, 0, 3, with deviations sqrt(1, 2, 15, 96)/sqrt(n); 4 of these. Tags that
 * follow one another, and both numbers of a pair */
static void numbers_are_normal_and_independent(void **state)
{
  (void) state;
  enum { TAGS = 100000 };
  const sd_random_key key = {.seed = 12345, .purpose = SD_RANDOM_SPHERE, .step = UINT64_C(5000000000)};
  double sum[4] = {0.0}, along = 0.0, across = 0.0, last[3] = {0.0};
  for (uint64_t tag = 1; tag <= TAGS; tag++) {
    double z[3];
    sd_random_normals(&key, tag, 3, z);
    for (int d = 0; d < 3; d++)
      for (int p = 0; p < 4; p++) sum[p] += pow(z[d], p + 1);
    across += z[0] * z[1] + z[1] * z[2] + z[2] * z[0];
    for (int d = 0; d < 3; d++) along += z[d] * last[d];
    memcpy(last, z, sizeof(z));
  }
  const double n = 3.0 * TAGS, expected[4] = {0, 1, 0, 3}, square[4] = {1, 2, 15, 96};
  for (int p = 0; p < 4; p++) CHECK_NEAR(sum[p] / n, expected[p], 4.0 * sqrt(square[p] / n));
  CHECK_NEAR(across / n, 0.0, 4.0 / sqrt(n));
  CHECK_NEAR(along / n, 0.0, 4.0 / sqrt(n));
}

/* Each of tag, step, seed and purpose changes all numbers; a longer draw begins with the shorter one. */
static void every_part_of_the_key_counts(void **state)
{
  (void) state;
  const sd_random_key key = {7, SD_RANDOM_SPHERE, 11};
  sd_random_key other[3] = {key, key, key};
  other[0].seed++;
  other[1].step += UINT64_C(1) << 32;
  other[2].purpose = SD_RANDOM_GRID;
  double z[5], y[6];
  sd_random_normals(&key, 3, 5, z);
  sd_random_normals(&key, 3, 6, y);
  assert_memory_equal(z, y, sizeof(z));
  sd_random_normals(&key, 3 + (UINT64_C(1) << 32), 5, y);
  for (int d = 0; d < 5; d++) assert_true(y[d] != z[d]);
  for (int k = 0; k < 3; k++) {
    sd_random_normals(other + k, 3, 5, y);
    for (int d = 0; d < 5; d++) assert_true(y[d] != z[d]);
  }
}

static void pairs_have_tags_of_their_own(void **state)
{
  (void) state;
  const uint64_t tag = sd_random_pair(3, 5, 1);
  assert_true(tag == sd_random_pair(3, 5, 1));
  assert_true(tag != sd_random_pair(5, 3, 1) && tag != sd_random_pair(3, 5, 2));
  assert_true(tag != sd_random_pair(3, 5 + (UINT64_C(1) << 40), 1));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bits_are_the_published_ones),
      cmocka_unit_test(numbers_are_normal_and_independent),
      cmocka_unit_test(every_part_of_the_key_counts),
      cmocka_unit_test(pairs_have_tags_of_their_own),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
