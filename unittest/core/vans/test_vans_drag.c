/* Laws of drag: lone spheres and sand, hindrance, shares of members that overlap, added mass. */
#include "check.h"

#include "sd_constants.h"
#include "sd_vans.h"

static const double RHO = 1000, ETA = 1e-3, G = 9.81;

/* C_d of Clift & Gauvin (1970), within 6 % of all measurements below Re 3e5. */
static double clift_gauvin(double Re)
{
  return 24.0 / Re * (1.0 + 0.15 * pow(Re, 0.687)) + 0.42 / (1.0 + 42500.0 * pow(Re, -1.16));
}

/* Speed at which the drag of a law is the submerged weight, by bisection. */
static double terminal(sd_drag_law law, double a, double density, double hindrance)
{
  const double weight = 4.0 / 3.0 * SD_PI * a * a * a * (density - RHO) * G;
  double low = 0.0, high = 100.0;
  for (int k = 0; k < 200; k++) {
    const double w = 0.5 * (low + high);
    *(sd_drag_factor(law, RHO, ETA, a, hindrance, w) * w < weight ? &low : &high) = w;
  }
  return low;
}

static double measured(double a, double density)
{
  double low = 0.0, high = 100.0;
  for (int k = 0; k < 200; k++) {
    const double w = 0.5 * (low + high), Re = 2 * a * w * RHO / ETA;
    *(0.375 * RHO * clift_gauvin(Re) * w * w / a < (density - RHO) * G ? &low : &high) = w;
  }
  return low;
}

/* Quartz of 0.1 to 10 mm in water. */
static void spheres_fall_as_measured(void **state)
{
  (void) state;
  const sd_drag_law brown = {.law = SD_DRAG_BROWN_LAWLER}, schiller = {.law = SD_DRAG_SCHILLER_NAUMANN};
  double worst = 0.0;
  for (double d = 1e-4; d < 1.001e-2; d *= 1.2589) {
    const double w = measured(0.5 * d, 2650);
    worst = fmax(worst, fabs(terminal(brown, 0.5 * d, 2650, 1.0) / w - 1.0));
    if (2 * d * w < 2e-3) assert_true(fabs(terminal(schiller, 0.5 * d, 2650, 1.0) / w - 1.0) < 0.03);
  }
  printf("    brown_lawler: largest error %.4f of Clift & Gauvin\n", worst);
  assert_true(worst < 0.03);
}

/* w = (s-1) g d^2/(18 nu + sqrt(0.75 (s-1) g d^3)) */
static void sand_falls_by_ferguson_and_church(void **state)
{
  (void) state;
  const sd_drag_law law = {.law = SD_DRAG_FERGUSON_CHURCH};
  for (double d = 5e-5; d < 1e-2; d *= 1.7) {
    const double R = 1.65 * G, w = R * d * d / (18e-6 + sqrt(0.75 * R * d * d * d));
    assert_true(fabs(terminal(law, 0.5 * d, 2650, 1.0) / w - 1.0) < 1e-12);
  }
}

/* With the fall diameter half its own a grain falls as a sphere half as large, alone and in a crowd; any law. */
static void a_grain_falls_as_the_sphere_of_its_fall_diameter(void **state)
{
  (void) state;
  for (int law = SD_DRAG_YADE; law <= SD_DRAG_FERGUSON_CHURCH; law++)
    for (int many = SD_HINDRANCE_POWER; many <= SD_HINDRANCE_DI_FELICE; many++) {
      const sd_drag_law sphere = {(sd_drag_of_one) law, (sd_drag_of_many) many, 0.0};
      sd_drag_law grain = sphere;
      grain.fall = 0.5;
      const double w = terminal(sphere, 0.75e-3, 1190, 0.8);
      assert_true(fabs(terminal(grain, 1.5e-3, 1190, 0.8) / w - 1.0) < 1e-12);
    }
}

static void every_law_is_stokes_for_slow_spheres(void **state)
{
  (void) state;
  const double stokes = 6 * SD_PI * ETA * 0.003;
  for (int law = SD_DRAG_SCHILLER_NAUMANN; law <= SD_DRAG_FERGUSON_CHURCH; law++)
    for (int many = SD_HINDRANCE_POWER; many <= SD_HINDRANCE_DI_FELICE; many++) {
      const sd_drag_law kind = {.law = (sd_drag_of_one) law, .hindrance = (sd_drag_of_many) many};
      assert_true(fabs(sd_drag_factor(kind, RHO, ETA, 0.003, 1.0, 1e-16) / stokes - 1) < 1e-5);
    }
}

