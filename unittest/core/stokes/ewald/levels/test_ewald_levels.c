/* Ewald sums of two levels, for few spheres that are far larger than the rest. */
#include "ewald/periodic.h"
#include "ewald/predicted.h"

#include "plain.h"
#include "sd_ewald_large_pairs.h"
#include "sd_linear.h"

enum { MOST = 9600 };

typedef struct {
  const char *what;
  int n, larges, width;
  /* of the large spheres, the small ones have 1, or 0.7 to 1.4 */
  double ratio, mixed, edge[3], tilt;
} mixture;

/* Large spheres overlap each other, small ones stand in them. */
static const mixture mixtures[] = {
    {"1 : 30", 900, 2, 3, 30, 0, {80, 90, 70}, 0},     {"1 : 30, torques", 800, 3, 6, 30, 1, {80, 70, 90}, 20},
    {"1 : 100", 1200, 2, 3, 100, 1, {300, 250, 280}, 0}, {"1 : 100, torques", 1000, 4, 6, 100, 0, {250, 250, 250}, -60},
};
enum { MIXTURES = sizeof(mixtures) / sizeof(mixtures[0]) };

typedef struct {
  double x[3 * MOST], a[MOST], w[MOST], F[6 * MOST];
  sd_ewald_box box;
} scene;

static scene make(const mixture *m, int periodic, uint64_t seed)
{
  static scene s;
  double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (int i = 0; i < m->n; i++) {
    const double small = m->mixed > 0.0 ? uniform(&seed, 0.7, 1.4) : 1.0;
    s.a[i] = i % (m->n / m->larges) == 1 ? m->ratio * uniform(&seed, 0.6, 1.0) : small;
    s.w[i] = uniform(&seed, 0.6, 1.4);
    for (int d = 0; d < 3; d++) {
      s.x[3 * i + d] = uniform(&seed, 3.0, 3.0 + m->edge[d]);
      lo[d] = fmin(lo[d], s.x[3 * i + d]);
      hi[d] = fmax(hi[d], s.x[3 * i + d]);
    }
    for (int d = 0; d < m->width; d++) s.F[m->width * i + d] = uniform(&seed, -0.6, 1) * pow(s.a[i], d < 3 ? 1 : 2);
  }
  s.box = (sd_ewald_box){.periodic = periodic, .tilt = {m->tilt, 0.5 * m->tilt, -0.7 * m->tilt}};
  memcpy(s.box.edge, m->edge, sizeof(s.box.edge));
  if (!periodic) {
    s.box = (sd_ewald_box){0};
    sd_ewald_box_around(&s.box, -1, lo, hi, m->ratio);
  }
  return s;
}

typedef struct {
  sd_ewald first;
  sd_ewald_level second;
} splitting;

/* As the rule has it, which must be two levels; or, of octaves that are not told, one; 0: any. */
static splitting choose(const scene *s, const mixture *m, double tolerance, int levels)
{
  sd_ewald_sizes sizes = periodic_sizes(s->a, m->n);
  splitting how;
  if (levels == 1) memset(sizes.octave, 0, sizeof(sizes.octave));
  assert_int_equal(sd_ewald_levels_choose(&s->box, &sizes, m->width, tolerance, &how.first, &how.second), SD_OK);
  assert_true(levels == 0 || (how.second.from > 0.0) == (levels == 2));
  return how;
}

/* Largest of the errors of small and of large spheres, each over the rms of what they would do alone; torques
   likewise */
static double error_of(const scene *s, const mixture *m, const double *u, const double *expected)
{
  double worst = 0.0;
  for (int from = 0; from < m->width; from += 3)
    for (int large = 0; large < 2; large++) {
      double off = 0.0, scale = 0.0;
      for (int i = 0; i < m->n; i++) {
        if ((s->a[i] > 2.0) != large) continue;
        for (int d = from; d < from + 3; d++) {
          const double own = from == 0 ? 6.0 * SD_PI * s->a[i] : 8.0 * SD_PI * pow(s->a[i], 3);
          off += pow(u[m->width * i + d] - expected[m->width * i + d], 2);
          scale += pow(s->w[i] * s->w[i] * s->F[m->width * i + d] / own, 2);
        }
      }
      worst = fmax(worst, sqrt(off / scale));
    }
  return worst;
}

