#include "scene.h"

enum { N = 30 };

static const sd_law law = {.tensor = SD_TENSOR_RPY};

static sd_status apply_grand(void *ctx, const double *F, double *u)
{
  scene *s = ctx;
  const sd_spheres spheres = {s->x, s->a, s->w};
  plain_all(&law, &spheres, s->n, 6, F, u);
  return SD_OK;
}

/* Reciprocity and dissipation of forces and torques together, radii 1:30, two viscosities. */
static void resistance_is_symmetric_and_dissipates(void **state)
{
  (void) state;
  uint64_t seed = 5;
  scene s = scene_create(N);
  double spin[N], slip[2][6 * N], F[2][6 * N], cross[2] = {0, 0}, power = 0.0;
  double *work = malloc(sizeof(double) * SD_SOLVE_WORK(N, 6));
  for (int i = 0; i < N; i++) {
    const double a = exp(uniform(&seed, log(0.05), log(1.5))), eta = i % 2 ? 1.3 : 4.1;
    scene_set(&s, i, uniform(&seed, 0, 5), uniform(&seed, 0, 5), uniform(&seed, 0, 5), a, eta);
    spin[i] = 8 * SD_PI * eta * a * a * a;
  }
  const sd_system A = {.n = N, .drag = s.drag, .spin = spin, .apply = apply_grand, .apply_ctx = &s};
  for (int k = 0; k < 2; k++) {
    sd_solve_report report;
    for (int i = 0; i < 6 * N; i++) slip[k][i] = uniform(&seed, -1, 1);
    assert_int_equal(sd_solve_gradients(&A, slip[k], 1e-12, 2000, F[k], work, &report), SD_OK);
  }
  for (int i = 0; i < 6 * N; i++) {
    cross[0] += F[0][i] * slip[1][i];
    cross[1] += F[1][i] * slip[0][i];
    power += F[0][i] * slip[0][i];
  }
  CHECK_NEAR(cross[0], cross[1], 1e-8 * power);
  assert_true(power > 0.0);
  free(work);
  scene_free(&s);
}

/* A lone sphere that moves and spins: 6 pi eta a U and 8 pi eta a^3 W, by both algorithms. */
static void lone_sphere(void **state)
{
  (void) state;
  scene s = scene_lattice(1, 1, 1, 2.0, 0.7, 1.3);
  const double spin[1] = {8 * SD_PI * 1.3 * 0.343}, slip[6] = {1, -2, 3, -4, 5, 0.6};
  const sd_system A = {.n = 1, .drag = s.drag, .spin = spin, .apply = apply_grand, .apply_ctx = &s};
  double F[6], work[SD_SOLVE_WORK(1, 6)];
  sd_solve_report report;
  for (int k = 0; k < 2; k++) {
    assert_int_equal(
        (k ? sd_solve_gradients : sd_solve_substitution)(&A, slip, 1e-13, 5, F, work, &report),
        SD_OK);
    for (int d = 0; d < 3; d++) {
      CHECK_NEAR(F[d] / (s.drag[0] * slip[d]), 1.0, 1e-14);
      CHECK_NEAR(F[3 + d] / (spin[0] * slip[3 + d]), 1.0, 1e-14);
    }
  }
  scene_free(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(resistance_is_symmetric_and_dissipates),
      cmocka_unit_test(lone_sphere),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
