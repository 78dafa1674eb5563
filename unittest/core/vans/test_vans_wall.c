/* Friction of side walls: its law, Yade's, and the stream between them. */
#include "column.h"

/* 1/sqrt(f) - 2 log10(Re sqrt(f)) - 0.32, over 1/sqrt(f); below the Reynolds number where the
 * two meet f is 24/Re */
static double residual_of_law(double Re, double f)
{
  if (Re < SD_VANS_WALL_TRANSITION) return f * Re / 24.0 - 1.0;
  return 1.0 - (2.0 * log10(Re * sqrt(f)) + 0.32) * sqrt(f);
}

/* Friction of the side walls: the base-10 law to rounding, from any start; f falls smoothly,
 * without the jumps of a substitution that stops at 1 %. */
static void wall_friction_follows_its_law(void **state)
{
  (void) state;
  double previous = INFINITY;
  sd_vans_friction near_by = {0};
  for (double Re = 1e-6; Re < 1e12; Re *= 1.0007) {
    sd_vans_friction anew = {0};
    const double f = sd_vans_wall_friction(SD_VANS_CONSISTENT, Re, &anew);
    assert_true(fabs(residual_of_law(Re, f)) < 1e-13 * (1.0 + fabs(log10(Re)) * sqrt(f)));
    assert_true(f < previous && (f > 0.997 * previous || previous == INFINITY));
    const double warm = sd_vans_wall_friction(SD_VANS_CONSISTENT, Re, &near_by);
    assert_true(fabs(warm - f) < 1e-12 * f);
    previous = f;
  }
  /* from far away: water that comes to rest, or starts */
  sd_vans_friction far = {0};
  sd_vans_wall_friction(SD_VANS_CONSISTENT, 1e6, &far);
  assert_true(fabs(residual_of_law(0.01, sd_vans_wall_friction(SD_VANS_CONSISTENT, 0.01, &far))) <
              1e-12);
  /* laminar at Re 1e2, Graf & Altinakar's law at Re 1e3..1e5, four digits */
  const double law[4] = {0.24, 0.0411, 0.0225, 0.0140};
  for (int k = 0; k < 4; k++) {
    const double f = sd_vans_wall_friction(SD_VANS_CONSISTENT, pow(10.0, k + 2), &far);
    assert_true(fabs(f / law[k] - 1.0) < 0.006);
  }
}

/* A stream that speeds up and slows down by 3e-5 a step: the law to 1e-12 of its equation, though it is solved for
 * once in 20 steps. */
static void wall_friction_holds_between_two_solutions(void **state)
{
  (void) state;
  sd_vans_friction near_by = {0};
  double largest = 0.0, Re = 1e2;
  int steps = 0, solved = 0;
  for (int up = 1; up >= 0; up--)
    for (; up ? Re < 1e8 : Re > 1e2; Re *= up ? 1.00003 : 1 / 1.00003) {
      const double before = near_by.inverse;
      const double f = sd_vans_wall_friction(SD_VANS_CONSISTENT, Re, &near_by);
      largest = fmax(largest, fabs(residual_of_law(Re, f)));
      steps++;
      solved += near_by.inverse != before;
    }
  printf("    Re 1e2 to 1e8 and back: largest residual %.1e, solved for %d times in %d\n", largest,
         solved, steps);
  assert_true(largest < 1e-13);
  assert_in_range(solved, steps / 25, steps / 15);
}

/* Yade's: the iterate at which f changes by less than 1 %, with a natural logarithm: 3.3 to 4.3 times too small. */
static double yades_friction(double Re)
{
  double f = 1.0 / (0.32 * 0.32);
  for (int k = 0; k < 100; k++) {
    const double root = 2.0 * log(Re * sqrt(f)) + 0.32, next = 1.0 / (root * root),
                 change = fabs(next - f) / f;
    f = next;
    if (change < 1e-2) return f;
  }
  return 0.0;
}

