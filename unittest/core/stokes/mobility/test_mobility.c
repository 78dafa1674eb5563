/* What an engine says to its caller, and a third one, made here, to see that an engine is one table. What every engine
 * answers: test_ladder.c. */
#include "scene.h"

#include "engine_free.h"

#include "sd_mobility.h"
#include "sd_neighbor.h"

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

/* Spheres from 1 to 100 radii, pairs in touch and at one point; the first `many` of them */
static scene hard_places(int many, double side, double origin)
{
  scene s = scene_create(many);
  uint64_t seed = 5;
  for (int i = 0; i < many; i++)
    scene_set(&s, i, origin + uniform(&seed, 0, side), origin + uniform(&seed, 0, side),
              origin + uniform(&seed, 0, side), exp(uniform(&seed, 0.0, log(100.0))), 1.3);
  for (int i = 0; i + 1 < many; i += 2) /* every other pair at one point */
    for (int d = 0; d < 3; d++) s.x[3 * i + 3 + d] = s.x[3 * i + d] + (d == 0 && i % 4 == 0 ? s.a[i] + s.a[i + 1] :
                                                                       0.0);
  return s;
}

/* A list of everybody is the sum over all: a hundred million radii from the origin, in a box of a million radii, for
 * one sphere and for two at one point */
static void a_list_knows_hard_places(void **state)
{
  (void) state;
  enum { MANY = 60 };
  const struct {
    int many;
    double side, origin;
  } places[] = {{MANY, 500, 0}, {MANY, 500, 1e8}, {MANY, 1e6, -3e5}, {1, 10, 1e8}, {4, 10, 1e8}};
  for (int k = 0; k < 5; k++)
    for (int width = 3; width <= 6; width += 3) {
      scene s = hard_places(places[k].many, places[k].side, places[k].origin);
      double F[6 * MANY], u[2][6 * MANY];
      uint64_t seed = 8;
      sd_neighbors near = {0};
      for (int i = 0; i < width * s.n; i++) F[i] = uniform(&seed, -1, 1) * pow(s.a[i / width],
                                                                               i % width < 3 ? 1.0 : 2.0);
      assert_int_equal(sd_neighbors_cutoff(&near, s.x, s.n, s.n, 3.0 * places[k].side + 400.0), SD_OK);
      for (int list = 0; list < 2; list++) {
        const sd_mobility_scene scene = {.how = {.law = {.tensor = SD_TENSOR_RPY}, .width = width}, .n = s.n,
                                         .n_all = s.n,
                                         .spheres = {s.x, s.a, s.w}, .pairs = list ? &near.pairs : NULL};
        sd_mobility m = {0};
        assert_int_equal(sd_mobility_place(&m, list ? &sd_mobility_list : &sd_mobility_all_pairs, &scene), SD_OK);
        assert_int_equal(sd_mobility_apply(&m, F, u[list]), SD_OK);
        sd_mobility_free(&m);
      }
      for (int i = 0; i < width * s.n; i++) CHECK_NEAR(u[1][i], u[0][i], 1e-12 * fmax(1.0, fabs(u[0][i])));
      sd_neighbors_free(&near);
      scene_free(&s);
    }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_failure_of_the_caller_is_returned),
      cmocka_unit_test(a_third_engine_is_one_table),
      cmocka_unit_test(a_list_knows_hard_places),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
