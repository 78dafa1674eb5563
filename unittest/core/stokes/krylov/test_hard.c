/* Hard cases for the solver: every one of them has to give the answer or say why not. And warm starts and Ritz
   values. */
#include "clouds.h"

#include "in_clumps.h"

#include <string.h>

static const double A = 0.7, ETA = 1.3, U = 0.9;
static const sd_law RPY = {.tensor = SD_TENSOR_RPY};

/* 10 000 clumps of 2 to 12 spheres that overlap, radii 1:100, some wholly hidden, to 1e-6; by the diagonal and by
   blocks. */
static void ten_thousand_random_clumps(void **state)
{
  (void) state;
  int most = 0, most_blocks = 0;
  for (int k = 0; k < 10000; k++) {
    uint64_t seed = (uint64_t) k + 1;
    const int n = 2 + (int) uniform(&seed, 0, 11);
    scene s = cloud_flocs(1, n, 100.0, 1.0, 0, ETA, seed);
    s.fast = 1;
    double *slip = scene_uniform_slip(&s, U, -0.3 * U, 0.5 * U);
    if (k % 2)
      for (int i = 0; i < 3 * n; i++) slip[i] = uniform(&seed, -U, U);
    sd_status status;
    sd_solve_report report;
    free(scene_solve(&s, sd_solve_gradients, slip, 1e-6, 2000, &status, &report));
    if (status != SD_OK) fail_msg("clump %d: %s", k, sd_status_string(status));
    if (report.iterations > most) most = report.iterations;

    in_clumps one;
    const sd_spheres spheres = {s.x, s.a, s.w};
    sd_blocks b = {0};
    assert_int_equal(sd_blocks_make(&b, clumps_of(&one, RPY, spheres, n, 3, n)), SD_OK);
    s.precondition = sd_blocks_apply;
    s.precondition_ctx = &b;
    free(scene_solve(&s, sd_solve_gradients, slip, 1e-6, 20, &status, &report));
    if (status != SD_OK) fail_msg("clump %d, block: %s", k, sd_status_string(status));
    if (report.iterations > most_blocks) most_blocks = report.iterations;
    sd_blocks_free(&b);
    free(slip);
    scene_free(&s);
  }
  assert_true(most < 200);
  assert_true(most_blocks <= 2);
}

/* Forces for uniform velocity of a large sphere at rest in the middle and two small ones beside it; the one moves along
   x. */
static void forces_at(double x, double F[9])
{
  scene s = scene_create(3);
  scene_set(&s, 0, 0, 0, 0, 1.9, ETA);
  scene_set(&s, 1, x, 0.1, 0, 0.7, ETA);
  scene_set(&s, 2, 0, 2.2, 0.4, 0.9, ETA);
  s.fast = 1;
  double *slip = scene_uniform_slip(&s, U, 0.4 * U, 0);
  sd_status status;
  sd_solve_report report;
  double *solution = scene_solve(&s, sd_solve_gradients, slip, 1e-13, 200, &status, &report);
  assert_true(status == SD_OK || (status == SD_ESTAGNATED && report.residual < 1e-12));
  memcpy(F, solution, 9 * sizeof(double));
  free(solution);
  free(slip);
  scene_free(&s);
}

/* Along a path through contact (R = 2.6), overlap and the inside (R < 1.2) no force jumps: differences stay below a
 * fixed slope times the step. Around the two places where the formula changes the steps are 1e-12 wide. */
static void forces_are_continuous_along_a_path(void **state)
{
  (void) state;
  const double slope = 6 * SD_PI * ETA * U * 4.0;
  double last[9], F[9], x = 4.0;
  forces_at(x, last);
  while (x > -0.5) {
    x -= 0.01;
    forces_at(x, F);
    for (int i = 0; i < 9; i++) CHECK_NEAR(F[i], last[i], 0.01 * slope);
    memcpy(last, F, sizeof(F));
  }
  const double borders[] = {2.6, 1.2};
  for (int k = 0; k < 2; k++) {
    const double middle = sqrt(borders[k] * borders[k] - 0.1 * 0.1);
    forces_at(middle + 3e-12, last);
    for (int step = 2; step >= -3; step--) {
      forces_at(middle + step * 1e-12, F);
      for (int i = 0; i < 9; i++) CHECK_NEAR(F[i], last[i], 1e-11 * slope);
      memcpy(last, F, sizeof(F));
    }
  }
}

