/* Every call of LAPACK has one thread, and the library is left as it was: seen from functions that
 * stand here in LAPACK's and OpenBLAS's place. */
#include "check.h"

#include "sd_linear.h"

static int threads, calls, most;

void openblas_set_num_threads(int n);
int openblas_get_num_threads(void);
void dpotrf_(const char *, const int *, double *, const int *, int *, size_t);
void spotrf_(const char *, const int *, float *, const int *, int *, size_t);
void dpotri_(const char *, const int *, double *, const int *, int *, size_t);
void dpotrs_(const char *, const int *, const int *, const double *, const int *, double *,
             const int *, int *, size_t);

void openblas_set_num_threads(int n)
{
  threads = n;
}
int openblas_get_num_threads(void)
{
  return threads;
}

static void called(int *info)
{
  calls++;
  if (threads > most) most = threads;
  *info = 0;
}

void dpotrf_(const char *uplo, const int *n, double *A, const int *lda, int *info, size_t length)
{
  (void) uplo, (void) n, (void) A, (void) lda, (void) length;
  called(info);
}
void spotrf_(const char *uplo, const int *n, float *A, const int *lda, int *info, size_t length)
{
  (void) uplo, (void) n, (void) A, (void) lda, (void) length;
  called(info);
}
void dpotri_(const char *uplo, const int *n, double *A, const int *lda, int *info, size_t length)
{
  (void) uplo, (void) n, (void) A, (void) lda, (void) length;
  called(info);
}
void dpotrs_(const char *uplo, const int *n, const int *count, const double *A, const int *lda,
             double *B, const int *ldb, int *info, size_t length)
{
  (void) uplo, (void) n, (void) count, (void) A, (void) lda, (void) B, (void) ldb, (void) length;
  called(info);
}

static void each_call_has_one_thread(void **state)
{
  (void) state;
  double A[4] = {2, 0, 0, 2}, B[2] = {1, 1};
  float single[4] = {2, 0, 0, 2};
  for (int cores = 1; cores <= 4; cores += 3) {
    threads = cores;
    calls = most = 0;
    assert_int_equal(sd_cholesky(2, A), SD_OK);
    assert_int_equal(threads, cores);
    assert_int_equal(sd_cholesky_single(2, single), SD_OK);
    assert_int_equal(threads, cores);
    assert_int_equal(sd_cholesky_inverse(2, A), SD_OK);
    assert_int_equal(threads, cores);
    assert_int_equal(sd_cholesky_solve(2, A, 1, B), SD_OK);
    assert_int_equal(threads, cores);
    assert_int_equal(calls, 5);
    assert_int_equal(most, 1);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(each_call_has_one_thread),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
