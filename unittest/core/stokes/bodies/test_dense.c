/* Products with blocks of bodies: the same sums by every set of instructions, for all sizes. */
#include "check.h"

#include <stdlib.h>

#include "sd_dense_internal.h"

enum { MOST = 300 };

static const sd_isa sets[] = {SD_ISA_PLAIN, SD_ISA_BASELINE, SD_ISA_AVX2, SD_ISA_AVX512};

/* Matrix and vector have no room to spare, so that a sanitizer sees who reads beyond them. */
static void product_is_sum_of_columns(void **state)
{
  (void) state;
  static const int size[] = {0, 1, 3, 6, 8, 9, 35, 36, 40, 41, 126, MOST};
  uint64_t seed = 5;
  for (int n = 0; n < (int) (sizeof(size) / sizeof(size[0])); n++)
    for (int k = 0; k < 4; k++) {
      const long N = size[n];
      if (!sd_isa_supported(sets[k])) continue;
      double *A = malloc(sizeof(double) * (size_t) (N * N)), *y = malloc(sizeof(double) * (size_t) N),
             *out = malloc(sizeof(double) * (size_t) (N + 1));
      for (long i = 0; i < N; i++) {
        y[i] = uniform(&seed, -1, 1);
        for (long j = 0; j <= i; j++) A[N * i + j] = A[N * j + i] = uniform(&seed, -1, 1);
      }
      for (long i = 0; i <= N; i++) out[i] = 7.0; /* is written over, but the one behind the last */
      SD_KERNELS_OF(sd_dense, plain, sets[k])->times(N, A, y, out);
      for (long i = 0; i < N; i++) {
        double sum = 0.0;
        for (long j = 0; j < N; j++) sum += A[N * i + j] * y[j];
        CHECK_NEAR(out[i], sum, 1e-13 * (double) N);
      }
      assert_true(out[N] == 7.0);
      free(A);
      free(y);
      free(out);
    }
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(product_is_sum_of_columns)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
