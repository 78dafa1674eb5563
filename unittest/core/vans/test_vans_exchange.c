/* What water and grains give each other. */
#include "check.h"

#include "sd_constants.h"
#include "sd_vans_books.h"
#include "yade_drag.h"

/* The signed coefficient survives grains that are faster than the water; Yade's is cut to 0 there. Both are limited to
 * 1/(10 dt), which keeps some of the drag from the water; what, is told. */
static void exchange_coefficient(void **state)
{
  (void) state;
  enum { N = 4 };
  const double edge[N + 1] = {0, 1, 2, 3, 4}, U[N + 1] = {0, 0.5, 0.5, 0.501, 0.5};
  const double profile[SD_VANS_ROWS * N] = {0.3, 0.3, 0.3,         0.0,   0.2,  0.9,
                                            0.5, 0.0, [16] = 2e-5, -3e-5, 3e-5, 0.0};
  const sd_vans_mesh mesh = {N, 0, 1, edge};
  sd_vans_fluid fluid = {.rho = 1000, .eta = 1e-3, .radius = 0.003, .least_slip = 1e-5};
  const double n = 0.3 / (4.0 / 3.0 * SD_PI * 27e-9);
  double b[N], cut[2];
  sd_vans_exchange(&mesh, &fluid, 1e-2, U, &(sd_vans_means){profile, NULL, NULL}, b, cut);
  assert_true(fabs(b[0] / (n * 2e-5 / 0.3 / 1000) - 1) < 1e-14 &&
              fabs(b[1] / (n * 3e-5 / 0.4 / 1000) - 1) < 1e-14 && b[2] == 10.0 && b[3] == 0.0);
  assert_true(fabs(cut[1] / (n * 8e-5) - 1) < 1e-14 &&
              fabs(cut[0] / (n * 3e-5 - 1000 * 10.0 * 0.001) - 1) < 1e-12);
  fluid.rules = SD_VANS_YADE;
  sd_vans_exchange(&mesh, &fluid, 1e-2, U, &(sd_vans_means){profile, NULL, NULL}, b, cut);
  assert_true(b[0] == 0.0 && b[1] == 0.0 && b[2] == 10.0);
}

/* In any units: lengths, times and masses by factors, the coefficient by 1/time. The slip is 1e-9 of the velocities. */
static void exchange_knows_no_unit(void **state)
{
  (void) state;
  double b[2];
  for (int k = 0; k < 2; k++) {
    const double L = k ? 1e6 : 1.0, T = k ? 1e3 : 1.0, M = k ? 1e-4 : 1.0, u = 0.5 * L / T;
    const double edge[3] = {0, L, 2 * L}, U[3] = {0, u * (1 + 1e-9), u};
    const double profile[SD_VANS_ROWS * 2] = {0.3, 0.0, u, 0.0, [8] = 2e-20 * M * L / T / T, 0.0};
    const sd_vans_mesh mesh = {2, 0, L, edge};
    const sd_vans_fluid fluid = {.rho = 1000 * M / L / L / L, .radius = 0.003 * L};
    double each[2], cut[2];
    sd_vans_exchange(&mesh, &fluid, 1e-6 * T, U, &(sd_vans_means){profile, NULL, NULL}, each, cut);
    b[k] = each[0] * T;
  }
  assert_true(b[0] > 0.0 && fabs(b[1] / b[0] - 1) < 1e-6);
}

