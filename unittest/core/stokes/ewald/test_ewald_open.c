/* The engine ewald in open boxes against the sum over all pairs. */
#include "periodic.h"

#include "plain.h"

#include "sd_ewald_cost.h"

enum { N = 150 };

typedef struct {
  const char *what;
  double edge[3], largest;
  int width;
} cloud;

static const cloud clouds[] = {
    {"equal", {14, 12, 16}, 1.0, 3},           {"1 : 3", {30, 24, 28}, 3.0, 6},
    {"1 : 10", {60, 70, 66}, 10.0, 3},         {"1 : 10 with torques", {60, 70, 66}, 10.0, 6},
    {"box 8 : 1 : 1", {80, 10, 10}, 1.0, 6},   {"flat", {40, 0, 30}, 1.5, 3},
    {"equal, torques", {14, 12, 16}, 1.0, 6},  {"box 1 : 1 : 100", {4, 4, 400}, 1.0, 3},
};
enum { CLOUDS = sizeof(clouds) / sizeof(clouds[0]) };

typedef struct {
  double x[3 * N], a[N], w[N], F[6 * N];
  sd_ewald_box box;
} scene;

static scene make(const cloud *c, uint64_t seed)
{
  scene s = {0};
  double lo[3], hi[3];
  for (int d = 0; d < 3; d++) lo[d] = INFINITY, hi[d] = -INFINITY;
  for (int i = 0; i < N; i++) {
    for (int d = 0; d < 3; d++) {
      s.x[3 * i + d] = uniform(&seed, 3.0, 3.0 + c->edge[d]);
      lo[d] = fmin(lo[d], s.x[3 * i + d]);
      hi[d] = fmax(hi[d], s.x[3 * i + d]);
    }
    s.a[i] = c->largest == 1.0 ? 1.0 : exp(uniform(&seed, 0.0, log(c->largest)));
    s.w[i] = uniform(&seed, 0.6, 1.4);
    for (int d = 0; d < c->width; d++)
      s.F[c->width * i + d] = uniform(&seed, -1, 1) * (d < 3 ? s.a[i] : s.a[i] * s.a[i]);
  }
  assert_int_equal(sd_ewald_box_around(&s.box, -1, lo, hi, c->largest), 1);
  assert_int_equal(sd_ewald_box_around(&s.box, -1, lo, hi, c->largest), 0);
  return s;
}

/* Over rms of F/(6 pi a), and of T/(8 pi a^3) */
static double error_of(const scene *s, int width, const double *u, const double *expected)
{
  double worst = 0.0;
  for (int from = 0; from < width; from += 3) {
    double off = 0.0, scale = 0.0;
    for (int i = 0; i < N; i++)
      for (int d = from; d < from + 3; d++) {
        const double own = from == 0 ? 6.0 * SD_PI * s->a[i] : 8.0 * SD_PI * pow(s->a[i], 3);
        off += pow(u[width * i + d] - expected[width * i + d], 2);
        scale += pow(s->w[i] * s->w[i] * s->F[width * i + d] / own, 2);
      }
    worst = fmax(worst, sqrt(off / scale));
  }
  return worst;
}

static void open_boxes_agree_with_all_pairs(void **state)
{
  (void) state;
  for (int k = 0; k < CLOUDS; k++) {
    const cloud *c = clouds + k;
    const scene s = make(c, 7 + k);
    const sd_law law = {.tensor = SD_TENSOR_RPY};
    const sd_spheres spheres = {s.x, s.a, s.w};
    double expected[6 * N], u[6 * N];
    plain_all(&law, &spheres, N, c->width, s.F, expected);
    for (int digits = 3; digits <= CHECK_SIZE(12, 9); digits += CHECK_SIZE(3, 6)) {
      const sd_ewald_sizes sizes = periodic_sizes(s.a, N);
      sd_ewald how;
      assert_int_equal(sd_ewald_choose(&s.box, &sizes, c->width, pow(10.0, -digits), &how), SD_OK);
      const sd_mobility_scene scene = {.how = {.width = c->width, .ewald = &how}, .n = N, .n_all = N,
                                       .spheres = spheres};
      sd_mobility m = {0};
      assert_int_equal(sd_mobility_place(&m, &sd_mobility_ewald, &scene), SD_OK);
      assert_int_equal(sd_mobility_apply(&m, s.F, u), SD_OK);
      const double error = error_of(&s, c->width, u, expected);
      assert_true(error < pow(10.0, -digits));
      sd_mobility_free(&m);
    }
  }
}

