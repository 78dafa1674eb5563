/* The long waves of a periodic box as a preconditioner. */
#include "../ewald/periodic.h"
#include "clouds.h"
#include "in_clumps.h"

#include "sd_linear.h"
#include "sd_waves.h"

static const sd_law RPY = {.tensor = SD_TENSOR_RPY};
static const double ALPHA = 0.6;

/* --- what is inverted --------------------------------------------------------------------------------------------- */

enum { N = 12 };

/* Spheres of two sizes and several viscosities in a skew box, small beside it, so that (k a)^6 hardly counts */
static scene small_spheres(sd_ewald_box *box)
{
  scene s = scene_create(N);
  uint64_t seed = 3;
  *box = (sd_ewald_box){.periodic = 1,
                        .origin = {-1.0, 2.0, 0.5},
                        .edge = {9.0, 11.0, 10.0},
                        .tilt = {3.0, -2.0, 4.0}};
  for (int i = 0; i < N; i++)
    scene_set(&s, i, uniform(&seed, -5, 9), uniform(&seed, 0, 14), uniform(&seed, 0, 12),
              i % 3 ? 0.25 : 0.4, uniform(&seed, 0.5, 2.0));
  return s;
}

static sd_precondition_case case_of(const scene *s, const sd_ewald_box *box, int width, int m,
                                    in_clumps *k)
{
  sd_precondition_case c = *clumps_of(k, RPY, (sd_spheres){s->x, s->a, s->w}, s->n, width, m);
  c.box = box;
  return c;
}

static double *matrix_of(sd_precondition *P, void *ctx, int size)
{
  double *A = malloc(sizeof(double) * (size_t) (size * size)),
         *r = calloc((size_t) size, sizeof(double)), *z = malloc(sizeof(double) * (size_t) size);
  for (int k = 0; k < size; k++) {
    r[k] = 1.0;
    assert_int_equal(P(ctx, r, z), SD_OK);
    r[k] = 0.0;
    for (int i = 0; i < size; i++) A[size * i + k] = z[i];
  }
  free(r);
  free(z);
  return A;
}

/* sum over the waves of the list by the definition of the model: velocities and spins of i from forces and torques on
 * j, with the spheres' own s and p, and k from the edges: k.a = 2 pi n. */
static void add_waves(const scene *s, const sd_ewald_box *b, int width, double *M)
{
  sd_wave_list list;
  assert_true(sd_wave_list_of(b, &list) > 0);
  const double volume = b->edge[0] * b->edge[1] * b->edge[2];
  for (int m = 0; m < SD_WAVES_MOST; m++) {
    double k[3];
    k[0] = 2 * SD_PI * list.n[0][m] / b->edge[0];
    k[1] = (2 * SD_PI * list.n[1][m] - k[0] * b->tilt[0]) / b->edge[1];
    k[2] = (2 * SD_PI * list.n[2][m] - k[0] * b->tilt[1] - k[1] * b->tilt[2]) / b->edge[2];
    const double k2 = sd_dot(k, k);
    for (int i = 0; i < s->n; i++)
      for (int j = 0; j < s->n; j++) {
        double r[3], form[2][2];
        sd_minus(s->x + 3 * i, s->x + 3 * j, r);
        const double t = sd_dot(k, r), unit = 2.0 * s->w[i] * s->w[j] / (k2 * volume);
        for (int side = 0; side < 2; side++) {
          const double x = sqrt(k2) * s->a[side ? j : i];
          form[side][0] = sin(x) / x;
          form[side][1] = 3.0 * (sin(x) - x * cos(x)) / (x * x * x);
        }
        for (int p = 0; p < width; p++)
          for (int q = 0; q < width; q++) {
            /* velocity (1 - kk/k^2) F cos; with i k x/2 on either side -k x F sin/2, and (k^2 - kk) T cos/4 */
            const int u = p % 3, v = q % 3, torques = (p >= 3) + (q >= 3);
            const double across = (u == v) - k[u] * k[v] / k2;
            const double cross = u == v ? 0.0 : ((v == (u + 1) % 3) ? -1.0 : 1.0) * k[3 - u - v];
            const double value = torques == 0 ? across * cos(t)
                : torques == 1                ? -0.5 * cross * sin(t)
                                              : 0.25 * k2 * across * cos(t);
            M[width * s->n * (width * i + p) + width * j + q] +=
                unit * form[0][p >= 3] * form[1][q >= 3] * value;
          }
      }
  }
}

