/* Forces from velocities in two ways: bodies that all rest in the slip, and the solver of points. */
#include "resting.h"

#include "clouds.h"

/* Overlapping spheres of unlike radii, with slips of which no two are alike */
static scene cloud(double **slip)
{
  uint64_t seed = 5;
  scene s = cloud_flocs(6, 8, 0.7, 14.0, 1, 1.3, 3);
  s.fast = 1;
  *slip = malloc(sizeof(double) * 3 * (size_t) s.n);
  for (int j = 0; j < 3 * s.n; j++) (*slip)[j] = uniform(&seed, -1, 1);
  return s;
}

/* Both stop at 1e-10 of their own norm, which is at most some hundred times the other's here. */
static void resting_bodies_have_the_forces_of_points(void **state)
{
  (void) state;
  double *slip, *F;
  scene s = cloud(&slip);
  double *rest = calloc(3 * (size_t) s.n, sizeof(double)), most = 0.0;
  sd_status status;
  sd_solve_report report;
  F = scene_solve(&s, sd_solve_gradients, slip, 1e-10, 3000, &status, &report);
  assert_int_equal(status, SD_OK);
  resting_solve(&s, slip, 0, 1e-10, rest);
  for (int j = 0; j < 3 * s.n; j++) most = fmax(most, fabs(F[j]));
  for (int j = 0; j < 3 * s.n; j++) CHECK_NEAR(rest[j], F[j], 1e-7 * most);
  free(slip);
  free(F);
  free(rest);
  scene_free(&s);
}

/* Why sd_solve_gradients stays: of spheres that settle together the smoothed residual gets there with fewer products
 * (bench_resting). */
static void the_solver_of_points_reaches_its_residual_sooner(void **state)
{
  (void) state;
  scene s = scene_lattice(8, 8, 8, 2.0, 0.7, 1.3);
  s.fast = 1;
  double *slip = scene_uniform_slip(&s, 0, 0, 0.9), *rest = malloc(sizeof(double) * 3 * (size_t) s.n);
  sd_status status;
  sd_solve_report report;
  double *F = scene_solve(&s, sd_solve_gradients, slip, 1e-3, 3000, &status, &report);
  assert_int_equal(status, SD_OK);
  assert_true(report.products < resting_to_residual(&s, slip, NULL, 1e-3, rest));
  free(F);
  free(slip);
  free(rest);
  scene_free(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(resting_bodies_have_the_forces_of_points),
      cmocka_unit_test(the_solver_of_points_reaches_its_residual_sooner),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
