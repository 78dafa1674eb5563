/* What an engine says to its caller, and a third one, made here, to see that an engine is one table. What every engine answers:
 * test_ladder.c. */
#include "scene.h"

#include "engine_free.h"

#include "sd_mobility.h"

#include <string.h>

enum { N = 60, MOST = 6 * N, ENGINES = 2 };

/* Those that want nothing but a law */
static const sd_mobility_engine *const engines[ENGINES] = {&sd_mobility_all_pairs, &sd_mobility_list};

static scene cloud(uint64_t seed)
{
  scene s = scene_create(N);
  for (int i = 0; i < N; i++)
    scene_set(&s, i, uniform(&seed, 0, 9), uniform(&seed, 0, 9), uniform(&seed, 0, 9),
              uniform(&seed, 0.3, 1.2), uniform(&seed, 0.5, 3.0));
  return s;
}

static sd_mobility_scene whole(const scene *s, int width, const sd_pairs *pairs)
{
  return (sd_mobility_scene){.how = {{.tensor = SD_TENSOR_RPY, .taper = SD_TAPER_NONE, .range = INFINITY}, width},
                             .n = s->n,
                             .n_all = s->n,
                             .spheres = {s->x, s->a, s->w},
                             .pairs = pairs};
}

static sd_status fails(void *ctx, const double *rows, double *out, int width)
{
  (void) rows;
  (void) out;
  (void) width;
  return *(const sd_status *) ctx;
}

/* What a function of the caller says comes back from the engine, and through the solver. */
static void a_failure_of_the_caller_is_returned(void **state)
{
  (void) state;
  scene s = cloud(7);
  sd_neighbors list = {0};
  assert_int_equal(sd_neighbors_cutoff(&list, s.x, N, N, 3.0), SD_OK);
  sd_status said = SD_ECALLBACK;
  double *slip = scene_uniform_slip(&s, 1, 0, 0), F[3 * N], u[3 * N];
  double *work = malloc(sizeof(double) * SD_SOLVE_WORK(N, 3));
  for (int k = 0; k < ENGINES; k++) {
    sd_mobility_scene where = whole(&s, 3, &list.pairs);
    where.world = (sd_world){&said, 0, 1, fails, NULL, fails, fails, NULL, NULL, NULL};
    sd_mobility m = {0};
    assert_int_equal(sd_mobility_place(&m, engines[k], &where), SD_OK);
    assert_int_equal(sd_mobility_apply(&m, slip, u), SD_ECALLBACK);
    const sd_system A = {.n = N, .drag = s.drag, .apply = sd_mobility_apply, .apply_ctx = &m};
    sd_solve_report report;
    assert_int_equal(sd_solve_gradients(&A, slip, 1e-6, 100, F, work, &report), SD_ECALLBACK);
    sd_mobility_free(&m);
  }
  free(work);
  free(slip);
  sd_neighbors_free(&list);
  scene_free(&s);
}

/* The engine of engine_free.h is a table like any other: nobody disturbs the fluid, F = D s after no iteration. */
static void a_third_engine_is_one_table(void **state)
{
  (void) state;
  scene s = cloud(8);
  const sd_mobility_scene where = whole(&s, 3, NULL);
  sd_mobility m = {0};
  assert_int_equal(sd_mobility_place(&m, &sd_mobility_free_spheres, &where), SD_OK);
  const sd_system A = {.n = N, .drag = s.drag, .apply = sd_mobility_apply, .apply_ctx = &m};
  double *slip = scene_uniform_slip(&s, 1, -2, 3), F[3 * N];
  double *work = malloc(sizeof(double) * SD_SOLVE_WORK(N, 3));
  sd_solve_report report;
  assert_int_equal(sd_solve_gradients(&A, slip, 1e-12, 5, F, work, &report), SD_OK);
  for (int i = 0; i < 3 * N; i++) CHECK_NEAR(F[i], s.drag[i / 3] * slip[i], 1e-13 * fabs(F[i]));
  sd_mobility_free(&m);
  free(work);
  free(slip);
  scene_free(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_failure_of_the_caller_is_returned),
      cmocka_unit_test(a_third_engine_is_one_table),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
