/* The engine ewald where an engine may go wrong. */
#include "periodic.h"

#include "plain.h"

enum { MOST = 400 };

static const sd_ewald_box cube = {.periodic = 1, .origin = {1, 2, 3}, .edge = {10, 10, 10}};

static void nobody_and_spheres_without_radius(void **state)
{
  (void) state;
  const double x[6] = {2, 3, 4, 5, 6, 7}, a[2] = {0.0, 0.0}, F[6] = {1, 2, 3, NAN, 5, 6};
  for (int n = 0; n <= 2; n += 2)
    for (int open = 0; open < 2; open++) {
      sd_ewald_box box = cube;
      box.periodic = !open;
      const sd_ewald how = periodic_choose(&box, a, n, 3, 1e-3);
      assert_true(how.count == 0.0 && how.reach == 0.0);
      periodic p;
      double u[6] = {9, 9, 9, 9, 9, 9};
      periodic_place(&p, x, a, NULL, n, 3, &how);
      assert_int_equal(sd_mobility_apply(&p.omega, F, u), SD_OK);
      for (int i = 0; i < 3 * n; i++) CHECK_NEAR(u[i], 0.0, 0.0);
      periodic_free(&p);
    }
}

/* One sphere in a large box: 1 - 1.7601188842 (phi)^(1/3) + phi, the rest of which is exact for this model (Hasimoto
   1959). */
static void one_sphere_has_hasimotos_correction(void **state)
{
  (void) state;
  const double x[3] = {4, 4, 4}, a = 0.7, F[3] = {0, 6.0 * SD_PI * 0.7, 0};
  const sd_ewald how = periodic_choose(&cube, &a, 1, 3, 1e-10);
  periodic p;
  double u[3];
  periodic_place(&p, x, &a, NULL, 1, 3, &how);
  periodic_apply(&p, F, u);
  const double phi = 4.0 / 3.0 * SD_PI * a * a * a / 1000.0;
  CHECK_NEAR(u[1], 1.0 - 1.7601188842 * cbrt(phi) + phi, 1e-9);
  CHECK_NEAR(u[0], 0.0, 1e-12);
  periodic_free(&p);
}

/* Alone in an open box nothing is felt: wave part and its own D(0) cancel. */
static void one_sphere_in_an_open_box_feels_nothing(void **state)
{
  (void) state;
  const double x[3] = {4, 4, 4}, a = 0.7, w = 1.0, F[3] = {1, 2, 3};
  sd_ewald_box box = {0};
  sd_ewald_box_around(&box, -1, x, x, a);
  const sd_ewald_sizes sizes = periodic_sizes(&a, 1);
  sd_ewald how;
  assert_int_equal(sd_ewald_choose(&box, &sizes, 3, 1e-9, &how), SD_OK);
  const sd_mobility_scene scene = {.how = {.width = 3, .ewald = &how}, .n = 1, .n_all = 1, .spheres = {x, &a, &w}};
  sd_mobility m = {0};
  double u[3];
  assert_int_equal(sd_mobility_place(&m, &sd_mobility_ewald, &scene), SD_OK);
  assert_int_equal(sd_mobility_apply(&m, F, u), SD_OK);
  for (int d = 0; d < 3; d++) CHECK_NEAR(u[d], 0.0, 1e-9 * F[d] / (6.0 * SD_PI * a));
  sd_mobility_free(&m);
}

/* u = M F by a loose and by a tight sum */
static void agrees_with_a_tighter_sum(const double *x, const double *a, int n, int width,
                                      const sd_ewald_box *box, double tolerance)
{
  uint64_t seed = 6;
  double F[6 * MOST], u[6 * MOST], v[6 * MOST], off = 0.0, scale = 0.0;
  for (int i = 0; i < n; i++)
    for (int d = 0; d < width; d++) F[width * i + d] = uniform(&seed, -1, 1) * pow(a[i], d < 3 ? 1 : 3);
  for (int tight = 0; tight < 2; tight++) {
    const sd_ewald how = periodic_choose(box, a, n, width, tight ? 1e-4 * tolerance : tolerance);
    periodic p;
    periodic_place(&p, x, a, NULL, n, width, &how);
    periodic_apply(&p, F, tight ? v : u);
    periodic_free(&p);
  }
  for (int i = 0; i < n; i++)
    for (int d = 0; d < width; d++) {
      assert_true(isfinite(u[width * i + d]));
      const double own = d < 3 ? 6.0 * SD_PI * a[i] : 8.0 * SD_PI * pow(a[i], 3);
      off += pow((u[width * i + d] - v[width * i + d]) * (d < 3 ? 1.0 : a[i]), 2);
      scale += pow(F[width * i + d] / own * (d < 3 ? 1.0 : a[i]), 2);
    }
  assert_true(sqrt(off / scale) < tolerance);
}