/* Equal forces: the cloud is far faster than F/(6 pi a), and so is the error; the tolerance holds for its
   velocities. */
static void a_cloud_that_settles_has_the_right_velocities(void **state)
{
  (void) state;
  for (int n = 1000; n <= CHECK_SIZE(8000, 1000); n *= 8) {
    const size_t count = 3 * (size_t) n;
    const double edge = cbrt(4.0 / 3.0 * SD_PI * n / 0.2), lo[3] = {0.0}, hi[3] = {edge, edge, edge};
    double *x = malloc(8 * count), *a = malloc(8 * count), *F = malloc(8 * count);
    double *u = malloc(8 * count), *exact = malloc(8 * count);
    uint64_t seed = 5;
    for (int i = 0; i < 3 * n; i++) x[i] = uniform(&seed, 0, edge), F[i] = 6.0 * SD_PI * (i % 3 == 2), a[i] = 1.0;
    sd_ewald_box box = {0};
    sd_mobility_scene scene = {.how = {.width = 3}, .n = n, .n_all = n, .spheres = {x, a, a}};
    sd_mobility m = {0};
    assert_int_equal(sd_ewald_box_around(&box, -1, lo, hi, 1.0), 1);
    assert_int_equal(sd_mobility_place(&m, &sd_mobility_all_pairs, &scene), SD_OK);
    assert_int_equal(sd_mobility_apply(&m, F, exact), SD_OK);
    sd_mobility_free(&m);
    for (int digits = 2; digits <= 8; digits += CHECK_SIZE(1, 3)) {
      const sd_ewald_sizes sizes = periodic_sizes(a, n);
      double off = 0.0, speed = 0.0;
      sd_ewald how;
      assert_int_equal(sd_ewald_choose(&box, &sizes, 3, pow(10.0, -digits), &how), SD_OK);
      scene.how.ewald = &how;
      assert_int_equal(sd_mobility_place(&m, &sd_mobility_ewald, &scene), SD_OK);
      assert_int_equal(sd_mobility_apply(&m, F, u), SD_OK);
      sd_mobility_free(&m);
      for (int i = 0; i < 3 * n; i++) off += pow(u[i] - exact[i], 2) / n, speed += pow(exact[i], 2) / n;
      off = sqrt(off) * pow(10.0, digits);
      if (getenv("STOKESDYN_SHOW"))
        printf("%d spheres, 1e-%d: %.1f tolerances over F/(6 pi a), %.2f over their velocities\n", n, digits, off,
               off / sqrt(speed));
      assert_true(off < 0.3 * sqrt(speed));
    }
    free(x), free(F), free(u), free(exact), free(a);
  }
}

