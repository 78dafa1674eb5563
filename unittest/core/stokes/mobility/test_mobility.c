/* Engines against plain C and against each other, on one rank and on two that are emulated; and a third one, made here, to see
 * that an engine is one table. */
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

static double worst(const double *u, const double *expected, int n)
{
  double off = 0.0, scale = 0.0;
  for (int i = 0; i < n; i++) {
    off = fmax(off, fabs(u[i] - expected[i]));
    scale = fmax(scale, fabs(expected[i]));
  }
  return off / scale;
}

/* With a complete list both engines have the same pairs; plain C sums them one by one. */
static void engines_agree_with_plain_c(void **state)
{
  (void) state;
  for (int width = 3; width <= 6; width += 3) {
    scene s = cloud(3);
    sd_neighbors list = {0};
    assert_int_equal(sd_neighbors_cutoff(&list, s.x, N, N, 100.0), SD_OK);
    const sd_mobility_scene where = whole(&s, width, &list.pairs);
    double F[MOST], expected[MOST], u[MOST];
    uint64_t seed = 4;
    for (int i = 0; i < width * N; i++) F[i] = uniform(&seed, -1, 1);
    plain_all(&where.how.law, &where.spheres, N, width, F, expected);
    sd_mobility m = {0};
    for (int k = 0; k < 2 * ENGINES; k++) { /* one object becomes each engine in turn */
      assert_int_equal(sd_mobility_place(&m, engines[k % ENGINES], &where), SD_OK);
      assert_int_equal(sd_mobility_apply(&m, F, u), SD_OK);
      assert_true(worst(u, expected, width * N) < 1e-14);
    }
    sd_mobility_free(&m);
    sd_neighbors_free(&list);
    scene_free(&s);
  }
}

/* Two ranks take turns in one process: rank r has the spheres r, r + 2, ... of the cloud. What a rank would get from the other is
 * read from the F of all; what it sums, kept until both have given theirs. */
typedef struct {
  int rank, width;
  const double *F; /* [width N] of both ranks */
  double sum[MOST];
} ranks;

static int sphere_of(int rank, int k)
{
  return rank + 2 * k;
}

/* Ghosts: all spheres of the other rank */
static sd_status refresh(void *ctx, const double *rows, double *ghosts, int width)
{
  (void) rows;
  const ranks *r = ctx;
  for (int k = 0; k < N / 2; k++)
    memcpy(ghosts + width * k, r->F + width * sphere_of(1 - r->rank, k),
           sizeof(double) * (size_t) width);
  return SD_OK;
}

static sd_status spread(void *ctx, const double *rows, double *all, int width)
{
  const ranks *r = ctx;
  memcpy(all, r->F, sizeof(double) * (size_t) width * N);
  for (int k = 0; k < N / 2; k++) /* its own rows are among them */
    for (int d = 0; d < width; d++)
      CHECK_NEAR(all[width * sphere_of(r->rank, k) + d], rows[width * k + d], 0.0);
  return SD_OK;
}

static sd_status collect(void *ctx, const double *all, double *rows, int width)
{
  ranks *r = ctx;
  for (int i = 0; i < width * N; i++) r->sum[i] += all[i];
  memset(rows, 0, sizeof(double) * (size_t) width * N / 2);
  return SD_OK;
}

static void two_ranks_are_one(void **state)
{
  (void) state;
  for (int width = 3; width <= 6; width += 3) {
    scene s = cloud(5);
    double F[MOST], expected[MOST], u[MOST] = {0};
    uint64_t seed = 6;
    for (int i = 0; i < width * N; i++) F[i] = uniform(&seed, -1, 1);
    const sd_mobility_scene one = whole(&s, width, NULL);
    plain_all(&one.how.law, &one.spheres, N, width, F, expected);
    ranks r = {.width = width, .F = F};
    for (r.rank = 0; r.rank < 2; r.rank++) {
      double x[3 * N], a[N], w[N], mine[MOST / 2], answer[MOST / 2];
      for (int k = 0; k < N; k++) { /* its own first, then the other's as ghosts */
        const int i = sphere_of(k < N / 2 ? r.rank : 1 - r.rank, k % (N / 2));
        memcpy(x + 3 * k, s.x + 3 * i, 3 * sizeof(double));
        a[k] = s.a[i];
        w[k] = s.w[i];
        if (k < N / 2) memcpy(mine + width * k, F + width * i, sizeof(double) * (size_t) width);
      }
      sd_neighbors list = {0};
      assert_int_equal(sd_neighbors_cutoff(&list, x, N / 2, N, 100.0), SD_OK);
      sd_mobility m = {0};
      sd_mobility_scene where = one;
      where.n = N / 2;
      where.world = (sd_world){&r, r.rank, 2, refresh, NULL, spread, collect, NULL, NULL};
      assert_int_equal(sd_mobility_place(&m, &sd_mobility_all_pairs, &where), SD_OK);
      assert_int_equal(sd_mobility_apply(&m, mine, answer), SD_OK);
      where.spheres = (sd_spheres){x, a, w};
      where.pairs = &list.pairs;
      assert_int_equal(sd_mobility_place(&m, &sd_mobility_list, &where), SD_OK);
      assert_int_equal(sd_mobility_apply(&m, mine, answer), SD_OK);
      for (int k = 0; k < N / 2; k++)
        memcpy(u + width * sphere_of(r.rank, k), answer + width * k,
               sizeof(double) * (size_t) width);
      sd_mobility_free(&m);
      sd_neighbors_free(&list);
    }
    assert_true(worst(u, expected, width * N) < 1e-14);
    assert_true(worst(r.sum, expected, width * N) < 1e-14);
    scene_free(&s);
  }
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
    where.world = (sd_world){&said, 0, 1, fails, NULL, fails, fails, NULL, NULL};
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
      cmocka_unit_test(engines_agree_with_plain_c),
      cmocka_unit_test(two_ranks_are_one),
      cmocka_unit_test(a_failure_of_the_caller_is_returned),
      cmocka_unit_test(a_third_engine_is_one_table),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