static void spheres_at_one_point_and_larger_than_the_box(void **state)
{
  (void) state;
  const double x[12] = {4, 4, 4, 4, 4, 4, 4.3, 4, 4, 9, 9, 9}, together[4] = {1, 1, 0.5, 2}, huge[4] = {1, 0.5, 7, 2};
  for (double tolerance = 1e-2; tolerance > 1e-8; tolerance *= 1e-2) {
    agrees_with_a_tighter_sum(x, together, 4, 6, &cube, tolerance);
    agrees_with_a_tighter_sum(x, huge, 4, 6, &cube, tolerance);
  }
}

/* No wave across it is kept. */
static void a_box_as_thin_as_its_spheres(void **state)
{
  (void) state;
  uint64_t seed = 5;
  double x[3 * MOST], a[MOST];
  for (double thick = 2.0; thick < 2.4; thick += 0.1) {
    const sd_ewald_box box = {.periodic = 1, .edge = {60, 47, thick}};
    for (int i = 0; i < MOST; i++) a[i] = 1.0;
    for (int i = 0; i < 3 * MOST; i++) x[i] = uniform(&seed, 0, 1) * box.edge[i % 3];
    for (int width = 3; width <= 6; width += 3) {
      agrees_with_a_tighter_sum(x, a, MOST, width, &box, 0.1);
      agrees_with_a_tighter_sum(x, a, MOST, width, &box, 1e-2);
    }
  }
}

/* One level of splitting is right for radii 1 : 100 as well. */
static void radii_of_one_to_a_hundred(void **state)
{
  (void) state;
  uint64_t seed = 5;
  const sd_ewald_box box = {.periodic = 1, .edge = {700, 600, 650}};
  double x[3 * MOST], a[MOST];
  for (int i = 0; i < MOST; i++) {
    for (int d = 0; d < 3; d++) x[3 * i + d] = uniform(&seed, 0, 1) * box.edge[d];
    a[i] = i == 0 ? 100.0 : exp(uniform(&seed, 0.0, log(100.0)));
  }
  agrees_with_a_tighter_sum(x, a, MOST, 6, &box, 1e-3);
  agrees_with_a_tighter_sum(x, a, MOST, 6, &box, 1e-6);
}

/* A cloud in one corner of an open box, and one sphere far away: cells that hold nobody are not made. */
static void a_cloud_in_a_corner(void **state)
{
  (void) state;
  uint64_t seed = 5;
  static double x[3 * MOST], a[MOST], w[MOST], F[3 * MOST], u[3 * MOST], v[3 * MOST];
  double lo[3] = {0, 0, 0}, hi[3] = {0, 0, 0};
  for (int i = 0; i < MOST; i++) {
    for (int d = 0; d < 3; d++) {
      x[3 * i + d] = i == 0 ? 300.0 : uniform(&seed, 0, 20);
      hi[d] = fmax(hi[d], x[3 * i + d]);
      F[3 * i + d] = uniform(&seed, -1, 1);
    }
    a[i] = w[i] = 1.0;
  }
  sd_ewald_box box = {0};
  sd_ewald_box_around(&box, -1, lo, hi, 1.0);
  const sd_ewald_sizes sizes = periodic_sizes(a, MOST);
  const sd_law law = {.tensor = SD_TENSOR_RPY};
  const sd_spheres spheres = {x, a, w};
  sd_ewald how;
  assert_int_equal(sd_ewald_choose(&box, &sizes, 3, 1e-5, &how), SD_OK);
  const sd_mobility_scene scene = {.how = {.width = 3, .ewald = &how}, .n = MOST, .n_all = MOST, .spheres = spheres};
  sd_mobility m = {0};
  assert_int_equal(sd_mobility_place(&m, &sd_mobility_ewald, &scene), SD_OK);
  assert_int_equal(sd_mobility_apply(&m, F, u), SD_OK);
  plain_all(&law, &spheres, MOST, 3, F, v);
  double off = 0.0;
  for (int i = 0; i < 3 * MOST; i++) off += pow(6.0 * SD_PI * (u[i] - v[i]), 2) / (3 * MOST);
  assert_true(sqrt(off) < 1e-5);
  sd_mobility_free(&m);
}