/* P^-1 = alpha B^-1 + the long waves of the model, to the error of s and p; exactly symmetric and positive definite. m:
 * spheres of a clump. */
static void inverts_the_long_waves(int width, int m)
{
  const int size = width * N;
  sd_ewald_box box;
  scene s = small_spheres(&box);
  in_clumps k;
  const sd_precondition_case c = case_of(&s, &box, width, m, &k);
  sd_waves p = {0};
  assert_int_equal(sd_waves_make(&p, &c), SD_OK);
  double *P = matrix_of(sd_waves_apply, &p, size), *B = matrix_of(sd_blocks_apply, &p.near, size);
  double *waves = calloc((size_t) (size * size), sizeof(double)),
         *M = calloc((size_t) (size * size), sizeof(double));
  for (int i = 0; i < size; i++)
    for (int j = 0; j < size; j++) CHECK_NEAR(P[size * i + j], P[size * j + i], 1e-12 * P[0]);
  for (int i = 0; i < size; i++) M[(size + 1) * i] = waves[(size + 1) * i] = 0.0;
  add_waves(&s, &box, width, waves);

  /* (alpha + B waves) P = B, row by row relative to the waves that are taken */
  for (int i = 0; i < size; i++)
    for (int j = 0; j < size; j++) {
      M[size * i + j] = i == j ? ALPHA : 0.0;
      for (int l = 0; l < size; l++) M[size * i + j] += B[size * i + l] * waves[size * l + j];
    }
  double worst = 0.0, largest = 0.0;
  for (int i = 0; i < size; i++)
    for (int j = 0; j < size; j++) {
      double product = 0.0;
      for (int l = 0; l < size; l++) product += M[size * i + l] * P[size * l + j];
      const double unit = sqrt(B[(size + 1) * i] * B[(size + 1) * j]);
      worst = fmax(worst, fabs(product - B[size * i + j]) / unit);
      largest = fmax(largest, fabs(ALPHA * P[size * i + j] - B[size * i + j]) / unit);
    }
  CHECK_NEAR(worst, 0.0, 2e-3);
  assert_true(largest > 0.1); /* the waves do count here */
  assert_true(positive_definite(P, size, 0.0));
  free(P);
  free(B);
  free(M);
  free(waves);
  sd_waves_free(&p);
  scene_free(&s);
}

static void the_inverse_of_the_long_waves(void **state)
{
  (void) state;
  for (int width = 3; width <= 6; width += 3) {
    inverts_the_long_waves(width, N + 1); /* no clumps */
    inverts_the_long_waves(width, 4);
  }
}

/* A cubic box has all waves up to |n|^2 = 9, a pair each; a long one has more of them along it. */
static void the_longest_waves_come_first(void **state)
{
  (void) state;
  sd_wave_list list;
  sd_ewald_box box = {.periodic = 1, .edge = {5.0, 5.0, 5.0}};
  assert_int_equal(sd_wave_list_of(&box, &list), 3);
  int shells[10] = {0};
  for (int m = 0; m < SD_WAVES_MOST; m++) {
    const int square =
        list.n[0][m] * list.n[0][m] + list.n[1][m] * list.n[1][m] + list.n[2][m] * list.n[2][m];
    assert_true(square >= 1 && square <= 9);
    shells[square]++;
    CHECK_NEAR(list.k[m], 2 * SD_PI / 5.0 * sqrt(square), 1e-12);
  }
  const int expected[10] = {0, 3, 6, 4, 3, 12, 12, 0, 6, 15};
  for (int k = 0; k < 10; k++) assert_int_equal(shells[k], expected[k]);

  box.edge[0] = 500.0;
  assert_true(sd_wave_list_of(&box, &list) >= SD_WAVES_MOST);
  for (int m = 1; m < SD_WAVES_MOST; m++) assert_true(list.k[m] >= list.k[m - 1]);
  for (int m = 0; m < 10; m++) assert_int_equal(abs(list.n[0][m]), m + 1);
  for (int skew = 0; skew < 2; skew++) { /* lists of n, and of powers, end somewhere */
    box = (sd_ewald_box){
        .periodic = 1, .edge = {skew ? 5.0 : 5e6, 5.0, 5.0}, .tilt = {skew ? 5e4 : 0.0}};
    const int harmonics = sd_wave_list_of(&box, &list);
    assert_true(harmonics > 0 && harmonics <= SD_WAVES_MOST);
  }
  box.edge[1] = NAN;
  assert_int_equal(sd_wave_list_of(&box, &list), 0);
  box = (sd_ewald_box){.edge = {5.0, 5.0, 5.0}};
  assert_int_equal(sd_wave_list_of(&box, &list), 0);
}

