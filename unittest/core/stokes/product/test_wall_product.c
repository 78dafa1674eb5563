/* The product above a wall: against a table, against the blocks of sd_wall.h, for every instruction
 * set, and where it must be the product without wall. */
#include "scene.h"
#include "table.h"

#include "sd_linear.h"

static const sd_isa isas[] = {SD_ISA_BEST, SD_ISA_PLAIN, SD_ISA_BASELINE, SD_ISA_AVX2,
                              SD_ISA_AVX512};

/* u [width n] of all pairs and the diagonal */
static void whole(const sd_law *law, const scene *s, sd_isa isa, int width, const double *F,
                  double *u)
{
  const sd_spheres spheres = {s->x, s->a, s->w};
  sd_packed p = {0};
  assert_int_equal(sd_packed_all(&p, isa, law, &spheres, s->n, width), SD_OK);
  sd_packed_share(&p, 0, 1, F, u);
  sd_packed_free(&p);
  for (long i = 0; i < s->n; i++)
    for (int k = 0; k < width; k++)
      u[width * i + k] += F[width * i + k] /
          (k < 3 ? s->drag[i] : 4.0 / 3.0 * s->drag[i] * s->a[i] * s->a[i]);
}

/* Scenes of another code, overlapping, touching, clamped, radii to 1:100 */
static void scenes_are_those_of_another_code(void **state)
{
  (void) state;
  const sd_law law = {.tensor = SD_TENSOR_RPY, .wall = {2, 1, 0.0}};
  table t = table_open("walls/scenes.csv");
  char name[100] = "";
  int more = 1, n = 0, scenes = 0;
  double x[60], a[20], F[120], expected[120], u[120];
  while (more) {
    more = table_next(&t);
    if (n > 0 && (!more || strcmp(name, t.column[0]))) {
      scene s = scene_create(n);
      for (int i = 0; i < n; i++)
        scene_set(&s, i, x[3 * i], x[3 * i + 1], x[3 * i + 2], a[i], 1.0);
      for (size_t k = 0; k < sizeof(isas) / sizeof(isas[0]); k++) {
        if (!sd_isa_supported(isas[k])) continue;
        whole(&law, &s, isas[k], 6, F, u);
        double worst = 0.0, largest[2] = {0.0, 0.0};
        for (int j = 0; j < 6 * n; j++)
          largest[j % 6 / 3] = fmax(largest[j % 6 / 3], fabs(expected[j]));
        for (int j = 0; j < 6 * n; j++)
          worst = fmax(worst, fabs(u[j] - expected[j]) / largest[j % 6 / 3]);
        if (!(worst < 1e-12)) fail_msg("%s, %s: off by %.2g", name, isa_name(isas[k]), worst);
      }
      scene_free(&s);
      scenes++;
      n = 0;
    }
    if (!more) break;
    snprintf(name, sizeof name, "%s", t.column[0]);
    for (int d = 0; d < 3; d++) x[3 * n + d] = table_number(&t, 3 + d);
    a[n] = table_number(&t, 6);
    for (int d = 0; d < 6; d++) F[6 * n + d] = table_number(&t, 7 + d);
    for (int d = 0; d < 6; d++) expected[6 * n + d] = table_number(&t, 13 + d);
    n++;
  }
  assert_true(scenes >= 5);
}

/* Spheres of radii 1:10 above the wall, some cutting it, at one of its sides; two viscosities */
static scene above(const sd_wall *wall, int n, uint64_t seed)
{
  scene s = scene_create(n);
  for (int i = 0; i < n; i++) {
    const double a = exp(uniform(&seed, log(0.2), log(2.0)));
    double x[3] = {uniform(&seed, 0, 9), uniform(&seed, 0, 9), uniform(&seed, 0, 9)};
    x[wall->axis] = wall->at + wall->sign * (a * 0.8 + (i % 3 ? uniform(&seed, 0.0, 5.0) : 0.0));
    scene_set(&s, i, x[0], x[1], x[2], a, i % 2 ? 1.3 : 0.4);
  }
  s.a[5] = s.w[5] = s.drag[5] = 0.0; /* takes no part */
  return s;
}

/* Sum of free and image blocks at clamped heights */
static void by_blocks(const sd_law *law, const scene *s, int width, const double *F, double *u)
{
  const sd_wall *wall = &law->wall;
  for (int j = 0; j < width * s->n; j++) u[j] = 0.0;
  for (int i = 0; i < s->n; i++)
    for (int j = 0; j < s->n; j++) {
      double M[36], image[36], x[2][3], r[3];
      const int of[2] = {i, j};
      if (s->a[i] == 0.0 || s->a[j] == 0.0) continue;
      for (int k = 0; k < 2; k++) {
        memcpy(x[k], s->x + 3 * of[k], sizeof x[k]);
        x[k][wall->axis] =
            wall->at + wall->sign * fmax(sd_wall_height(wall, x[k]), s->a[of[k]]);
      }
      sd_minus(x[0], x[1], r);
      const double eta = 1.0 / (s->w[i] * s->w[j]), t = sd_taper_factor(law, sqrt(sd_dot(r, r)));
      sd_tensor_grand(r, s->a[i], s->a[j], eta, M);
      sd_wall_block(wall, 6, s->x + 3 * i, s->a[i], s->x + 3 * j, s->a[j], image);
      for (int p = 0; p < width; p++)
        for (int q = 0; q < width; q++)
          u[width * i + p] +=
              t * ((i == j ? 0.0 : M[6 * p + q]) + image[6 * p + q] / eta) * F[width * j + q];
    }
}