static void product(const sd_mobility_engine *engine, const sd_mobility_scene *scene, const double *F, double *u)
{
  sd_mobility m = {0};
  assert_int_equal(sd_mobility_place(&m, engine, scene), SD_OK);
  assert_int_equal(sd_mobility_apply(&m, F, u), SD_OK);
  sd_mobility_free(&m);
}

static void open_boxes_agree_with_all_pairs(void **state)
{
  (void) state;
  /* with sanitizers one with torques and one without */
  for (int k = CHECK_SIZE(0, 1); k < CHECK_SIZE(MIXTURES, 3); k++) {
    mixture many = mixtures[k], *m = &many;
    many.n *= 8; /* all pairs of few, or of spheres that are close, are cheaper than two grids */

    const scene s = make(m, 0, 3 + k);
    static double expected[6 * MOST], u[6 * MOST];
    const sd_law law = {.tensor = SD_TENSOR_RPY};
    sd_mobility_scene scene = {.how = {.width = m->width, .law = law}, .n = m->n, .n_all = m->n,
                               .spheres = {s.x, s.a, s.w}};
    product(&sd_mobility_all_pairs, &scene, s.F, expected);
    for (int digits = 3; digits <= CHECK_SIZE(9, 3); digits += 6) {
      const splitting how = choose(&s, m, pow(10.0, -digits), 2);
      scene.how.ewald = &how.first;
      scene.how.second = &how.second;
      product(&sd_mobility_levels, &scene, s.F, u);
      const double error = error_of(&s, m, u, expected);
      if (getenv("STOKESDYN_SHOW")) printf("%s open 1e-%d: %.1e\n", m->what, digits, error);
      assert_true(error < 2.0 * pow(10.0, -digits));
    }
  }
}

/* In periodic boxes, oblique ones among them, one level has the same sum. */
static void periodic_boxes_agree_with_one_level(void **state)
{
  (void) state;
  for (int k = 0; k < MIXTURES; k++) {
    const mixture *m = mixtures + k;
    const scene s = make(m, 1, 30 + k);
    static double expected[6 * MOST], u[6 * MOST];
    for (int digits = 9; digits >= 3; digits -= 3) {
      const splitting one = choose(&s, m, 1e-11, 1), two = choose(&s, m, pow(10.0, -digits), 2);
      periodic p;
      if (digits == 9) {
        periodic_place(&p, s.x, s.a, s.w, m->n, m->width, &one.first);
        periodic_apply(&p, s.F, expected);
        periodic_free(&p);
      }
      periodic_place_levels(&p, s.x, s.a, s.w, m->n, m->width, &two.first, &two.second);
      periodic_apply(&p, s.F, u);
      periodic_free(&p);
      const double error = error_of(&s, m, u, expected);
      if (getenv("STOKESDYN_SHOW")) printf("%s periodic 1e-%d: %.1e\n", m->what, digits, error);
      assert_true(error < 2.0 * pow(10.0, -digits));
    }
  }
}

/* Even at a loose tolerance. */
static void the_matrix_is_symmetric_and_positive(void **state)
{
  (void) state;
  enum { N = 60, M = 6 * N };
  for (int k = 0; k < MIXTURES; k++) {
    mixture m = mixtures[k];
    m.n = N;
    for (int d = 0; d < 3; d++) m.edge[d] *= 0.3;
    const scene s = make(&m, 1, 50 + k);
    const int n = m.width * N;
    const splitting how = choose(&s, &m, 1e-2, 2);
    static double A[M * M], e[M], u[M];
    double scale[M];
    periodic p;
    periodic_place_levels(&p, s.x, s.a, s.w, N, m.width, &how.first, &how.second);
    for (int j = 0; j < n; j++) { /* scaled to what each sphere does alone */
      const double a = s.a[j / m.width];
      scale[j] = s.w[j / m.width] / sqrt(j % m.width < 3 ? 6.0 * SD_PI * a : 8.0 * SD_PI * a * a * a);
    }
    for (int j = 0; j < n; j++) {
      memset(e, 0, sizeof(e));
      e[j] = 1.0;
      periodic_apply(&p, e, u);
      for (int i = 0; i < n; i++) A[(size_t) i * n + j] = u[i] / (scale[i] * scale[j]);
    }
    for (int i = 0; i < n; i++)
      for (int j = 0; j < i; j++) CHECK_NEAR(A[(size_t) i * n + j], A[(size_t) j * n + i], 1e-12);
    assert_int_equal(sd_cholesky(n, A), SD_OK);
    periodic_free(&p);
  }
}