/* All spheres at one point: together they have the drag of the largest. */
static void all_spheres_at_one_point(void **state)
{
  (void) state;
  enum { N = 50 };
  for (int equal = 0; equal < 2; equal++) {
    scene s = scene_create(N);
    uint64_t seed = 3;
    double largest = 0.0, total = 0.0;
    for (int i = 0; i < N; i++) {
      const double a = equal ? A : uniform(&seed, 0.1, 1.4);
      scene_set(&s, i, 1.0, -2.0, 0.5, a, ETA);
      largest = fmax(largest, a);
    }
    s.fast = 1;
    double *slip = scene_uniform_slip(&s, 0, U, 0);
    sd_status status;
    sd_solve_report report;
    double *F = scene_solve(&s, sd_solve_gradients, slip, 1e-9, 500, &status, &report);
    assert_int_equal(status, SD_OK);
    for (int i = 0; i < N; i++) total += F[3 * i + 1];
    CHECK_NEAR(total / (6 * SD_PI * ETA * largest * U), 1.0, 1e-8);
    free(F);
    free(slip);
    scene_free(&s);
  }
}

/* Ten equal spheres at each of four points in a cloud. M is singular, and so nearly are its preconditioners: they blow
 * up the rounding along directions that no velocity asks for. The answer must come all the same; different velocities
 * must not pass. */
static void coincident_spheres_with_preconditioners(void **state)
{
  (void) state;
  scene s = cloud_flocs(1, 40, 2.0, 1.0, 0, ETA, 9);
  for (int i = 0; i < 40; i++)
    scene_set(&s, i, s.x[3 * (i % 4)], s.x[3 * (i % 4) + 1], s.x[3 * (i % 4) + 2], s.a[i % 4], ETA);
  s.fast = 1;
  const sd_spheres spheres = {s.x, s.a, s.w};
  in_clumps one;
  sd_blocks b = {0};
  sd_sparse f = {0};
  const sd_precondition_case *c = clumps_of(&one, RPY, spheres, 40, 3, 40);
  assert_int_equal(sd_blocks_make(&b, c), SD_OK);
  assert_int_equal(sd_sparse_create(&f, c, 3.0), SD_OK);
  double *slip = scene_uniform_slip(&s, U, 0.4 * U, 0), total[3][12] = {{0.0}};
  for (int i = 0; i < 40; i++) slip[3 * i + 2] = 0.1 * U * (i % 4);
  for (int k = 0; k < 3; k++) {
    s.precondition = k == 0 ? NULL : k == 1 ? sd_blocks_apply : sd_sparse_apply;
    s.precondition_ctx = k == 1 ? (void *) &b : (void *) &f;
    sd_status status;
    sd_solve_report report;
    double *F = scene_solve(&s, sd_solve_gradients, slip, 1e-10, 200, &status, &report);
    assert_int_equal(status, SD_OK);
    for (int j = 0; j < 120; j++) total[k][3 * (j / 3 % 4) + j % 3] += F[j];
    free(F);
    for (int j = 0; j < 12; j++) CHECK_NEAR(total[k][j], total[0][j], 1e-8 * 6 * SD_PI * ETA * U);

    slip[0] += 1e-6 * U;
    free(scene_solve(&s, sd_solve_gradients, slip, 1e-12, 200, &status, &report));
    assert_int_equal(status, SD_ESINGULAR);
    slip[0] -= 1e-6 * U;
  }
  free(slip);
  sd_blocks_free(&b);
  sd_sparse_free(&f);
  scene_free(&s);
}