/* The box goes along, its tables stay, and so does the answer, but for rounding. */
static void a_cloud_that_moves_as_a_whole_keeps_its_tables(void **state)
{
  (void) state;
  const cloud *c = clouds + 3;
  scene s = make(c, 7);
  const double by[3] = {-310.7, 0.0, 1234.5};
  const sd_ewald_sizes sizes = periodic_sizes(s.a, N);
  double u[2][6 * N], lo[3], hi[3];
  sd_ewald how[2];
  sd_mobility m = {0};
  for (int k = 0; k < 2; k++) {
    assert_int_equal(sd_ewald_choose(&s.box, &sizes, c->width, 0.9e-5, how + k), SD_OK);
    const sd_mobility_scene scene = {.how = {.width = c->width, .ewald = how + k}, .n = N, .n_all = N,
                                     .spheres = {s.x, s.a, s.w}};
    assert_int_equal(sd_mobility_place(&m, &sd_mobility_ewald, &scene), SD_OK);
    assert_int_equal(sd_mobility_apply(&m, s.F, u[k]), SD_OK);
    for (int d = 0; d < 3; d++) lo[d] = INFINITY, hi[d] = -INFINITY;
    for (int i = 0; i < 3 * N; i++) {
      s.x[i] += by[i % 3];
      lo[i % 3] = fmin(lo[i % 3], s.x[i]);
      hi[i % 3] = fmax(hi[i % 3], s.x[i]);
    }
    assert_int_equal(sd_ewald_box_around(&s.box, -1, lo, hi, c->largest), 0);
  }
  assert_true(sd_ewald_same_tables(how, how + 1));
  assert_true(error_of(&s, c->width, u[1], u[0]) < 1e-11);
  sd_mobility_free(&m);
}

/* The wall does not go along: the box stays at its height as long as it holds the cloud. */
static void a_box_above_a_wall_goes_along_it_alone(void **state)
{
  (void) state;
  sd_ewald_box box = {0};
  const double lo[2][3] = {{0, 0, 2}, {30, -7, 2.5}}, hi[2][3] = {{10, 8, 9}, {40, 1, 9.5}};
  assert_int_equal(sd_ewald_box_around(&box, 2, lo[0], hi[0], 1.0), 1);
  const sd_ewald_box first = box;
  assert_int_equal(sd_ewald_box_around(&box, 2, lo[1], hi[1], 1.0), 0);
  assert_true(fabs(box.origin[0] - first.origin[0] - 30.0) < 1e-12 &&
              fabs(box.origin[1] - first.origin[1] + 7.0) < 1e-12);
  assert_true(box.origin[2] == first.origin[2]);
  sd_ewald how[3] = {{.box = first, .images.wall = {.sign = 1, .axis = 2}},
                     {.box = box, .images.wall = {.sign = 1, .axis = 2}}};
  assert_true(sd_ewald_same_tables(how, how + 1));
  how[2] = how[1];
  how[2].box.origin[2] += 0.1;
  assert_false(sd_ewald_same_tables(how, how + 2));
  const double high[3] = {40, 1, 30};
  assert_int_equal(sd_ewald_box_around(&box, 2, lo[1], high, 1.0), 1);
}

/* At any tolerance, with radii to 1 : 3 on two levels too */
static void few_spheres_cost_more_than_all_pairs(void **state)
{
  (void) state;
  const double all_pairs = (double) SD_EWALD_FEWEST * SD_EWALD_FEWEST;
  double a[SD_EWALD_FEWEST];
  for (int largest = 1; largest <= 3; largest += 2)
    for (int digits = 1; digits <= 13; digits++) {
      const double edge = 5.0 * largest;
      const sd_ewald_box box = {.edge = {edge, edge, edge}};
      sd_ewald how;
      sd_ewald_level second;
      for (int i = 0; i < SD_EWALD_FEWEST; i++) a[i] = i % 20 ? 1.0 : largest;
      const sd_ewald_sizes sizes = periodic_sizes(a, SD_EWALD_FEWEST);
      if (sd_ewald_levels_choose(&box, &sizes, 3, pow(10.0, -digits), &how, &second) == SD_OK)
        assert_true(sd_ewald_levels_cost(&how, &second) > all_pairs);
    }
}

/* That of an open box around equal spheres at a volume fraction of 0.2 */
static sd_ewald splitting_of(double n, double tolerance)
{
  const double edge = cbrt(n * 4.0 / 3.0 * SD_PI / 0.2);
  const sd_ewald_box box = {.edge = {edge, edge, edge}};
  const sd_ewald_sizes sizes = {.all = {n, n, n, 1.0}};
  sd_ewald how;
  assert_int_equal(sd_ewald_choose(&box, &sizes, 3, tolerance, &how), SD_OK);
  return how;
}