static void the_predicted_error_is_the_measured_one(void **state)
{
  (void) state;
  double least = INFINITY, most = 0.0;
  for (int k = 0; k < 12; k++) {
    mixture m = mixtures[k % 2 * 2];
    uint64_t seed = 90 + k;
    const double tolerance = pow(10.0, -uniform(&seed, 2.0, 8.0));
    const scene s = make(&m, 1, seed);
    const sd_ewald_sizes sizes = periodic_sizes(s.a, m.n);
    static double u[2][3 * MOST];
    double off = 0.0, bare = 0.0, predicted = 0.0;
    for (int tight = 0; tight < 2; tight++) {
      const splitting how = choose(&s, &m, tight ? 0.01 * tolerance : tolerance, tight ? 0 : 2);
      if (!tight) predicted = predicted_error(&how.first, &how.second, &sizes);
      periodic p;
      periodic_place_levels(&p, s.x, s.a, NULL, m.n, 3, &how.first, &how.second);
      periodic_apply(&p, s.F, u[tight]);
      periodic_free(&p);
    }
    for (int i = 0; i < 3 * m.n; i++) {
      off += pow(u[0][i] - u[1][i], 2);
      bare += pow(s.F[i] / (6.0 * SD_PI * s.a[i / 3]), 2);
    }
    const double ratio = predicted / sqrt(off / bare);
    least = fmin(least, ratio);
    most = fmax(most, ratio);
    assert_true(sqrt(off / bare) < tolerance);
  }
  if (getenv("STOKESDYN_SHOW")) printf("two levels: predicted/measured %.2f to %.2f\n", least, most);
  assert_true(least > 0.5 && most < 2.0);
}

/* One of two ranks, and what the other says: it has found no room for the list of large spheres. */
static sd_status sum_with_a_rank_without_room(void *ctx, double *values, int count)
{
  int *agreed = ctx;
  if (count == SD_ECALLBACK + 1 && ++*agreed == 2) values[SD_ENOMEMORY] += 1.0;
  assert_true(*agreed < 3 && (*agreed < 2 || count == SD_ECALLBACK + 1)); /* nobody answers another sum */
  return SD_OK;
}

static void a_rank_without_room_is_told_before_the_next_sum(void **state)
{
  (void) state;
  const mixture m = mixtures[0];
  scene s = make(&m, 1, 4);
  const splitting how = choose(&s, &m, 1e-4, 2);
  sd_ewald_large_pairs p = {0};
  int list[MOST], agreed = 0;
  for (int i = 0; i < m.n; i++) list[i] = i;
  const sd_spheres spheres = {s.x, s.a, s.w};
  const sd_world world = {.ctx = &agreed, .me = 0, .ranks = 2, .sum = sum_with_a_rank_without_room};
  sd_ewald_large_pairs_create(&p, &how.second, m.width);
  assert_int_equal(sd_ewald_large_pairs_place(&p, &spheres, list, m.n, &world), SD_ENOMEMORY);
  assert_int_equal(agreed, 2);
  sd_ewald_large_pairs_free(&p);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(open_boxes_agree_with_all_pairs),
      cmocka_unit_test(periodic_boxes_agree_with_one_level),
      cmocka_unit_test(the_matrix_is_symmetric_and_positive),
      cmocka_unit_test(the_predicted_error_is_the_measured_one),
      cmocka_unit_test(a_rank_without_room_is_told_before_the_next_sum),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