/* One sphere that takes part among 10^5 that do not. */
static void one_sphere_among_many(void **state)
{
  (void) state;
  enum { N = 100000 };
  scene s = scene_create(N);
  uint64_t seed = 4;
  for (int i = 0; i < N; i++)
    scene_set(&s, i, uniform(&seed, 0, 9), uniform(&seed, 0, 9), uniform(&seed, 0, 9), A, ETA);
  for (int i = 0; i < N; i++)
    if (i != 77777) s.a[i] = s.w[i] = s.drag[i] = 0.0;
  s.fast = 1;
  double *slip = scene_uniform_slip(&s, U, 0, 0);
  sd_status status;
  sd_solve_report report;
  double *F = scene_solve(&s, sd_solve_gradients, slip, 1e-12, 10, &status, &report);
  assert_int_equal(status, SD_OK);
  for (int i = 0; i < N; i++)
    CHECK_NEAR(F[3 * i], i == 77777 ? 6 * SD_PI * ETA * A * U : 0.0, 1e-13);
  free(F);
  free(slip);
  scene_free(&s);
}

/* A clump that comes apart, its set-up kept: the old blocks and the old factor still lead to the right answer. */
static void preconditioner_of_another_time(void **state)
{
  (void) state;
  scene s = cloud_flocs(1, 30, 2.0, 1.0, 0, ETA, 5);
  const sd_spheres spheres = {s.x, s.a, s.w};
  in_clumps one;
  sd_blocks b = {0};
  sd_sparse f = {0};
  const sd_precondition_case *c = clumps_of(&one, RPY, spheres, 30, 3, 30);
  assert_int_equal(sd_blocks_make(&b, c), SD_OK);
  assert_int_equal(sd_sparse_create(&f, c, 3.0), SD_OK);
  double *slip = scene_uniform_slip(&s, U, 0, 0);
  for (double swell = 1.0; swell < 60.0; swell *= 3.0) {
    double *F[3];
    for (int k = 0; k < 3; k++) {
      sd_status status;
      sd_solve_report report;
      s.precondition = k == 0 ? NULL : k == 1 ? sd_blocks_apply : sd_sparse_apply;
      s.precondition_ctx = k == 1 ? (void *) &b : (void *) &f;
      F[k] = scene_solve(&s, sd_solve_gradients, slip, 1e-11, 2000, &status, &report);
      assert_int_equal(status, SD_OK);
    }
    for (int k = 1; k < 3; k++)
      for (int i = 0; i < 90; i++) CHECK_NEAR(F[k][i], F[0][i], 1e-7 * 6 * SD_PI * ETA * U);
    for (int k = 0; k < 3; k++) free(F[k]);
    for (int i = 0; i < 90; i++) s.x[i] *= 3.0;
  }
  free(slip);
  sd_blocks_free(&b);
  sd_sparse_free(&f);
  scene_free(&s);
}

/* A guess within the tolerance costs one product and is not touched; a rough one saves iterations; a wild one does no
   harm. */
static void warm_starts(void **state)
{
  (void) state;
  scene s = scene_lattice(5, 5, 5, 2.0, A, ETA);
  double *slip = scene_uniform_slip(&s, U, 0, 0),
         *work = malloc(sizeof(double) * SD_SOLVE_WORK(125, 3));
  double F[375], kept[375];
  sd_solve_report report;
  sd_system system = {.n = 125, .drag = s.drag, .apply = scene_apply, .apply_ctx = &s};
  assert_int_equal(sd_solve_gradients(&system, slip, 1e-6, 100, F, work, &report), SD_OK);
  assert_int_equal(report.products, report.iterations + 1);
  const int cold = report.iterations;

  system.warm = 1;
  memcpy(kept, F, sizeof(F));
  s.products = 0;
  assert_int_equal(sd_solve_gradients(&system, slip, 1e-6, 100, F, work, &report), SD_OK);
  assert_int_equal(report.iterations, 0);
  assert_int_equal(s.products, 1);
  assert_memory_equal(F, kept, sizeof(F));
  assert_true(report.residual <= 1e-6);

  for (int i = 0; i < 375; i++) slip[i] *= 1.0 + 1e-4 * (i % 7);
  assert_int_equal(sd_solve_gradients(&system, slip, 1e-6, 100, F, work, &report), SD_OK);
  assert_true(report.iterations > 0 && report.iterations < cold);

  for (int i = 0; i < 375; i++) {
    F[i] = 1e6 * (i % 3);
    slip[i] = i % 3 == 0 ? U : 0.0;
  }
  assert_int_equal(sd_solve_gradients(&system, slip, 1e-6, 100, F, work, &report), SD_OK);
  assert_int_equal(report.iterations, cold);
  F[3] = NAN;
  assert_int_equal(sd_solve_gradients(&system, slip, 1e-6, 100, F, work, &report), SD_OK);
  assert_int_equal(report.iterations, cold);
  free(slip);
  free(work);
  scene_free(&s);
}