/* n of Richardson & Zaki, Re that of a lone grain */
static double exponent_of(double Re)
{
  return fmin(fmax(4.4 * pow(Re, Re < 1.0 ? -0.03 : -0.1), 2.39), 4.65);
}

/* Grains that fall past water at the slip w have the flux e w through the water: w_0 e^n, n of the
 * lone grain; from Stokes' law to Newton's. */
static void richardson_and_zaki_find_their_exponent(void **state)
{
  (void) state;
  const sd_drag_law law = {.law = SD_DRAG_BROWN_LAWLER, .hindrance = SD_HINDRANCE_RICHARDSON_ZAKI};
  double first = 0.0, last = 0.0;
  for (double d = 3e-5; d < 0.2; d *= 3) {
    const double w0 = terminal(law, 0.5 * d, 2650, 1.0), n = exponent_of(w0 * d * 1e6);
    for (double e = 0.4; e < 1.0; e += 0.1)
      assert_true(fabs(e * terminal(law, 0.5 * d, 2650, e) / (w0 * pow(e, n)) - 1.0) < 1e-9);
    if (first == 0.0) first = n;
    last = n;
  }
  assert_true(first > 4.6 && first <= 4.65 && last == 2.39);
}

/* Lambert's function gives the lone speed that halving finds in y = (1 - n(Re_0)) ln e, Re_0 = Re e^y: to rounding, in
 * dilute and dense beds, from the slow end of n to the fast one and on both sides of its corners. */
static void lone_speeds_solve_richardson_and_zakis_equation(void **state)
{
  (void) state;
  const double a = 0.5, stokes = 0.25 * SD_PI * a;
  double worst = 0.0;
  for (double e = 0.02; e < 1.0; e += 0.013)
    for (double x = -9.0; x < 12.0; x += 0.0137) { /* ln Re */
      const double L = log(e), Re = exp(x);
      double low = -1.3 * L, high = -3.7 * L;
      for (int k = 0; k < 60; k++) {
        const double middle = 0.5 * (low + high);
        *(middle < (1.0 - exponent_of(Re * exp(middle))) * L ? &low : &high) = middle;
      }
      const double y = 0.5 * (low + high);
      for (int law = SD_DRAG_YADE; law <= SD_DRAG_FERGUSON_CHURCH; law++) {
        const sd_drag_law kind = {.law = (sd_drag_of_one) law, .hindrance = SD_HINDRANCE_RICHARDSON_ZAKI};
        const double halved = stokes * sd_drag_number(kind.law, Re * exp(y)) * exp(y);
        worst = fmax(worst, fabs(sd_drag_factor(kind, 1.0, 1.0, a, e, Re) / halved - 1.0));
      }
    }
  printf("    Richardson & Zaki by Lambert's function: largest difference from halving %.1e\n", worst);
  assert_true(worst < 1e-13); /* the rounding of y, up to 18, is one of e^y: 4e-15, and twice that in N */
}

/* A pressure gradient pushes a grain by its volume times that, its share of it if it is a member of a clump; the water
   does not take that back. */
static void a_pressure_gradient_pushes_grains(void **state)
{
  (void) state;
  const double edge[3] = {0, 1, 2}, U[3] = {0, 0.3, 0.3}, hindrance[2] = {1, 1}, a = 0.1, x[3] = {0, 0, 0.5},
               v[3] = {0.1, 0, 0}, weight = 0.7;
  const sd_vans_mesh mesh = {2, 0, 1, edge};
  sd_vans_force_law law = {.rho = RHO, .eta = ETA, .g = {0.2, 0, -G}, .rest = 1};
  const sd_vans_grains grains = {.n = 1, .x = x, .v = v, .a = &a, .weight = &weight};
  double without[3], with[3], drag[2];
  const sd_vans_ambient stream = {&mesh, &law, U, hindrance};
  sd_vans_forces(&stream, &grains, without, drag);
  law.dpdx = -37.0;
  sd_vans_forces(&stream, &grains, with, drag + 1);
  assert_true(fabs((with[0] - without[0]) / (0.7 * 4.0 / 3.0 * SD_PI * a * a * a * 37.0) - 1.0) < 1e-13);
  assert_true(with[1] == without[1] && with[2] == without[2] && drag[0] == drag[1]);
}