/* 10^5 spheres. As Gaussians waves had 100 points a side and a range of 15.5. */
static void waves_end_at_a_band(void **state)
{
  (void) state;
  const sd_ewald how = splitting_of(1e5, 3e-7);
  assert_true(how.band > 0.0 && how.grid[0] <= 84 && how.range < 14.0);
}

/* Equal forces move all spheres of an open box together, the faster the more there are: windows mistake none of it. */
static void many_spheres_take_no_wider_windows(void **state)
{
  (void) state;
  for (double n = 1e3; n <= 1e7; n *= 10.0) assert_int_equal(splitting_of(n, 1e-3).points, 5);
}

/* Rounding of floats is a part of the common flow. */
static void common_flow_takes_doubles(void **state)
{
  (void) state;
  for (int digits = 3; digits <= 5; digits++)
    assert_int_equal(splitting_of(5000, pow(10.0, -digits)).single, digits < 5);
}

/* Velocities are 110 F/(6 pi a) here. Errors were 3.9 to 7.2 tolerances, by windows that mistook a constant flow and
 * by what the range cuts off, and are below 0.8. */
static void equal_forces_keep_the_tolerance(void **state)
{
  (void) state;
  enum { M = 1500 };
  static double x[3 * M], a[M], F[3 * M], u[3 * M], v[3 * M];
  const double edge = cbrt(M * 4.0 / 3.0 * SD_PI / 0.2), tolerance[] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6};
  const sd_ewald_box box = {.edge = {edge, edge, edge}};
  const sd_law law = {.tensor = SD_TENSOR_RPY};
  uint64_t seed = 5;
  for (int i = 0; i < 3 * M; i++) x[i] = uniform(&seed, 0, edge), F[i] = 6.0 * SD_PI * (i % 3 == 0);
  for (int i = 0; i < M; i++) a[i] = 1.0;
  sd_mobility_scene s = {.how = {.law = law, .width = 3}, .n = M, .n_all = M, .spheres = {x, a, a}};
  sd_mobility pairs = {0};
  assert_int_equal(sd_mobility_place(&pairs, &sd_mobility_all_pairs, &s), SD_OK);
  assert_int_equal(sd_mobility_apply(&pairs, F, v), SD_OK);
  sd_mobility_free(&pairs);
  for (int k = 0; k < 5; k++) {
    const sd_ewald how = periodic_choose(&box, a, M, 3, tolerance[k]);
    sd_mobility sums = {0};
    double off = 0.0;
    s.how.ewald = &how;
    assert_int_equal(sd_mobility_place(&sums, &sd_mobility_ewald, &s), SD_OK);
    assert_int_equal(sd_mobility_apply(&sums, F, u), SD_OK);
    sd_mobility_free(&sums);
    for (int i = 0; i < 3 * M; i++) off += pow(u[i] - v[i], 2) / M;
    if (getenv("STOKESDYN_SHOW")) printf("%g: %.2f\n", tolerance[k], sqrt(off) / tolerance[k]);
    assert_true(sqrt(off) < tolerance[k]);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(open_boxes_agree_with_all_pairs),
      cmocka_unit_test(a_cloud_that_settles_has_the_right_velocities),
      cmocka_unit_test(a_cloud_that_moves_as_a_whole_keeps_its_tables),
      cmocka_unit_test(a_box_above_a_wall_goes_along_it_alone),
      cmocka_unit_test(few_spheres_cost_more_than_all_pairs),
      cmocka_unit_test(waves_end_at_a_band),
      cmocka_unit_test(many_spheres_take_no_wider_windows),
      cmocka_unit_test(common_flow_takes_doubles),
      cmocka_unit_test(equal_forces_keep_the_tolerance),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