/* Also where its jumps are: what a series reaches lies on the same side of them. */
static void yades_wall_friction_is_a_substitution(void **state)
{
  (void) state;
  const double yade[4] = {0.0281, 0.0108, 0.0055, 0.0032};
  for (int k = 0; k < 4; k++)
    assert_true(fabs(yades_friction(pow(10.0, k + 2)) / yade[k] - 1.0) < 0.02);
  sd_vans_friction near_by = {0};
  int steps = 0, jumps = 0, solved = 0;
  double previous = 0.0;
  for (double Re = 1e-3; Re < 1e8; Re *= 1.000007, steps++) {
    const double before = near_by.inverse, exact = yades_friction(Re);
    const double f = sd_vans_wall_friction(SD_VANS_YADE, Re, &near_by);
    assert_true(fabs(f - exact) <= 1e-12 * exact);
    solved += near_by.inverse != before;
    jumps += Re > 10.0 && fabs(f / previous - 1.0) > 1e-4;
    previous = f;
  }
  printf("    yade: %d jumps, solved for %d times in %d\n", jumps, solved, steps);
  assert_true(jumps > 3);
  assert_true(solved < steps / 2);
}

/* f of a smooth pipe (Prandtl), Re on the diameter. */
static double pipe_friction(double Re)
{
  double f = 0.02;
  for (int k = 0; k < 60; k++) f = pow(2.0 * log10(Re * sqrt(f)) - 0.8, -2.0);
  return f;
}

/* Far from the bottom, without grains and turbulence, slope and side walls balance: g = 2/width f/8 U^2, with the f of
 * the law on the hydraulic radius, and so with that of a pipe whose diameter is four times that: to 3 %, as far as the
 * two laws of smooth walls agree. On the width it would be 15 % off. */
static void side_walls_balance_the_slope(void **state)
{
  (void) state;
  const double width = 0.02, g = 0.3, nu = 1e-6;
  column *c = column_create(41, 0.4, 0.0);
  const sd_vans_fluid fluid = {.rho = 1000,
                               .eta = 1e-3,
                               .gx = g,
                               .turbulence = SD_VANS_LAMINAR,
                               .kappa = 0.41,
                               .phi_max = 0.6,
                               .width = width,
                               .wall_coef = 1.2};
  solve(c, &fluid, 4000, 0.01);
  sd_vans_friction anew = {0};
  const double U = c->U[40], hydraulic_radius = width / 2.0,
               f = sd_vans_wall_friction(SD_VANS_CONSISTENT, U * hydraulic_radius / nu, &anew);
  assert_true(fabs(2.0 / width * 1.2 * f / 8.0 * U * U / g - 1.0) < 1e-6);
  const double found = g * width * 8.0 / (2.0 * 1.2 * U * U),
               pipe = pipe_friction(U * 4.0 * hydraulic_radius / nu);
  printf("    walls 20 mm apart, %.2f m/s: f = %.5f, of a pipe %.5f\n", U, found, pipe);
  assert_true(fabs(found / pipe - 1.0) < 0.03);
  column_free(c);
}

/* At the transition both laws have one f, so that no speed is left out, and no speed of the stream
 * jumps when the slope grows. */
static void laminar_and_turbulent_friction_meet(void **state)
{
  (void) state;
  const double Re = SD_VANS_WALL_TRANSITION;
  sd_vans_friction below = {0}, above = {0};
  const double lower = sd_vans_wall_friction(SD_VANS_CONSISTENT, Re * (1 - 1e-12), &below),
               upper = sd_vans_wall_friction(SD_VANS_CONSISTENT, Re * (1 + 1e-12), &above);
  assert_true(fabs(lower * Re / 24.0 - 1.0) < 1e-11 && fabs(upper / lower - 1.0) < 1e-11);
  /* no series reaches over it: asked on the other side, the other law answers */
  assert_true(fabs(sd_vans_wall_friction(SD_VANS_CONSISTENT, Re * 1.0004, &below) /
                       (24.0 / (Re * 1.0004)) - 1.0) > 1e-5);
}

/* Water in a slot, at rest until the slope drives it, is plane Poiseuille flow in the mean over the
 * width, U = g W^2/(12 nu), from water to a liquid a thousand times as viscous. */
static void slow_stream_between_walls_is_laminar(void **state)
{
  (void) state;
  const double W = 0.0065;
  static const double nu[] = {1e-6, 1e-5, 1e-4, 1e-3}, g[] = {2e-3, 0.05, 0.98, 0.98};
  for (int k = 0; k < 4; k++) {
    column *c = column_create(201, 1.0, 0.0);
    const sd_vans_fluid fluid = {.rho = 1000, .eta = 1000 * nu[k], .gx = g[k], .kappa = 0.41,
                                 .phi_max = 0.6, .width = W, .wall_coef = 1.0};
    solve(c, &fluid, 4000, 0.02 * W * W / nu[k] / 12.0);
    const double exact = g[k] * W * W / (12.0 * nu[k]);
    printf("    nu %.0e: U %.6g, plane Poiseuille %.6g\n", nu[k], c->U[150], exact);
    assert_true(fabs(c->U[150] / exact - 1.0) < 1e-3);
    column_free(c);
  }
}