/* Di Felice's drag leads to speeds within 7 % of that at phi 0.3, and 27 % at 0.5. */
static void di_felice_agrees_with_richardson_and_zaki(void **state)
{
  (void) state;
  const sd_drag_law rz = {.law = SD_DRAG_BROWN_LAWLER, .hindrance = SD_HINDRANCE_RICHARDSON_ZAKI},
                         di_felice = {.law = SD_DRAG_BROWN_LAWLER, .hindrance = SD_HINDRANCE_DI_FELICE};
  double worst[2] = {0, 0};
  for (double d = 3e-5; d < 0.05; d *= 1.5)
    for (int k = 0; k < 2; k++) {
      const double e = k ? 0.5 : 0.7,
                   ratio = terminal(di_felice, 0.5 * d, 2650, e) / terminal(rz, 0.5 * d, 2650, e);
      worst[k] = fmax(worst[k], fabs(ratio - 1.0));
    }
  printf("    di_felice beside richardson_zaki: %.3f at phi 0.3, %.3f at 0.5\n", worst[0], worst[1]);
  assert_true(worst[0] < 0.07 && worst[1] < 0.27);
}

static void slope_is_that_of_the_force(void **state)
{
  (void) state;
  for (int law = SD_DRAG_YADE; law <= SD_DRAG_FERGUSON_CHURCH; law++)
    for (double w = 1e-6; w < 10; w *= 7) {
      const sd_drag_law kind = {.law = (sd_drag_of_one) law, .hindrance = SD_HINDRANCE_RICHARDSON_ZAKI};
      const double h = 1e-5 * w, e = 0.6, a = 0.002,
                   up = sd_drag_factor(kind, RHO, ETA, a, e, w + h) * (w + h),
                   down = sd_drag_factor(kind, RHO, ETA, a, e, w - h) * (w - h);
      assert_true(fabs(sd_drag_slope(kind, RHO, ETA, a, e, w) / ((up - down) / (2 * h)) - 1) < 2e-3);
    }
}

/* The share of a member is its part in drag and buoyancy; so two spheres at one place are one. */
static void members_push_by_their_share(void **state)
{
  (void) state;
  const double edge[3] = {0, 1, 2}, U[3] = {0, 0.3, 0.3}, hindrance[2] = {1, 1}, a[2] = {0.1, 0.1},
               x[6] = {0, 0, 0.5, 0, 0, 0.5}, v[6] = {0}, weight[2] = {1.0, 0.0};
  const sd_vans_mesh mesh = {2, 0, 1, edge};
  const sd_vans_force_law law = {.rho = RHO, .eta = ETA, .g = {0, 0, -G}};
  double one[3], both[6], drag[2];
  const sd_vans_ambient stream = {&mesh, &law, U, hindrance};
  sd_vans_forces(&stream, &(sd_vans_grains){.n = 1, .x = x, .v = v, .a = a}, one, NULL);
  sd_vans_forces(&stream, &(sd_vans_grains){.n = 2, .x = x, .v = v, .a = a, .weight = weight}, both, drag);
  for (int d = 0; d < 3; d++) assert_true(both[d] + both[3 + d] == one[d]);
  assert_true(drag[0] + drag[1] == one[0] && one[2] > 0.0);
}

/* A core within a shell of a hundred small spheres that do not touch each other loses a hundred caps. */
static void a_core_may_have_any_number_of_neighbours(void **state)
{
  (void) state;
  enum { N = 101 };
  double x[3 * N] = {0}, a[N] = {1.0};
  for (int k = 1; k < N; k++) { /* a spiral of even steps in z */
    const double z = 1.0 - (2.0 * k - 1.0) / (N - 1), turn = 2.399963229728653 * k, r = sqrt(1.0 - z * z);
    x[3 * k] = r * cos(turn);
    x[3 * k + 1] = r * sin(turn);
    x[3 * k + 2] = z;
    a[k] = 0.12;
  }
  const double h = 1.0 - 0.5 * 0.12 * 0.12, cap = SD_PI * (1 - h) * (1 - h) * (2 + h) / 3.0;
  assert_true(fabs(sd_vans_union_share(N, x, a, 0) - (1.0 - 100 * cap * 0.75 / SD_PI)) < 1e-12);
}

