#include "check.h"

#include "sd_linear.h"
#include "sd_shell.h"
#include "sd_tensor.h"

static const int sizes[] = {12, 14, 18, 20, 24, 30, 32, 42, 50, 68, 98, 104, 162, 200};
enum { N_SIZES = sizeof(sizes) / sizeof(sizes[0]) };

/* 6x6 resistance of the shell about its centre, a = 1, eta = 1: all 3n unknowns, no use of symmetry */
static void resistance(const sd_shell *shell, double R[36])
{
  const int n = shell->n, N = 3 * n;
  double *A = malloc(sizeof(double) * (size_t) N * N), *B = malloc(sizeof(double) * 6 * N),
         *U = malloc(sizeof(double) * 6 * N);
  for (int i = 0; i < n; i++) {
    const double *p = shell->p + 3 * i;
    for (int j = 0; j < n; j++) {
      double r[3], M[9];
      for (int d = 0; d < 3; d++) r[d] = shell->radius * (p[d] - shell->p[3 * j + d]);
      sd_tensor_uf(SD_TENSOR_RPY, r, shell->point, shell->point, 1.0, M);
      for (int c = 0; c < 9; c++) A[(size_t) (3 * i + c / 3) * N + 3 * j + c % 3] = M[c];
    }
    for (int c = 0; c < 6; c++) {
      double e[3] = {0.0, 0.0, 0.0}, u[3] = {0.0, 0.0, 0.0};
      const double y[3] = {shell->radius * p[0], shell->radius * p[1], shell->radius * p[2]};
      (c < 3 ? u : e)[c % 3] = 1.0;
      if (c >= 3) sd_cross(e, y, u);
      for (int d = 0; d < 3; d++)
        B[(size_t) c * N + 3 * i + d] = U[(size_t) c * N + 3 * i + d] = u[d];
    }
  }
  assert_int_equal(sd_cholesky_solve(N, A, 6, B), SD_OK);
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 6; q++) {
      R[6 * p + q] = 0.0;
      for (int k = 0; k < N; k++) R[6 * p + q] += U[(size_t) p * N + k] * B[(size_t) q * N + k];
    }
  free(A);
  free(B);
  free(U);
}

/* 6 pi eta a and 8 pi eta a^3 in every direction, and no coupling. */
static void lone_sphere_has_both_its_drags(void **state)
{
  (void) state;
  for (int k = 0; k < N_SIZES; k++) {
    sd_shell shell;
    double R[36];
    assert_int_equal(sd_shell_create(sizes[k], &shell), SD_OK);
    resistance(&shell, R);
    for (int p = 0; p < 6; p++)
      for (int q = 0; q < 6; q++) {
        const double exact = p != q ? 0.0 : p < 3 ? 6.0 * SD_PI : 8.0 * SD_PI;
        CHECK_NEAR(R[6 * p + q] / (6.0 * SD_PI), exact / (6.0 * SD_PI), 1e-10);
      }
    sd_shell_free(&shell);
  }
}

/* No two points closer than 0.8 of the spacing of a triangular lattice with the same number of points; worst: 98 points
 * (0.804).
*/
static void points_are_nearly_even(void **state)
{
  (void) state;
  for (int n = 12; n <= 104; n++) {
    if (sd_shell_size(n) != n) continue;
    sd_shell shell;
    assert_int_equal(sd_shell_create(n, &shell), SD_OK);
    double least = 4.0;
    for (int i = 0; i < n; i++) {
      const double *p = shell.p + 3 * i;
      CHECK_NEAR(sd_dot(p, p), 1.0, 1e-14);
      for (int j = 0; j < i; j++) {
        const double *q = shell.p + 3 * j, r[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
        least = fmin(least, sqrt(sd_dot(r, r)));
      }
    }
    const double lattice = sqrt(8.0 * SD_PI / (sqrt(3.0) * n));
    if (least < 0.8 * lattice)
      fail_msg("%d points: %.3f of the lattice spacing", n, least / lattice);
    sd_shell_free(&shell);
  }
}

static void twelve_points_are_the_icosahedron(void **state)
{
  (void) state;
  sd_shell shell;
  assert_int_equal(sd_shell_create(12, &shell), SD_OK);
  for (int i = 0; i < 12; i++)
    for (int j = 0; j < i; j++) {
      const double c = fabs(sd_dot(shell.p + 3 * i, shell.p + 3 * j));
      CHECK_NEAR(fmin(fabs(c - sqrt(0.2)), fabs(c - 1.0)), 0.0, 1e-14);
    }
  sd_shell_free(&shell);
}

static void number_is_rounded_up_to_one_with_the_symmetry(void **state)
{
  (void) state;
  const int wanted[] = {1, 2, 12, 13, 15, 19, 21, 27, 42, 100, 162, 642},
            made[] = {1, 12, 12, 14, 18, 20, 24, 30, 42, 102, 162, 642};
  for (int k = 0; k < 12; k++) assert_int_equal(sd_shell_size(wanted[k]), made[k]);
  sd_shell shell;
  assert_int_equal(sd_shell_create(13, &shell), SD_OK);
  assert_int_equal(shell.n, 14);
  sd_shell_free(&shell);
  assert_int_equal(sd_shell_create(1, &shell), SD_OK);
  assert_true(shell.n == 1 && shell.radius == 0.0 && shell.point == 1.0);
  sd_shell_free(&shell);
}

static void shell_is_a_pure_function_of_its_number(void **state)
{
  (void) state;
  sd_shell a, b, c;
  assert_int_equal(sd_shell_create(60, &a), SD_OK);
  assert_int_equal(sd_shell_create(42, &c), SD_OK);
  assert_int_equal(sd_shell_create(60, &b), SD_OK);
  assert_true(a.radius == b.radius && a.point == b.point);
  assert_memory_equal(a.p, b.p, sizeof(double) * 180);
  sd_shell_free(&a);
  sd_shell_free(&b);
  sd_shell_free(&c);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lone_sphere_has_both_its_drags),
      cmocka_unit_test(points_are_nearly_even),
      cmocka_unit_test(twelve_points_are_the_icosahedron),
      cmocka_unit_test(number_is_rounded_up_to_one_with_the_symmetry),
      cmocka_unit_test(shell_is_a_pure_function_of_its_number),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