/* dU/dt of water past fixed grains, by the drag that one of them feels. */
static void rate_of_drag_is_that_of_its_grains(void **state)
{
  (void) state;
  enum { N = 4 };
  const double edge[N + 1] = {0, 1, 2, 3, 4}, U[N + 1] = {0, 0.02, 0.3, 0.1, 0.1}, a = 0.003;
  const double profile[SD_VANS_ROWS * N] = {0.3, 0.5, 0.0, 0.6, 0.0, 0.1};
  const sd_vans_mesh mesh = {N, 0, 1, edge};
  const sd_vans_fluid fluid = {.rho = 1030, .eta = 2e-3, .radius = a};
  double hindrance[N], F[3], w[3] = {0.2, 0, 0};
  int slice = -1;
  hindrance_of(N, profile, 3.1, hindrance);
  const double rate = sd_vans_drag_rate(&mesh, &fluid, U, hindrance, profile, &slice);
  yade_drag(fluid.rho, fluid.eta, a, hindrance[1], w, F);
  assert_int_equal(slice, 1);
  assert_true(fabs(rate * 0.2 * fluid.rho * 4.0 / 3.0 * SD_PI * a * a * a / 0.5 / F[0] - 1) < 1e-13);
}

/* b from the law, whatever the drag: positive, of one class as of two halves of it, and with the
 * rest the drag that there is. */
static void exchange_by_law_takes_the_drag_as_it_is(void **state)
{
  (void) state;
  enum { N = 4 };
  const double edge[N + 1] = {0, 1, 2, 3, 4}, U[N + 1] = {0, 0.02, 0.3, 0.1, 0.1}, a = 0.003;
  double profile[SD_VANS_ROWS * N] = {0.3, 0.5, 0.1, 0.0, 0.1, 0.1, 0.1}, classes[2 * SD_VANS_ROWS * N] = {0};
  const double drag[N] = {3e-5, -2e-5, 1e-5, 0}, radii[2] = {a, a};
  const sd_vans_mesh mesh = {N, 0, 1, edge};
  sd_vans_fluid fluid = {.rho = 1030, .eta = 2e-3, .radius = a, .class_radius = radii};
  double hindrance[N], b[N], rest[N], of_classes[N];
  hindrance_of(N, profile, 3.1, hindrance);
  for (int n = 0; n < N; n++) {
    profile[SD_VANS_DRAG * N + n] = drag[n];
    for (int c = 0; c < 2; c++) {
      classes[c * SD_VANS_ROWS * N + n] = 0.5 * profile[n];
      classes[(c * SD_VANS_ROWS + SD_VANS_DRAG) * N + n] = drag[n];
    }
  }
  sd_vans_exchange_by_law(&mesh, &fluid, U, hindrance, &(sd_vans_means){profile, NULL, NULL}, b, rest);
  for (int n = 0; n < N; n++) {
    const double slip = U[n + 1] - profile[N + n], w[3] = {slip, 0, 0}, V = 4.0 / 3.0 * SD_PI * a * a * a;
    double F[3];
    yade_drag(fluid.rho, fluid.eta, a, hindrance[n], w, F);
    assert_true(n == 3 ? b[n] == 0.0 : fabs(b[n] * slip - profile[n] / V * F[0] / fluid.rho) < 1e-12 * b[n]);
    assert_true(fabs(b[n] * slip - rest[n] - profile[n] / V * drag[n] / fluid.rho) < 1e-13);
  }
  fluid.nclass = 2;
  sd_vans_exchange_by_law(&mesh, &fluid, U, hindrance, &(sd_vans_means){profile, classes, NULL}, of_classes, rest);
  for (int n = 0; n < N; n++) assert_true(fabs(of_classes[n] - b[n]) <= 1e-14 * b[n]);
}

/* Nine tenths of what is outstanding stay; none is lost, and the slices above the surface have no water. */
static void momentum_goes_back_in_tenths(void **state)
{
  (void) state;
  enum { N = 5, ALL = 7 };
  const double edge[N + 1] = {0, 0.1, 0.3, 0.6, 1.0, 1.5};
  const sd_vans_mesh mesh = {N, 0, 0, edge};
  double back[ALL] = {1, -2, 3, 4, 2, 1, 2}, outstanding[ALL] = {0.5, 0, 0, -1, 0.5, -0.5, 1}, source[N], sum = 0.0;
  const double returned = sd_vans_give_back(&mesh, ALL, 1030 * 0.7, 0.25, back, outstanding, source);
  for (int n = 0; n < N; n++) sum += source[n] * 1030 * 0.7 * (edge[n + 1] - edge[n]) * 0.25;
  assert_true(fabs(returned - 1.15) < 1e-14 && fabs(sum - returned) < 1e-14);
  assert_true(source[4] == 0.0 && fabs(outstanding[3] - 8.1) < 1e-14);
  for (int n = 4; n < ALL; n++) assert_true(outstanding[n] == 0.0);
}