/* Water that rises with the mixture's flux carries a grain: the slip counts, not the speed. */
static void rising_water_lifts_a_grain(void **state)
{
  (void) state;
  const double edge[3] = {0, 1, 2}, U[3] = {0}, hindrance[2] = {1, 1}, a = 0.1, x[3] = {0, 0, 1.5},
               still[3] = {0}, falling[3] = {0, 0, -0.7}, up[2] = {0.2, 0.7};
  const sd_vans_mesh mesh = {2, 0, 1, edge};
  sd_vans_force_law law = {.rho = RHO, .eta = ETA, .upward = up, .flux = 0.3};
  double rising[3], fallen[3];
  const sd_vans_ambient stream = {&mesh, &law, U, hindrance};
  sd_vans_forces(&stream, &(sd_vans_grains){.n = 1, .x = x, .v = still, .a = &a}, rising, NULL);
  law.upward = NULL;
  sd_vans_forces(&stream, &(sd_vans_grains){.n = 1, .x = x, .v = falling, .a = &a}, fallen, NULL);
  assert_true(rising[2] > 0.0 && fabs(rising[2] / fallen[2] - 1.0) < 1e-15);
}

/* Where bisection finds it, from sand in glycerine to pebbles in water; without a weight it rests. */
static void fall_speed_balances_weight_and_drag(void **state)
{
  (void) state;
  for (int name = SD_DRAG_YADE; name <= SD_DRAG_FERGUSON_CHURCH; name++)
    for (double a = 1e-6; a < 0.1; a *= 3.1)
      for (int fall = 0; fall < 2; fall++) {
        const sd_drag_law law = {(sd_drag_of_one) name, SD_HINDRANCE_RICHARDSON_ZAKI, 0.7 * fall};
        const double weight = 4.0 / 3.0 * SD_PI * a * a * a * (2650 - RHO) * G;
        CHECK_NEAR(sd_fall_speed(law, RHO, ETA, a, weight) / terminal(law, a, 2650, 1.0), 1.0, 1e-10);
        assert_true(sd_fall_speed(law, RHO, ETA, a, 0.0) == 0.0);
      }
}

/* Added mass is that of the acceleration past the water: of a grain at rest C rho V dU/dt, in its slice, on the surface
 * above the mesh and at rest below it. */
static void water_that_accelerates_pushes_by_the_added_mass(void **state)
{
  (void) state;
  const double U[4] = {0, 0.1, 0.2, 0.3}, rate[4] = {0, 5, -7, 11}, hindrance[3] = {1, 1, 1}, edge[4] = {0, 1, 2, 3},
               x[15] = {0, 0, -0.5, 0, 0, 0.5, 0, 0, 1.5, 0, 0, 2.5, 0, 0, 9}, v[15] = {0}, a[5] = {1, 1, 1, 1, 1},
               felt[5] = {0, 5, -7, 11, 11};
  const sd_vans_mesh mesh = {3, 0, 1, edge};
  sd_vans_force_law law = {.rho = RHO, .eta = ETA, .added_mass = 0.4};
  const sd_vans_ambient stream = {&mesh, &law, U, hindrance};
  const sd_vans_grains grains = {.n = 5, .x = x, .v = v, .a = a};
  double steady[15], F[15], drag[5];
  sd_vans_forces(&stream, &grains, steady, NULL);
  law.rate = rate;
  sd_vans_forces(&stream, &grains, F, drag);
  for (int i = 0; i < 5; i++) {
    const double more = 0.4 * RHO * 4.0 / 3.0 * SD_PI * felt[i];
    assert_true(fabs(F[3 * i] - steady[3 * i] - more) < 1e-9 * RHO && F[3 * i + 2] == steady[3 * i + 2]);
    assert_true(drag[i] == F[3 * i]);
  }
}

/* Steps of velocity Verlet in oil: the speed of a grain of this density after 1500 steps of dt, over that before. */
static double speed_left(double density, double C, double dt)
{
  const double U[3] = {0}, hindrance[2] = {1, 1}, edge[3] = {0, 1, 2}, x[3] = {0.1, 0.2, 0.5}, a = 0.003,
               mass = density * 4.0 / 3.0 * SD_PI * a * a * a;
  const sd_vans_mesh mesh = {2, 0, 1, edge};
  const sd_vans_force_law law = {.rho = RHO, .eta = 0.3, .added_mass = C};
  const sd_vans_ambient stream = {&mesh, &law, U, hindrance};
  double v[3] = {1e-9, 0, 0}, F[3], acceleration[3] = {0};
  sd_vans_motion motion = {{0}, 0};
  sd_vans_motion_begin(&motion, v);
  for (int k = 0; k < 1500; k++) {
    if (k) sd_vans_motion_step(&motion, v, dt, acceleration);
    sd_vans_forces(&stream, &(sd_vans_grains){.n = 1, .x = x, .v = v, .a = &a, .acceleration = acceleration}, F, NULL);
    v[0] += F[0] / mass * dt;
  }
  return fabs(v[0]) / 1e-9;
}