/* One engine goes through boxes that shrink and tilt, as in a run with fix deform: as if made anew each time. */
static void a_box_that_changes(void **state)
{
  (void) state;
  uint64_t seed = 5;
  enum { N = 40 };
  double x[3 * N], a[N], F[3 * N], u[3 * N], v[3 * N];
  sd_mobility lasting = {0};
  for (int i = 0; i < N; i++) a[i] = uniform(&seed, 0.5, 1.0);
  for (int i = 0; i < 3 * N; i++) F[i] = uniform(&seed, -1, 1);
  for (int step = 0; step < 4; step++) {
    sd_ewald_box box = cube;
    for (int d = 0; d < 3; d++) box.edge[d] -= step;
    box.tilt[0] = 0.8 * step;
    for (int i = 0; i < 3 * N; i++) x[i] = box.origin[i % 3] + uniform(&seed, 0, 1) * box.edge[i % 3];
    const sd_ewald how = periodic_choose(&box, a, N, 3, 1e-6);
    periodic p;
    periodic_place(&p, x, a, NULL, N, 3, &how);
    assert_int_equal(sd_mobility_apply(&p.omega, F, u), SD_OK);
    const sd_mobility_scene scene = {.how = {.width = 3, .ewald = &how}, .n = N, .n_all = p.n_all,
                                     .spheres = {p.x, p.a, p.w},
                                     .world = {.ctx = &p, .refresh = periodic_refresh}};
    assert_int_equal(sd_mobility_place(&lasting, &sd_mobility_ewald, &scene), SD_OK);
    assert_int_equal(sd_mobility_apply(&lasting, F, v), SD_OK);
    for (int i = 0; i < 3 * N; i++) CHECK_NEAR(v[i], u[i], 0.0);
    periodic_free(&p);
  }
  sd_mobility_free(&lasting);
}

/* Rows with torques are wider: what was made for forces alone has no room for them (address sanitizer, valgrind). */
static void torques_after_forces(void **state)
{
  (void) state;
  uint64_t seed = 8;
  enum { N = 60 };
  double x[3 * N], a[N], F[6 * N], u[6 * N], v[6 * N];
  sd_mobility lasting = {0};
  for (int i = 0; i < 3 * N; i++) x[i] = cube.origin[i % 3] + uniform(&seed, 0, 10);
  for (int i = 0; i < N; i++) a[i] = uniform(&seed, 0.5, 1.0);
  for (int i = 0; i < 6 * N; i++) F[i] = uniform(&seed, -1, 1);
  for (int width = 3; width <= 6; width += 3) {
    const sd_ewald how = periodic_choose(&cube, a, N, width, 1e-6);
    periodic p;
    periodic_place(&p, x, a, NULL, N, width, &how);
    assert_int_equal(sd_mobility_apply(&p.omega, F, u), SD_OK);
    const sd_mobility_scene scene = {.how = {.width = width, .ewald = &how}, .n = N, .n_all = p.n_all,
                                     .spheres = {p.x, p.a, p.w}, .world = {.ctx = &p, .refresh = periodic_refresh}};
    assert_int_equal(sd_mobility_place(&lasting, &sd_mobility_ewald, &scene), SD_OK);
    assert_int_equal(sd_mobility_apply(&lasting, F, v), SD_OK);
    for (int i = 0; i < width * N; i++) CHECK_NEAR(v[i], u[i], 0.0);
    periodic_free(&p);
  }
  sd_mobility_free(&lasting);
}

static void what_cannot_be_is_refused(void **state)
{
  (void) state;
  const double a[2] = {1, 2};
  const sd_ewald_sizes sizes = periodic_sizes(a, 2);
  sd_ewald how;
  sd_ewald_box box = cube;
  box.edge[1] = 0.0;
  assert_int_equal(sd_ewald_choose(&box, &sizes, 3, 1e-3, &how), SD_ENOTFINITE);
  box.edge[1] = NAN;
  assert_int_equal(sd_ewald_choose(&box, &sizes, 3, 1e-3, &how), SD_ENOTFINITE);
  assert_int_equal(sd_ewald_choose(&cube, &sizes, 3, 0.0, &how), SD_ENOTFINITE);
  assert_int_equal(sd_ewald_choose(&cube, &sizes, 3, NAN, &how), SD_ENOTFINITE);
  box.edge[1] = 1e300;
  assert_true(sd_ewald_choose(&box, &sizes, 3, 1e-3, &how) != SD_OK);
  box = cube;
  box.edge[0] = box.edge[1] = box.edge[2] = 1e9; /* two small spheres need no fine grid */
  assert_int_equal(sd_ewald_choose(&box, &sizes, 3, 1e-3, &how), SD_OK);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(nobody_and_spheres_without_radius),
      cmocka_unit_test(one_sphere_has_hasimotos_correction),
      cmocka_unit_test(one_sphere_in_an_open_box_feels_nothing),
      cmocka_unit_test(spheres_at_one_point_and_larger_than_the_box),
      cmocka_unit_test(a_box_as_thin_as_its_spheres),
      cmocka_unit_test(radii_of_one_to_a_hundred),
      cmocka_unit_test(a_cloud_in_a_corner),
      cmocka_unit_test(a_box_that_changes),
      cmocka_unit_test(torques_after_forces),
      cmocka_unit_test(what_cannot_be_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