/* Rough walls: fully rough, 1/sqrt(f) = 2 log10(14.8 R/k_s), whatever the viscosity; with k_s -> 0
 * the smooth law; and never less than laminar. */
static void rough_walls_follow_colebrook(void **state)
{
  (void) state;
  sd_vans_friction wall = {.roughness = 0.05};
  double f = sd_vans_wall_friction(SD_VANS_CONSISTENT, 1e9, &wall);
  assert_true(fabs(f * pow(2.0 * log10(14.8 / 0.05), 2.0) - 1.0) < 1e-5);
  wall.roughness = 1e-12;
  for (double Re = 500; Re < 1e6; Re *= 7) {
    sd_vans_friction smooth = {0};
    f = sd_vans_wall_friction(SD_VANS_CONSISTENT, Re, &wall);
    assert_true(fabs(f / sd_vans_wall_friction(SD_VANS_CONSISTENT, Re, &smooth) - 1.0) < 1e-9);
  }
  wall.roughness = 0.3;
  for (double Re = 1; Re < 1e6; Re *= 1.3) {
    f = sd_vans_wall_friction(SD_VANS_CONSISTENT, Re, &wall);
    const double law = 1.0 / sqrt(f) +
        2.0 * log10(0.3 / 14.8 + pow(10.0, -0.16) / (Re * sqrt(f)));
    assert_true(f >= 24.0 / Re * (1 - 1e-14) && (fabs(law) < 1e-12 || f * Re < 24.0 + 1e-9));
  }
}

/* Eddies between narrow walls are no longer than kappa W/2. */
static void narrow_walls_limit_the_mixing_length(void **state)
{
  (void) state;
  column *c = column_create(101, 0.2, 0.0);
  sd_vans_fluid fluid = {.turbulence = SD_VANS_KZ, .kappa = 0.4, .width = 0.03, .narrow = 1};
  find_lengths(c, &fluid, NULL);
  for (int j = 0; j <= 100; j++)
    assert_true(fabs(c->length[j] - 0.4 * fmin(c->edge[j], 0.015)) < 1e-15);
  column_free(c);
}

/* Of the fastest slice below the uppermost: laminar 12 nu/width^2 at any speed, turbulent f |U|/(4 width). */
static void walls_take_momentum_at_a_rate(void **state)
{
  (void) state;
  const double edge[5] = {0, 0.1, 0.2, 0.3, 0.4};
  const sd_vans_mesh mesh = {.ncell = 4, .edge = edge};
  sd_vans_fluid fluid = {.rho = 1300.0, .eta = 0.0026, .width = 0.005, .wall_coef = 0.7, .wall_roughness = 2e-4};
  double U[5] = {9.0, 0.0, -0.01, 0.005, 9.0};
  const double laminar = 0.7 * 12.0 * 2e-6 / (0.005 * 0.005);
  assert_true(fabs(sd_vans_wall_rate(&mesh, &fluid, U) / laminar - 1.0) < 1e-12);
  U[2] = 0.0;
  U[3] = 0.0;
  assert_true(fabs(sd_vans_wall_rate(&mesh, &fluid, U) / laminar - 1.0) < 1e-12);
  U[2] = -1.5;
  sd_vans_friction anew = {.roughness = 0.08};
  const double f = sd_vans_wall_friction(SD_VANS_CONSISTENT, 1.5 * 0.0025 / 2e-6, &anew);
  assert_true(fabs(sd_vans_wall_rate(&mesh, &fluid, U) / (0.7 * f * 1.5 / (4.0 * 0.005)) - 1.0) < 1e-12);
  fluid.width = 0.0;
  assert_true(sd_vans_wall_rate(&mesh, &fluid, U) == 0.0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(laminar_and_turbulent_friction_meet),
      cmocka_unit_test(slow_stream_between_walls_is_laminar),
      cmocka_unit_test(rough_walls_follow_colebrook),
      cmocka_unit_test(narrow_walls_limit_the_mixing_length),
      cmocka_unit_test(wall_friction_follows_its_law),
      cmocka_unit_test(wall_friction_holds_between_two_solutions),
      cmocka_unit_test(yades_wall_friction_is_a_substitution),
      cmocka_unit_test(side_walls_balance_the_slope),
      cmocka_unit_test(walls_take_momentum_at_a_rate),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