/* Extreme eigenvalues of the mobility scaled to unit diagonal, from a solve: dense eigenvalues of the touching chains
 * and cubes. Random velocities, which hold every eigenvector. */
static void ritz_values_are_the_extreme_eigenvalues(void **state)
{
  (void) state;
  const struct {
    int nx, nz;
    double smallest, largest;
  } cases[] = {{1, 2, 0.375, 1.625},    {1, 3, 0.277724, 2.081651}, {1, 10, 0.194876, 3.6866},
               {2, 2, 0.156034, 3.864}, {3, 3, 0.131451, 8.685},    {5, 5, 0.1140, 24.14}};
  for (size_t k = 0; k < sizeof(cases) / sizeof(cases[0]); k++) {
    scene s = scene_lattice(cases[k].nx, cases[k].nx, cases[k].nz, 2.0, A, ETA);
    uint64_t seed = 6;
    double *slip = scene_uniform_slip(&s, 0, 0, 0);
    for (int i = 0; i < 3 * s.n; i++) slip[i] = uniform(&seed, -1, 1);
    sd_status status;
    sd_solve_report report;
    free(scene_solve(&s, sd_solve_gradients, slip, 1e-12, 500, &status, &report));
    assert_int_equal(status, SD_OK);
    CHECK_NEAR(report.ritz_smallest / cases[k].smallest, 1.0, 1e-3);
    CHECK_NEAR(report.ritz_largest / cases[k].largest, 1.0, 1e-3);
    assert_true(report.curvature >= 0.999 * cases[k].smallest);
    free(slip);
    scene_free(&s);
  }
}

/* Two sums an iteration, and a few at the ends. */
static int sums;
static sd_status count_sums(void *ctx, double *values, int count)
{
  (void) ctx;
  (void) values;
  (void) count;
  sums++;
  return SD_OK;
}

static void two_reductions_an_iteration(void **state)
{
  (void) state;
  scene s = scene_lattice(6, 6, 6, 2.0, A, ETA);
  s.fast = 1;
  double *slip = scene_uniform_slip(&s, U, 0, 0), *F = malloc(sizeof(double) * 648),
         *work = malloc(sizeof(double) * SD_SOLVE_WORK(216, 3));
  sd_solve_report report;
  const sd_system system = {
      .n = 216, .drag = s.drag, .apply = scene_apply, .apply_ctx = &s, .world = {.sum = count_sums}};
  sums = 0;
  assert_int_equal(sd_solve_gradients(&system, slip, 1e-9, 200, F, work, &report), SD_OK);
  assert_true(report.iterations > 20);
  assert_int_equal(sums, 2 * report.iterations + 4);
  free(work);
  free(F);
  free(slip);
  scene_free(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(ten_thousand_random_clumps),
      cmocka_unit_test(forces_are_continuous_along_a_path),
      cmocka_unit_test(all_spheres_at_one_point),
      cmocka_unit_test(coincident_spheres_with_preconditioners),
      cmocka_unit_test(one_sphere_among_many),
      cmocka_unit_test(preconditioner_of_another_time),
      cmocka_unit_test(warm_starts),
      cmocka_unit_test(ritz_values_are_the_extreme_eigenvalues),
      cmocka_unit_test(two_reductions_an_iteration),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