/* All water gets the same velocity of it, between grains too. */
static void momentum_of_nobody_is_shared_out_evenly(void **state)
{
  (void) state;
  enum { N = 5 };
  const double edge[N + 1] = {0, 0.1, 0.3, 0.6, 1.0, 1.5}, phi[N] = {0.6, 0.4, 0.1, 0.0, 0.0};
  const sd_vans_mesh mesh = {N, 0, 0, edge};
  double back[N] = {0.0}, sum = 0.0;
  sd_vans_share_out(&mesh, phi, -3.0, back);
  for (int n = 0; n < N; n++) sum += back[n];
  for (int n = 0; n < N - 1; n++)
    assert_true(fabs(back[n] / ((1 - phi[n]) * (edge[n + 1] - edge[n])) - back[3] / 0.4) < 1e-13);
  assert_true(fabs(sum + 3.0) < 1e-14 && back[N - 1] == 0.0);
}

/* What b (U - v) has too much at the start of a solve goes out of the books in the slices that have water. */
static void what_no_grain_gets_goes_out_of_the_books(void **state)
{
  (void) state;
  enum { N = 4 };
  const double edge[N + 1] = {0, 0.1, 0.3, 0.6, 1.0}, rest[N] = {2e-3, -1e-3, 0.0, 7.0}, rho = 1030, T = 0.25;
  const sd_vans_mesh mesh = {N, 0.4, 0, edge};
  double moved[N] = {0.3, 0.2, 0.1, 0.0}, shear[N] = {0.01, 0.02, 0.03, 0.0};
  sd_vans_books books = {moved, shear, 1, 2, 3, 4, 5};
  sd_vans_take_out_rest(&mesh, rho, T, rest, &books);
  CHECK_NEAR(moved[0], 0.3 - rho * 0.1 * T * 2e-3, 1e-15);
  CHECK_NEAR(moved[1], 0.2 + rho * 0.2 * T * 1e-3, 1e-15);
  assert_true(moved[2] == 0.1 && moved[3] == 0.0 && shear[1] == 0.02 && books.driving == 1);
}

/* A grain that is held has the account of one that moves by steps while drag and viscous force stay the same. */
static void a_held_grain_is_one_whose_drag_stays(void **state)
{
  (void) state;
  const double drag = 1.1, dt = 0.05, T = 10 * dt, ratio = 1.7;
  sd_vans_account moves = {.force = drag + 0.3, .shear = 0.3, .past = 0.3, .foreseen = 0.7}, held = moves;
  double impulse;
  for (int step = 0; step < 10; step++) sd_vans_account_step(&moves, drag + moves.shear, dt);
  CHECK_NEAR(sd_vans_account_held(&held, drag, T, ratio, &impulse), sd_vans_account_rest(&moves, T, dt, ratio), 1e-14);
  CHECK_NEAR(impulse, moves.impulse, 1e-14);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(exchange_coefficient),
      cmocka_unit_test(exchange_knows_no_unit),
      cmocka_unit_test(rate_of_drag_is_that_of_its_grains),
      cmocka_unit_test(exchange_by_law_takes_the_drag_as_it_is),
      cmocka_unit_test(momentum_goes_back_in_tenths),
      cmocka_unit_test(momentum_of_nobody_is_shared_out_evenly),
      cmocka_unit_test(what_no_grain_gets_goes_out_of_the_books),
      cmocka_unit_test(a_held_grain_is_one_whose_drag_stays),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
