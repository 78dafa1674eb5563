/* Dense linear algebra on LAPACK. */
#include "check.h"

#include "sd_linear.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Positive definite, full: 1/(1 + |p - q|) and 3 on the diagonal */
static double element(long p, long q)
{
  return p == q ? 3.0 : 1.0 / (1.0 + labs(p - q));
}

static double *matrix(int n)
{
  double *A = malloc(sizeof(double) * (size_t) n * (size_t) n);
  for (long p = 0; p < n; p++)
    for (long q = 0; q < n; q++) A[p + n * q] = element(p, q);
  return A;
}

static void factor_gives_the_matrix_back(void **state)
{
  (void) state;
  const int n = 17;
  double *A = matrix(n);
  float single[17 * 17];
  for (int p = 0; p < n * n; p++) single[p] = (float) A[p];
  assert_int_equal(sd_cholesky(n, A), SD_OK);
  assert_int_equal(sd_cholesky_single(n, single), SD_OK);
  for (int p = 0; p < n; p++)
    for (int q = 0; q <= p; q++) {
      double in_double = 0.0, in_single = 0.0;
      for (int k = 0; k <= q; k++) {
        in_double += A[p + n * k] * A[q + n * k];
        in_single += single[p + n * k] * single[q + n * k];
      }
      CHECK_NEAR(in_double, element(p, q), 1e-14);
      CHECK_NEAR(in_single, element(p, q), 1e-6);
    }
  free(A);
}

static void inverse_is_full_and_symmetric(void **state)
{
  (void) state;
  const int n = 17;
  double *A = matrix(n);
  assert_int_equal(sd_cholesky(n, A), SD_OK);
  assert_int_equal(sd_cholesky_inverse(n, A), SD_OK);
  for (int p = 0; p < n; p++)
    for (int q = 0; q < n; q++) {
      double sum = 0.0;
      for (int k = 0; k < n; k++) sum += A[p + n * k] * element(k, q);
      CHECK_NEAR(sum, p == q ? 1.0 : 0.0, 1e-13);
      assert_true(A[p + n * q] == A[q + n * p]);
    }
  free(A);
}

/* Of a matrix with an eigenvalue 0 too: twice it is the matrix. */
static void root_times_itself_is_the_matrix(void **state)
{
  (void) state;
  const int n = 17;
  for (int singular = 0; singular < 2; singular++) {
    double *A = matrix(n), *root = matrix(n);
    for (int k = 0; k < n && singular; k++) A[k] = A[n * k] = root[k] = root[n * k] = 0.0;
    assert_int_equal(sd_symmetric_root(n, root), SD_OK);
    for (int p = 0; p < n; p++)
      for (int q = 0; q < n; q++) {
        double sum = 0.0;
        for (int k = 0; k < n; k++) sum += root[p + n * k] * root[k + n * q];
        CHECK_NEAR(sum, A[p + n * q], 1e-13);
        assert_true(root[p + n * q] == root[q + n * p]);
      }
    root[3] = NAN;
    assert_int_equal(sd_symmetric_root(n, root), SD_ENOTFINITE);
    free(A), free(root);
  }
}

static void bad_matrices_are_told_apart(void **state)
{
  (void) state;
  for (int at = 0; at < 3; at++) {
    double nan[9] = {2, 0, 0, 0, 2, 0, 0, 0, 2}, hollow[9] = {2, 0, 0, 0, 2, 0, 0, 0, 2};
    float single[9] = {2, 0, 0, 0, 2, 0, 0, 0, 2};
    nan[4 * at] = NAN;
    hollow[4 * at] = -1.0;
    single[4 * at] = NAN;
    assert_int_equal(sd_cholesky(3, nan), SD_ENOTFINITE);
    assert_int_equal(sd_cholesky_single(3, single), SD_ENOTFINITE);
    assert_int_equal(sd_cholesky(3, hollow), SD_ESINGULAR);
  }
}

#if defined(__linux__)
/* CPU time of this process less that of this thread, in clock ticks: fields 14 and 15 of stat, which
 * follow the name in brackets. */
static long ticks_of_other_threads(void)
{
  long ticks = 0;
  DIR *tasks = opendir("/proc/self/task");
  assert_non_null(tasks);
  for (struct dirent *task; (task = readdir(tasks));) {
    char name[300], line[1000];
    if (task->d_name[0] == '.' || atol(task->d_name) == (long) getpid()) continue;
    snprintf(name, sizeof(name), "/proc/self/task/%s/stat", task->d_name);
    FILE *file = fopen(name, "r");
    if (!file) continue;
    unsigned long user = 0, system = 0;
    if (fgets(line, sizeof(line), file))
      sscanf(strrchr(line, ')') + 1, " %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu", &user,
             &system);
    ticks += (long) (user + system);
    fclose(file);
  }
  closedir(tasks);
  return ticks;
}

/* A library with threads spins them a moment when it is loaded and after every call that they share;
 * so the second of two equal calls would cost them as much as this thread. */
static void other_threads_rest(void **state)
{
  (void) state;
  const int n = 1800;
  long ticks[3];
  for (int call = 0; call < 3; call++) {
    double *A = matrix(n);
    assert_int_equal(sd_cholesky(n, A), SD_OK);
    assert_int_equal(sd_cholesky_inverse(n, A), SD_OK);
    ticks[call] = ticks_of_other_threads();
    free(A);
  }
  assert_true(ticks[2] - ticks[1] <= 2);
}
#endif

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(factor_gives_the_matrix_back),
      cmocka_unit_test(inverse_is_full_and_symmetric),
      cmocka_unit_test(root_times_itself_is_the_matrix),
      cmocka_unit_test(bad_matrices_are_told_apart),
#if defined(__linux__)
      cmocka_unit_test(other_threads_rest),
#endif
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