/* --- ranks -------------------------------------------------------------------------------------------------------- */

/* Sums over two ranks that run one after the other, from the beginning in every turn: a turn gathers the first sum that
 * is not yet known, and the next turn tells it. Sums after it are each rank's own, of no use and not looked at. */
typedef struct {
  double *sums[16];
  int known, call, gathered;
} turns;

static sd_status tell(void *ctx, double *values, int count)
{
  turns *t = ctx;
  const int call = t->call++;
  assert_true(call < 16);
  if (call < t->known) memcpy(values, t->sums[call], sizeof(double) * (size_t) count);
  if (call != t->known) return SD_OK;
  if (!t->gathered++) t->sums[call] = calloc((size_t) count, sizeof(double));
  for (int k = 0; k < count; k++) t->sums[call][k] += values[k];
  return SD_OK;
}

/* Clumps of four, eight spheres on one rank and four on the other; or both ranks with all spheres and half of the work
   (parts). */
static void ranks_share_the_waves(void **state)
{
  (void) state;
  sd_ewald_box box;
  scene s = small_spheres(&box);
  double r[6 * N], whole[6 * N], shared[6 * N];
  uint64_t seed = 9;
  for (int i = 0; i < 6 * N; i++) r[i] = uniform(&seed, -1, 1);
  for (int width = 3; width <= 6; width += 3)
    for (int parts = 1; parts <= 2; parts++) {
      in_clumps k;
      sd_precondition_case c = case_of(&s, &box, width, 4, &k);
      sd_waves p = {0};
      turns t = {.known = 0};
      assert_int_equal(sd_waves_make(&p, &c), SD_OK);
      assert_int_equal(sd_waves_apply(&p, r, whole), SD_OK);
      sd_waves_free(&p);
      do {
        t.gathered = 0;
        memset(shared, 0, sizeof(shared));
        for (int rank = 0; rank < 2; rank++) {
          const int begin = parts == 1 && rank ? 8 : 0, n = parts == 2 ? N : rank ? 4 : 8;
          double z[6 * N];
          t.call = 0;
          c = *clumps_of(&k, RPY, (sd_spheres){s.x + 3 * begin, s.a + begin, s.w + begin}, n, width,
                         4);
          c.box = &box;
          c.world.sum = tell;
          c.world.ctx = &t;
          c.parts = parts;
          c.part = parts == 2 ? rank : 0;
          assert_int_equal(sd_waves_make(&p, &c), SD_OK);
          assert_int_equal(sd_waves_apply(&p, r + width * begin, z), SD_OK);
          for (int i = 0; i < width * n; i++) shared[width * begin + i] += z[i];
          sd_waves_free(&p);
        }
        if (t.gathered) t.known++;
      } while (t.gathered);
      for (int i = 0; i < width * N; i++) CHECK_NEAR(shared[i], whole[i], 1e-12 * s.drag[0]);
      for (int call = 0; call < t.known; call++) free(t.sums[call]);
    }
  scene_free(&s);
}

/* --- what it is for ----------------------------------------------------------------------------------------------- */

/* Iterations for random velocities, forces alone or with spins and torques; p: the spheres with their images */
static int iterations(periodic *p, const scene *s, sd_precondition *P, void *ctx, double tolerance)
{
  const int size = p->width * s->n;
  uint64_t seed = 1;
  double *slip = malloc(sizeof(double) * (size_t) size),
         *F = malloc(sizeof(double) * (size_t) size),
         *spin = malloc(sizeof(double) * (size_t) s->n),
         *work = malloc(sizeof(double) * SD_SOLVE_WORK(s->n, p->width));
  for (int i = 0; i < size; i++) slip[i] = uniform(&seed, -1, 1);
  for (int i = 0; i < s->n; i++) spin[i] = 4.0 / 3.0 * s->a[i] * s->a[i] * s->drag[i];
  const sd_system A = {.n = s->n,
                       .drag = s->drag,
                       .spin = p->width == 6 ? spin : NULL,
                       .apply = sd_mobility_apply,
                       .apply_ctx = &p->omega,
                       .precondition = P,
                       .precondition_ctx = ctx};
  sd_solve_report report;
  assert_int_equal(sd_solve_gradients(&A, slip, tolerance, 400, F, work, &report), SD_OK);
  free(slip);
  free(F);
  free(spin);
  free(work);
  return report.iterations;
}