static void compare(const char *what, const scene *s, int width, const double *u,
                    const double *expected)
{
  double largest = 0.0;
  for (int j = 0; j < width * s->n; j++) largest = fmax(largest, fabs(expected[j]));
  for (int j = 0; j < width * s->n; j++)
    if (!(fabs(u[j] - expected[j]) <= 1e-14 * largest))
      fail_msg("%s: number %d is off by %.2g of %.2g", what, j, u[j] - expected[j], largest);
}

/* All pairs, shares, and a list of all; with tapers */
static void products_are_sums_of_blocks(void **state)
{
  (void) state;
  enum { N = 37 };
  double F[6 * N], expected[6 * N], u[6 * N], sum[6 * N];
  long first[N + 1];
  int neighbor[N * N];
  uint64_t seed = 9;
  for (int j = 0; j < 6 * N; j++) F[j] = uniform(&seed, -1, 1);
  for (int i = 0; i <= N; i++) first[i] = i * (N - 1);
  for (int i = 0; i < N; i++)
    for (int j = 0; j < N - 1; j++) neighbor[i * (N - 1) + j] = j < i ? j : j + 1;
  const sd_pairs pairs = {N, first, neighbor};
  for (int side = 0; side < 6; side++) {
    const sd_wall wall = {side / 2, side % 2 ? -1 : 1, -1.7};
    scene s = above(&wall, N, 31);
    const sd_spheres spheres = {s.x, s.a, s.w};
    for (int trial = 0; trial < 20; trial++) {
      const int width = trial % 2 ? 6 : 3, taper = trial / 10 ? SD_TAPER_WENDLAND : SD_TAPER_NONE;
      const sd_isa isa = isas[trial / 2 % 5];
      const sd_law law = {.tensor = SD_TENSOR_RPY, .taper = taper, .range = 6.0, .wall = wall};
      sd_packed p = {0};
      if (!sd_isa_supported(isa)) continue;
      by_blocks(&law, &s, width, F, expected);
      assert_int_equal(sd_packed_all(&p, isa, &law, &spheres, N, width), SD_OK);
      sd_packed_share(&p, 0, 1, F, u);
      compare(isa_name(isa), &s, width, u, expected);
      memset(sum, 0, sizeof sum);
      for (int part = 0; part < 3; part++) {
        sd_packed_share(&p, part, 3, F, u);
        for (int j = 0; j < width * N; j++) sum[j] += u[j];
      }
      compare("three shares", &s, width, sum, expected);
      assert_int_equal(sd_packed_list(&p, isa, &law, &spheres, N, width), SD_OK);
      sd_packed_pairs(&p, &pairs, F, NULL, u);
      compare("list", &s, width, u, expected);
      sd_packed_free(&p);
    }
    scene_free(&s);
  }
}

/* A lone sphere: 1.125 a/z, so that 1e8 radii away nothing is left at 1e-6; and the wall is a wall
 * whatever the units of length */
static void far_wall_is_no_wall(void **state)
{
  (void) state;
  enum { N = 40 };
  const sd_law open = {.tensor = SD_TENSOR_RPY};
  uint64_t seed = 4;
  double F[6 * N], without[6 * N], with[6 * N], largest = 0.0;
  for (int j = 0; j < 6 * N; j++) F[j] = uniform(&seed, -1, 1);
  const sd_wall beside = {2, 1, 0.0};
  scene s = above(&beside, N, 8);
  s.a[5] = 1.0;
  s.w[5] = s.w[4];
  s.drag[5] = 6.0 * SD_PI / (s.w[5] * s.w[5]);
  whole(&open, &s, SD_ISA_BEST, 6, F, without);
  for (int j = 0; j < 6 * N; j++) largest = fmax(largest, fabs(without[j]));
  for (int side = 0; side < 6; side++) {
    const sd_law far = {.tensor = SD_TENSOR_RPY,
                        .wall = {side / 2, side % 2 ? -1 : 1, side % 2 ? 1e8 : -1e8}};
    whole(&far, &s, SD_ISA_BEST, 6, F, with);
    for (int j = 0; j < 6 * N; j++) CHECK_NEAR(with[j], without[j], 1e-6 * largest);
  }
  scene_free(&s);
}

static void lengths_have_no_unit(void **state)
{
  (void) state;
  enum { N = 21 };
  double F[3 * N], u[2][3 * N], largest = 0.0;
  uint64_t seed = 6;
  for (int j = 0; j < 3 * N; j++) F[j] = uniform(&seed, -1, 1);
  const sd_law law = {.tensor = SD_TENSOR_RPY, .wall = {1, 1, 0.4}};
  for (int k = 0; k < 2; k++) {
    const double unit = k ? 7.0 : 1.0;
    scene s = above(&law.wall, N, 12);
    sd_law scaled = law;
    scaled.wall.at *= unit;
    for (int j = 0; j < 3 * N; j++) s.x[j] *= unit;
    for (int i = 0; i < N; i++) s.a[i] *= unit;
    s.drag[5] = 1.0;
    for (int i = 0; i < N; i++) s.drag[i] *= unit;
    whole(&scaled, &s, SD_ISA_BEST, 3, F, u[k]);
    scene_free(&s);
  }
  for (int j = 0; j < 3 * N; j++) largest = fmax(largest, fabs(u[0][j]));
  for (int j = 0; j < 3 * N; j++) CHECK_NEAR(7.0 * u[1][j], u[0][j], 1e-14 * largest);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(scenes_are_those_of_another_code),
      cmocka_unit_test(products_are_sums_of_blocks),
      cmocka_unit_test(far_wall_is_no_wall),
      cmocka_unit_test(lengths_have_no_unit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
