/* Kernels, equations of state, walls: closed forms. */
#include "sd_sph_kernel.h"
#include "sd_sph_pressure.h"
#include "sd_sph_step.h"
#include "sd_sph_wall.h"

#include "check.h"

static const sd_sph_kernel KERNELS[] = {SD_SPH_CUBICSPLINE, SD_SPH_WENDLAND};

/* Composite Simpson rule on each of the two pieces; the integrand is a polynomial of degree <= 7, so the
 * error falls as n^-4 to rounding. */
static void kernels_have_integral_1(void **state)
{
  (void) state;
  const double pi = 3.14159265358979323846, h = 0.37;
  const int n = 2000;
  for (int k = 0; k < 2; k++)
    for (int dimension = 2; dimension <= 3; dimension++) {
      double sum = 0.0;
      for (int piece = 0; piece < 2; piece++)
        for (int m = 0; m <= n; m++) {
          const double r = h * (piece + (double) m / n),
                       weight = m == 0 || m == n ? 1
              : m % 2                            ? 4
                                                 : 2;
          const double shell = dimension == 3 ? 4 * pi * r * r : 2 * pi * r;
          sum += weight * h / (3.0 * n) * shell * sd_sph_W(KERNELS[k], dimension, r, h);
        }
      CHECK_NEAR(sum, 1.0, 1e-12);
    }
}

static void derivative_is_that_of_the_kernel(void **state)
{
  (void) state;
  const double h = 0.37, step = 1e-6;
  for (int k = 0; k < 2; k++)
    for (int dimension = 2; dimension <= 3; dimension++)
      for (double q = 0.05; q < 2.2; q += 0.05) {
        const double r = q * h, scale = sd_sph_W(KERNELS[k], dimension, 0.0, h) / h;
        const double slope = (sd_sph_W(KERNELS[k], dimension, r + step, h) -
                              sd_sph_W(KERNELS[k], dimension, r - step, h)) /
            (2 * step);
        CHECK_NEAR(r * sd_sph_dW_over_r(KERNELS[k], dimension, r, h), slope, 1e-8 * scale);
      }
}

static void kernels_vanish_at_the_support(void **state)
{
  (void) state;
  for (int k = 0; k < 2; k++)
    for (int dimension = 2; dimension <= 3; dimension++) {
      const double h = 0.37;
      assert_true(sd_sph_W(KERNELS[k], dimension, 2 * h, h) == 0.0);
      assert_true(sd_sph_W(KERNELS[k], dimension, 3 * h, h) == 0.0);
      assert_true(sd_sph_dW_over_r(KERNELS[k], dimension, 2.5 * h, h) == 0.0);
      assert_true(sd_sph_W(KERNELS[k], dimension, 1.999 * h, h) > 0.0);
      CHECK_NEAR(sd_sph_W(KERNELS[k], dimension, 1.9999 * h, h), 0.0, 1e-10 / (h * h * h));
    }
}

/* The constants of the literature. */
static void norms(void **state)
{
  (void) state;
  CHECK_NEAR(sd_sph_W(SD_SPH_CUBICSPLINE, 3, 0.0, 1.0), 1.0 / 3.14159265358979323846, 1e-15);
  CHECK_NEAR(sd_sph_W(SD_SPH_CUBICSPLINE, 2, 0.0, 1.0), 10.0 / (7.0 * 3.14159265358979323846),
             1e-15);
  CHECK_NEAR(sd_sph_W(SD_SPH_WENDLAND, 3, 0.0, 1.0), 0.417781725616, 1e-12);
  CHECK_NEAR(sd_sph_W(SD_SPH_WENDLAND, 2, 0.0, 1.0), 0.557042300822, 1e-12);
}

static void states_and_their_inverses(void **state)
{
  (void) state;
  const sd_sph_state states[] = {{SD_SPH_ABSOLUT, 7.5, 0, 0, 0, 0},
                                 {SD_SPH_RELATIV, 130.0, 900.0, 0, 45.0, 0},
                                 {SD_SPH_TAIT, 6e4, 900.0, 7.0, 45.0, 0},
                                 {SD_SPH_TAIT, 6e4, 900.0, 1.4, -45.0, 0}};
  CHECK_NEAR(sd_sph_pressure(&states[0], 950.0), 7.5 * 7.5 * 950.0, 1e-9);
  CHECK_NEAR(sd_sph_pressure(&states[1], 950.0), 130.0 * 50.0 + 45.0, 1e-9);
  CHECK_NEAR(sd_sph_pressure(&states[2], 950.0), 6e4 * (pow(950.0 / 900.0, 7.0) - 1.0) + 45.0,
             1e-9);
  CHECK_NEAR(sd_sph_pressure(&states[3], 950.0), 6e4 * (pow(950.0 / 900.0, 1.4) - 1.0) - 45.0,
             1e-9);
  for (int k = 0; k < 4; k++)
    for (double rho = 850.0; rho < 1000.0; rho += 37.0)
      CHECK_NEAR(sd_sph_density_of(&states[k], sd_sph_pressure(&states[k], rho)), rho, 1e-10 * rho);
  assert_true(sd_sph_density_of(&states[2], -1e6) == 0.0);
}