/* What is left of the inertia limits the step, and below C times the water's density there is no step. */
static void added_mass_shortens_the_longest_step(void **state)
{
  (void) state;
  const double U[3] = {0}, hindrance[2] = {1, 1}, edge[3] = {0, 1, 2}, x[3] = {0.1, 0.2, 0.5}, v[3] = {1e-9, 0, 0},
               a = 0.003, density[4] = {2500, 1050, 700, 600};
  const sd_vans_mesh mesh = {2, 0, 1, edge};
  for (int k = 0; k < 8; k++) {
    const sd_vans_force_law law = {.rho = RHO, .eta = 0.3, .added_mass = k < 4 ? 0.5 : 0.0};
    const sd_vans_ambient stream = {&mesh, &law, U, hindrance};
    const double mass = density[k % 4] * 4.0 / 3.0 * SD_PI * a * a * a;
    int which = -1;
    const double rate = sd_vans_stiffest(&stream, &(sd_vans_grains){.n = 1, .x = x, .v = v, .a = &a}, &mass, &which);
    assert_int_equal(which, 0);
    assert_true(speed_left(density[k % 4], law.added_mass, 1.95 / rate) < 1.0);
    assert_false(speed_left(density[k % 4], law.added_mass, 2.05 / rate) < 1.0);
  }
  const double light = 490 * 4.0 / 3.0 * SD_PI * a * a * a;
  const sd_vans_force_law law = {.rho = RHO, .eta = 0.3, .added_mass = 0.5};
  const sd_vans_ambient stream = {&mesh, &law, U, hindrance};
  int which = -1;
  assert_true(isinf(
      sd_vans_stiffest(&stream, &(sd_vans_grains){.n = 1, .x = x, .v = v, .a = &a}, &light, &which)));
}

/* ten Cate et al. 2002: a sphere of 15 mm, 1120 kg/m3, in four oils, Re 1.5 to 32. Their fits by Clift & Gauvin,
 * 0.0409 0.0635 0.0939 0.1289 m/s, are those of brown_lawler to 1 %; the default law is for larger Re. */
static void a_sphere_falls_in_oil_as_measured(void **state)
{
  (void) state;
  const double rho[4] = {970.0, 965.0, 962.0, 960.0}, eta[4] = {0.373, 0.212, 0.113, 0.058},
               fall[4] = {0.0409, 0.0635, 0.0939, 0.1289}, a = 0.0075;
  const sd_drag_law spheres = {.law = SD_DRAG_BROWN_LAWLER}, yade = {0};
  for (int k = 0; k < 4; k++) {
    const double weight = 4.0 / 3.0 * SD_PI * a * a * a * (1120.0 - rho[k]) * 9.81;
    CHECK_NEAR(sd_fall_speed(spheres, rho[k], eta[k], a, weight) / fall[k], 1.0, 0.011);
    assert_true(sd_fall_speed(yade, rho[k], eta[k], a, weight) > 1.14 * fall[k]);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(spheres_fall_as_measured),
      cmocka_unit_test(sand_falls_by_ferguson_and_church),
      cmocka_unit_test(a_grain_falls_as_the_sphere_of_its_fall_diameter),
      cmocka_unit_test(every_law_is_stokes_for_slow_spheres),
      cmocka_unit_test(richardson_and_zaki_find_their_exponent),
      cmocka_unit_test(lone_speeds_solve_richardson_and_zakis_equation),
      cmocka_unit_test(a_pressure_gradient_pushes_grains),
      cmocka_unit_test(di_felice_agrees_with_richardson_and_zaki),
      cmocka_unit_test(slope_is_that_of_the_force),
      cmocka_unit_test(members_push_by_their_share),
      cmocka_unit_test(a_core_may_have_any_number_of_neighbours),
      cmocka_unit_test(rising_water_lifts_a_grain),
      cmocka_unit_test(fall_speed_balances_weight_and_drag),
      cmocka_unit_test(water_that_accelerates_pushes_by_the_added_mass),
      cmocka_unit_test(added_mass_shortens_the_longest_step),
      cmocka_unit_test(a_sphere_falls_in_oil_as_measured),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