/* Where the spheres stand now, products to the tolerance */
static void place_scene(periodic *p, const scene *s, const sd_ewald_box *box, int width,
                        double tolerance)
{
  const sd_ewald how = periodic_choose(box, s->a, s->n, width, tolerance);
  periodic_place(p, s->x, s->a, s->w, s->n, width, &how);
}

static const double tolerances[2] = {1e-3, 1e-6};

static void check_iterations(const scene *s, const sd_ewald_box *box, int width, int m,
                             const int limit[2], const char *what)
{
  in_clumps k;
  sd_precondition_case c = {
      .law = RPY, .spheres = {s->x, s->a, s->w}, .n = s->n, .width = width, .parts = 1};
  if (m > 0) c = *clumps_of(&k, RPY, c.spheres, s->n, width, m);
  c.box = box;
  sd_waves waves = {0}, blocks = {0};
  periodic p;
  assert_int_equal(sd_waves_make(&waves, &c), SD_OK);
  c.box = NULL;
  assert_int_equal(sd_waves_make(&blocks, &c), SD_OK);
  place_scene(&p, s, box, width, 1e-6);
  const int none = iterations(&p, s, sd_waves_apply, &blocks, tolerances[0]);
  for (int l = 0; l < 2; l++) {
    const int with = iterations(&p, s, sd_waves_apply, &waves, tolerances[l]);
    printf("             %s, %g: %d iterations\n", what, tolerances[l], with);
    if (with > limit[l])
      fail_msg("%s, %g: %d iterations, at most %d", what, tolerances[l], with, limit[l]);
    assert_true(l > 0 || none > 3 * with / 2); /* those of the blocks alone */
  }
  periodic_free(&p);
  sd_waves_free(&waves);
  sd_waves_free(&blocks);
}

/* 4096 spheres (a prototype in Python: 42 / 84 without and 15 / 33 with at phi 0.1, 66 / 130 and 26 / 51 at 0.45) */
static void iterations_of_a_suspension(void **state)
{
  (void) state;
  static const struct {
    const char *name;
    double phi;
    int limit[2];
  } scenes[] = {{"phi 0.1", 0.1, {18, 36}}, {"phi 0.45", 0.45, {28, 55}}};
  for (int k = 0; k < 2; k++) {
    double side;
    scene s = cloud_periodic(CHECK_SIZE(16, 8), scenes[k].phi, 0.7, 1.3, 20, &side);
    const sd_ewald_box box = {.periodic = 1, .edge = {side, side, side}};
    check_iterations(&s, &box, 3, 0, scenes[k].limit, scenes[k].name);
    scene_free(&s);
  }
}

/* 512 spheres with spins and torques, and 100 flocs of five, which take blocks of clumps besides */
static void iterations_with_torques_and_clumps(void **state)
{
  (void) state;
  static const int torques[2] = {20, 40}, flocs[2] = {15, 30};
  double side;
  scene s = cloud_periodic(8, 0.3, 0.7, 1.3, 20, &side);
  sd_ewald_box box = {.periodic = 1, .edge = {side, side, side}};
  check_iterations(&s, &box, 6, 0, torques, "torques, phi 0.3");
  scene_free(&s);
  s = cloud_flocs(100, 5, 1.0, 22.0, 1, 1.3, 3);
  box = (sd_ewald_box){.periodic = 1, .edge = {24.0, 24.0, 24.0}};
  check_iterations(&s, &box, 3, 5, flocs, "flocs");
  check_iterations(&s, &box, 6, 5, torques, "flocs, torques");
  scene_free(&s);
}

/* The waves of before all spheres have moved by 0.2 a: hardly worse */
static void waves_stay_good(void **state)
{
  (void) state;
  double side;
  uint64_t seed = 4;
  scene s = cloud_periodic(8, 0.45, 0.7, 1.3, 20, &side);
  const sd_ewald_box box = {.periodic = 1, .edge = {side, side, side}};
  const sd_precondition_case c = {
      .law = RPY, .spheres = {s.x, s.a, s.w}, .n = s.n, .width = 3, .parts = 1, .box = &box};
  sd_waves waves = {0};
  periodic p;
  int count[2];
  assert_int_equal(sd_waves_make(&waves, &c), SD_OK);
  for (int moved = 0; moved < 2; moved++) {
    place_scene(&p, &s, &box, 3, 1e-7);
    count[moved] = iterations(&p, &s, sd_waves_apply, &waves, 1e-6);
    periodic_free(&p);
    for (int i = 0; i < s.n; i++) {
      double push[3];
      random_vector(&seed, 0.2 * s.a[i], push);
      for (int d = 0; d < 3; d++) s.x[3 * i + d] += push[d];
    }
  }
  assert_true(count[1] <= count[0] + 2);
  sd_waves_free(&waves);
  scene_free(&s);
}