/* Below rho0 the pressure is P0, above it is that of the same law. */
static void states_without_tension(void **state)
{
  (void) state;
  const sd_sph_state states[] = {{SD_SPH_RELATIV, 130.0, 900.0, 0, 45.0, 0},
                                 {SD_SPH_TAIT, 6e4, 900.0, 7.0, -45.0, 0}};
  for (int k = 0; k < 2; k++) {
    sd_sph_state slack = states[k];
    slack.no_tension = 1;
    assert_true(sd_sph_pressure(&slack, 850.0) == slack.P0);
    assert_true(sd_sph_pressure(&slack, 950.0) == sd_sph_pressure(&states[k], 950.0));
    assert_true(sd_sph_density_of(&slack, -1e9) == 900.0);
    CHECK_NEAR(sd_sph_density_of(&slack, sd_sph_pressure(&slack, 950.0)), 950.0, 1e-7);
    assert_true(sd_sph_least_pressure(&slack) == slack.P0);
    assert_true(sd_sph_density_of_water(&slack, 850.0) == 900.0 && sd_sph_density_of_water(&states[k], 850.0) == 850.0);
    assert_true(sd_sph_density_of_water(&slack, 950.0) == 950.0);
  }
  const int mask[4] = {2, 2, 2, 1};
  double rho[4] = {-3.0, 880.0, 950.0, -3.0}, kept[4] = {-3.0, 880.0, 950.0, -3.0};
  sd_sph_state slack = states[1];
  sd_sph_keep_size(&slack, 4, kept, mask, 2);
  for (int i = 0; i < 4; i++) assert_true(kept[i] == rho[i]);
  slack.no_tension = 1;
  rho[0] = 270.0;
  sd_sph_keep_size(&slack, 4, kept, mask, 2);
  for (int i = 0; i < 4; i++) CHECK_NEAR(kept[i], rho[i], 1e-12);
}

static void repulsion(void **state)
{
  (void) state;
  CHECK_NEAR(sd_sph_repulsion(3.0, 0.2, 0.1), 3.0 * (16.0 - 4.0), 1e-13);
  assert_true(sd_sph_repulsion(3.0, 0.2, 0.2) == 0.0);
  assert_true(sd_sph_repulsion(3.0, 0.2, 0.3) == 0.0);
}

/* artVisc of fix sph, the rule of thumb 3 alpha h/(8 c) in two dimensions */
static void sound_grows_above_what_viscosity_damps(void **state)
{
  (void) state;
  sd_sph_model model = {.dimension = 2, .artvisc = 1};
  const sd_sph_parameters p = {.h = 0.02, .c = 30.0, .alpha = 0.07, .mu = 0.4};
  const double flat = 3.0 * 0.07 * 0.02 / (8.0 * 30.0), of_mu = 2.0 * 0.4 / 900.0 / (30.0 * 30.0);
  CHECK_NEAR(sd_sph_growth_limit(&model, &p, 900.0) / flat, 1.0, 1e-14);
  model.dimension = 3;
  CHECK_NEAR(sd_sph_growth_limit(&model, &p, 900.0) / flat, 16.0 / 20.0, 1e-14);
  model.friction = SD_SPH_CENTRAL;
  CHECK_NEAR(sd_sph_growth_limit(&model, &p, 900.0), 0.8 * flat + 3.0 * of_mu, 1e-18);
  model.friction = SD_SPH_LAPLACIAN;
  model.artvisc = 0;
  CHECK_NEAR(sd_sph_growth_limit(&model, &p, 900.0), of_mu, 1e-18);
  model.friction = SD_SPH_INVISCID;
  assert_true(sd_sph_growth_limit(&model, &p, 900.0) == 0.0);
}

static void time_step_limits(void **state)
{
  (void) state;
  CHECK_NEAR(sd_sph_step_limit(SD_SPH_CENTRAL, 0.02, 30.0, 10.0, 0.0, 900.0), 0.02 / 40.0, 1e-18);
  CHECK_NEAR(sd_sph_step_limit(SD_SPH_INVISCID, 0.02, 30.0, 10.0, 500.0, 900.0), 0.02 / 40.0, 1e-18);
  CHECK_NEAR(sd_sph_step_limit(SD_SPH_LAPLACIAN, 0.02, 30.0, 10.0, 500.0, 900.0), 0.02 * 0.02 * 900.0 / 4000.0, 1e-18);
  CHECK_NEAR(sd_sph_step_limit(SD_SPH_CENTRAL, 0.02, 30.0, 10.0, 500.0, 900.0), 0.02 * 0.02 * 900.0 / 9000.0, 1e-18);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(kernels_have_integral_1),
                                     cmocka_unit_test(derivative_is_that_of_the_kernel),
                                     cmocka_unit_test(kernels_vanish_at_the_support),
                                     cmocka_unit_test(norms),
                                     cmocka_unit_test(states_and_their_inverses),
                                     cmocka_unit_test(states_without_tension),
                                     cmocka_unit_test(repulsion),
                                     cmocka_unit_test(time_step_limits),
                                     cmocka_unit_test(sound_grows_above_what_viscosity_damps)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