/* One sphere in a box smaller than it is, two at one point, a cloud in a corner, a box that is a needle: always
 * symmetric and positive definite. */
static void odd_scenes_have_an_inverse(void **state)
{
  (void) state;
  const sd_ewald_box boxes[4] = {
      {.periodic = 1, .edge = {1.0, 1.0, 1.0}},
      {.periodic = 1, .edge = {9.0, 9.0, 9.0}},
      {.periodic = 1, .edge = {400.0, 400.0, 400.0}},
      {.periodic = 1, .edge = {5e4, 3.0, 4.0}, .tilt = {2.0, -1.0, 1.5}}};
  for (int k = 0; k < 4; k++)
    for (int width = 3; width <= 6; width += 3) {
      sd_ewald_box unused;
      scene s = small_spheres(&unused);
      const int n = k ? N : 1, size = width * n;
      if (k == 0) s.a[0] = 7.0;
      if (k == 1) memcpy(s.x + 3, s.x, 3 * sizeof(double));
      const sd_precondition_case c = {.law = RPY,
                                      .spheres = {s.x, s.a, s.w},
                                      .n = n,
                                      .width = width,
                                      .parts = 1,
                                      .box = boxes + k};
      sd_waves p = {0};
      assert_int_equal(sd_waves_make(&p, &c), SD_OK);
      double *P = matrix_of(sd_waves_apply, &p, size);
      for (int i = 0; i < size; i++)
        for (int j = 0; j < size; j++)
          CHECK_NEAR(P[size * i + j], P[size * j + i],
                     1e-12 * sqrt(P[(size + 1) * i] * P[(size + 1) * j]));
      assert_true(positive_definite(P, size, 0.0));
      free(P);
      sd_waves_free(&p);
      scene_free(&s);
    }
}

static void an_open_box_has_no_waves(void **state)
{
  (void) state;
  sd_ewald_box box;
  scene s = small_spheres(&box);
  double r[3 * N], z[3 * N];
  for (int i = 0; i < 3 * N; i++) r[i] = 1.0;
  for (int k = 0; k < 2; k++) {
    in_clumps clumps;
    sd_precondition_case c = case_of(&s, k ? &box : NULL, 3, N + 1, &clumps);
    box.periodic = 0;
    sd_waves p = {0};
    assert_int_equal(sd_waves_make(&p, &c), SD_OK);
    assert_int_equal(sd_waves_apply(&p, r, z), SD_OK);
    for (int i = 0; i < 3 * N; i++) CHECK_NEAR(z[i], s.drag[i / 3], 1e-12 * s.drag[i / 3]);
    sd_waves_free(&p);
  }
  scene_free(&s);
}

static void no_numbers_are_refused(void **state)
{
  (void) state;
  sd_ewald_box box;
  scene s = small_spheres(&box);
  in_clumps clumps;
  const sd_precondition_case c = case_of(&s, &box, 3, N + 1, &clumps);
  sd_waves p = {0};
  s.x[7] = NAN;
  assert_int_equal(sd_waves_make(&p, &c), SD_ENOTFINITE);
  s.a[2] = 0.0; /* now it takes no part */
  assert_int_equal(sd_waves_make(&p, &c), SD_OK);
  double r[3 * N] = {0.0}, z[3 * N];
  r[0] = 1.0;
  assert_int_equal(sd_waves_apply(&p, r, z), SD_OK);
  for (int i = 0; i < 3 * N; i++) assert_true(isfinite(z[i]) && (i / 3 != 2 || z[i] == 0.0));
  sd_waves_free(&p);
  scene_free(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_inverse_of_the_long_waves),
      cmocka_unit_test(the_longest_waves_come_first),
      cmocka_unit_test(ranks_share_the_waves),
      cmocka_unit_test(iterations_of_a_suspension),
      cmocka_unit_test(iterations_with_torques_and_clumps),
      cmocka_unit_test(waves_stay_good),
      cmocka_unit_test(odd_scenes_have_an_inverse),
      cmocka_unit_test(an_open_box_has_no_waves),
      cmocka_unit_test(no_numbers_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
