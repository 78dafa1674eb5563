/* Preconditioners with forces and torques as unknowns. */
#include "clouds.h"

#include "sd_clump.h"
#include "sd_preconditioner.h"
#include "in_clumps.h"

#include <string.h>

static const double A = 0.7, ETA = 1.3;

/* The scene's spheres with torques: D, and the pair part by the plain product. */
typedef struct {
  scene *s;
  sd_law law;
  double *spin;
} rotating;

static rotating rotating_create(scene *s, sd_law law)
{
  assert_true(s->n > 0);
  rotating g = {s, law, calloc((size_t) s->n, sizeof(double))};
  for (int i = 0; i < s->n; i++)
    if (s->a[i] > 0.0) g.spin[i] = 4.0 / 3.0 * s->drag[i] * s->a[i] * s->a[i];
  return g;
}

static sd_status apply_pairs(void *ctx, const double *F, double *u)
{
  const rotating *g = ctx;
  const sd_spheres spheres = {g->s->x, g->s->a, g->s->w};
  plain_all(&g->law, &spheres, g->s->n, 6, F, u);
  return SD_OK;
}

static void apply_whole(const rotating *g, const double *F, double *u)
{
  apply_pairs((void *) g, F, u);
  for (int i = 0; i < g->s->n; i++)
    for (int p = 0; p < 6 && g->s->a[i] > 0.0; p++)
      u[6 * i + p] += F[6 * i + p] / (p < 3 ? g->s->drag[i] : g->spin[i]);
}

static void sparse_of(sd_sparse *f, const rotating *g, double rho, int part, int parts)
{
  const sd_spheres spheres = {g->s->x, g->s->a, g->s->w};
  const sd_precondition_case c = {
      .law = g->law, .spheres = spheres, .n = g->s->n, .width = 6, .part = part, .parts = parts};
  assert_int_equal(sd_sparse_create(f, &c, rho), SD_OK);
}

static const sd_precondition_case *clumps_in(in_clumps *k, const rotating *g, int m)
{
  const scene *s = g->s;
  return clumps_of(k, g->law, (sd_spheres){s->x, s->a, s->w}, s->n, 6, m);
}

static void blocks_of(sd_blocks *b, const rotating *g, int m)
{
  in_clumps k;
  assert_int_equal(sd_blocks_make(b, clumps_in(&k, g, m)), SD_OK);
}

static void vary_viscosity(scene *s, uint64_t *seed)
{
  for (int i = 0; i < s->n; i++) {
    const double eta = uniform(seed, 0.5, 3.0);
    s->w[i] = 1.0 / sqrt(eta);
    s->drag[i] = 6 * SD_PI * eta * s->a[i];
  }
}

static void leave_out(scene *s, int i)
{
  s->a[i] = s->w[i] = s->drag[i] = 0.0;
}

/* Largest entry of P M F - F over that of F, a force and torque of about one size in every row. */
static double error_of_inverse(const rotating *g, sd_precondition *P, void *ctx)
{
  const int n = g->s->n;
  double *F = calloc(6 * (size_t) n, sizeof(double)), *u = calloc(6 * (size_t) n, sizeof(double)),
         *z = calloc(6 * (size_t) n, sizeof(double)), worst = 0.0;
  uint64_t seed = 5;
  for (int i = 0; i < 6 * n; i++)
    if (g->s->a[i / 6] > 0.0) F[i] = uniform(&seed, -1, 1);
  apply_whole(g, F, u);
  P(ctx, u, z);
  for (int i = 0; i < 6 * n; i++) worst = fmax(worst, fabs(z[i] - F[i]));
  free(F);
  free(u);
  free(z);
  return worst;
}

/* Everything seen, both are the inverse of the matrix that the product applies: unequal radii, overlaps, viscosity that
 * varies, a taper, spheres that take no part. The factor is kept in single precision. */
static void what_sees_all_is_the_inverse(void **state)
{
  (void) state;
  const sd_law laws[] = {{.tensor = SD_TENSOR_RPY},
                         {.tensor = SD_TENSOR_RPY, .taper = SD_TAPER_WENDLAND, .range = 9.0}};
  for (int k = 0; k < 2; k++) {
    scene s = cloud_flocs(1, 40, 3.0, 1.0, 0, ETA, 2);
    uint64_t seed = 3;
    vary_viscosity(&s, &seed);
    leave_out(&s, 17);
    rotating g = rotating_create(&s, laws[k]);
    sd_sparse f = {0};
    sd_blocks b = {0};
    sparse_of(&f, &g, 1e6, 0, 1);
    blocks_of(&b, &g, 40);
    assert_true(error_of_inverse(&g, sd_sparse_apply, &f) < 1e-3);
    assert_true(error_of_inverse(&g, sd_blocks_apply, &b) < 1e-9);
    sd_sparse_free(&f);
    sd_blocks_free(&b);
    free(g.spin);
    scene_free(&s);
  }
}

/* The whole of P [(6n)^2], the sum of its parts; rows and columns in units of their own diagonal */
static double *matrix_of(const rotating *g, sd_precondition *P, void *part[], int parts)
{
  const int n = g->s->n, size = 6 * n;
  double *M = calloc((size_t) size * (size_t) size, sizeof(double)),
         *r = calloc((size_t) size, sizeof(double)), *z = calloc((size_t) size, sizeof(double));
  for (int k = 0; k < size; k++) {
    if (g->s->a[k / 6] == 0.0) {
      M[size * k + k] = 1.0;
      continue;
    }
    r[k] = 1.0 / sqrt(k % 6 < 3 ? g->s->drag[k / 6] : g->spin[k / 6]);
    for (int l = 0; l < parts; l++) {
      P(part[l], r, z);
      for (int i = 0; i < size; i++)
        if (g->s->a[i / 6] > 0.0)
          M[size * i + k] += z[i] / sqrt(i % 6 < 3 ? g->s->drag[i / 6] : g->spin[i / 6]);
    }
    r[k] = 0.0;
  }
  free(r);
  free(z);
  return M;
}

static void check_symmetric_positive(double *M, int size)
{
  for (int i = 0; i < size; i++)
    for (int k = 0; k < i; k++) CHECK_NEAR(M[size * i + k], M[size * k + i], 1e-11);
  assert_true(positive_definite(M, size, 0.0));
}

static void both_are_symmetric_positive_definite_and_split(void **state)
{
  (void) state;
  enum { N = 46, M = 5, PARTS = 3 };
  scene s = cloud_flocs(N / M + 1, M, 3.0, 11.0, 0, ETA, 7);
  s.n = N; /* the last sphere is in no block */
  uint64_t seed = 13;
  vary_viscosity(&s, &seed);
  leave_out(&s, 7);
  for (int i = 40; i < 45; i++) leave_out(&s, i); /* a block without spheres */
  const rotating g = rotating_create(&s, (sd_law){.tensor = SD_TENSOR_RPY});
  sd_sparse f[1 + PARTS] = {{0}};
  sd_blocks b[1 + PARTS] = {{0}};
  void *fs[1 + PARTS], *bs[1 + PARTS];
  for (int k = 0; k <= PARTS; k++) {
    sparse_of(&f[k], &g, 2.0, k ? k - 1 : 0, k ? PARTS : 1);
    in_clumps clumps;
    clumps_in(&clumps, &g, M);
    clumps.c.part = k ? k - 1 : 0;
    clumps.c.parts = k ? PARTS : 1;
    assert_int_equal(sd_blocks_make(&b[k], &clumps.c), SD_OK);
    fs[k] = &f[k];
    bs[k] = &b[k];
  }
  for (int kind = 0; kind < 2; kind++) {
    sd_precondition *P = kind ? sd_blocks_apply : sd_sparse_apply;
    void **ctx = kind ? bs : fs;
    double *whole = matrix_of(&g, P, ctx, 1), *sum = matrix_of(&g, P, ctx + 1, PARTS);
    for (int i = 0; i < 36 * N * N; i++) CHECK_NEAR(sum[i], whole[i], 1e-11);
    check_symmetric_positive(whole, 6 * N);
    free(whole);
    free(sum);
  }
  for (int k = 0; k <= PARTS; k++) {
    sd_sparse_free(&f[k]);
    sd_blocks_free(&b[k]);
  }
  free(g.spin);
  scene_free(&s);
}

/* What is kept is P of the positions that it was made of, for the viscosities of now, whichever kind and
 * however often it was asked for; other positions, radii, clumps or boxes make another one. */
static void what_is_kept_is_the_preconditioner_of_its_positions(void **state)
{
  (void) state;
  enum { FLOCS = 4, M = 5, N = FLOCS * M };
  const sd_precondition_kind *kinds[] = {&sd_precondition_blocks, &sd_precondition_sparse,
                                         &sd_precondition_waves};
  const sd_ewald_box boxes[] = {{.edge = {30, 31, 32}, .periodic = 1},
                                {.edge = {30, 31, 32}, .tilt = {2, 0, 0}, .periodic = 1}};
  for (int kind = 0; kind < 3; kind++) {
    scene s = cloud_flocs(FLOCS, M, 2.0, 12.0, 0, ETA, 3);
    const rotating g = rotating_create(&s, (sd_law){.tensor = SD_TENSOR_RPY});
    sd_preconditioner kept = {0};
    uint64_t seed = 5;
    double r[6 * N], z[6 * N], expected[6 * N];
    for (int i = 0; i < 6 * N; i++) r[i] = uniform(&seed, -1, 1);
    for (int turn = 0; turn < 6; turn++) {
      in_clumps k;
      if (turn == 1) vary_viscosity(&s, &seed);
      if (turn == 2) s.x[7] += 0.3;
      if (turn == 3) s.a[4] *= 0.9;
      clumps_in(&k, &g, turn == 4 ? M - 1 : M);
      if (kind == 2) k.c.box = &boxes[turn == 5];
      assert_int_equal(sd_preconditioner_make(&kept, kinds[kind], &k.c), SD_OK);
      const void *as_it_was = kept.state;
      assert_int_equal(sd_preconditioner_make(&kept, kinds[kind], &k.c), SD_OK);
      assert_ptr_equal(kept.state, as_it_was);
      assert_int_equal(sd_preconditioner_apply(&kept, s.w, r, z), SD_OK);
      double largest = 0.0;
      void *P = calloc(1, kinds[kind]->size);
      assert_int_equal(kinds[kind]->make(P, &k.c), SD_OK);
      assert_int_equal(kinds[kind]->apply(P, r, expected), SD_OK);
      for (int i = 0; i < 6 * N; i++) largest = fmax(largest, fabs(expected[i]));
      for (int i = 0; i < 6 * N; i++) CHECK_NEAR(z[i], expected[i], 1e-12 * largest);
      kinds[kind]->free(P);
      free(P);
    }
    sd_preconditioner_free(&kept);
    free(g.spin);
    scene_free(&s);
  }
}

/* A hard cut-off has no factor: D is there instead, and is not tried again for the same spheres. */
static void diagonal_where_there_is_no_other(void **state)
{
  (void) state;
  scene s = scene_lattice(5, 5, 5, 2.0, A, ETA);
  const rotating g = rotating_create(&s, (sd_law){.tensor = SD_TENSOR_OSEEN});
  in_clumps k;
  clumps_of(&k, g.law, (sd_spheres){s.x, s.a, s.w}, s.n, 3, 5);
  for (int i = 0; i < s.n; i++) s.x[3 * i] *= 0.1;
  sd_preconditioner kept = {0};
  double r[375], z[375];
  for (int i = 0; i < 375; i++) r[i] = 1.0 + i;
  assert_int_equal(sd_preconditioner_make(&kept, &sd_precondition_sparse, &k.c), SD_OK);
  assert_ptr_equal(kept.kind, &sd_precondition_blocks);
  const void *as_it_was = kept.state;
  assert_int_equal(sd_preconditioner_make(&kept, &sd_precondition_sparse, &k.c), SD_OK);
  assert_ptr_equal(kept.state, as_it_was);
  assert_int_equal(sd_preconditioner_apply(&kept, s.w, r, z), SD_OK);
  for (int i = 0; i < 375; i++) CHECK_NEAR(z[i] / (s.drag[i / 3] * r[i]), 1.0, 1e-14);
  sd_preconditioner_free(&kept);
  free(g.spin);
  scene_free(&s);
}

/* A common motion is none; half a radius, root of the mean square, is the limit. */
static void moved_is_what_is_not_common(void **state)
{
  (void) state;
  const double a = 0.8, far[3] = {1e3, -2e3, 3e3};
  for (int k = 0; k < 2; k++) {
    double sums[SD_MOVED] = {0.0};
    assert_false(sd_moved_too_far(sums));
    for (int i = 0; i < 100; i++) {
      double d[3];
      memcpy(d, far, sizeof(d));
      d[i % 3] += (i % 2 ? 1.0 : -1.0) * (k ? 0.51 : 0.49) * a;
      sd_moved_add(sums, d, a);
    }
    assert_int_equal(sd_moved_too_far(sums), k);
  }
}

/* Another rank whose nth sum of failures counts one */
typedef struct {
  int sums, fails_at;
} other_rank;

static sd_status sum_with_other(void *ctx, double *values, int count)
{
  other_rank *other = ctx;
  if (count == SD_ECALLBACK + 1 && ++other->sums == other->fails_at) values[SD_EINDEFINITE]++;
  return SD_OK;
}

/* What fails on one rank fails on all. */
static void ranks_fail_together(void **state)
{
  (void) state;
  scene s = cloud_flocs(4, 5, 2.0, 12.0, 0, ETA, 3);
  const rotating g = rotating_create(&s, (sd_law){.tensor = SD_TENSOR_RPY});
  const sd_precondition_kind *kinds[] = {&sd_precondition_blocks, &sd_precondition_sparse};
  for (int kind = 0; kind < 2; kind++)
    for (int fails_at = 0; fails_at < 2; fails_at++) {
      other_rank other = {0, fails_at};
      in_clumps k;
      clumps_in(&k, &g, 5);
      k.c.world.sum = sum_with_other;
      k.c.world.ctx = &other;
      void *P = calloc(1, kinds[kind]->size);
      const sd_status status = kinds[kind]->make(P, &k.c);
      assert_int_equal(status, fails_at == 1 ? SD_EINDEFINITE : SD_OK);
      kinds[kind]->free(P);
      free(P);
    }
  free(g.spin);
  scene_free(&s);
}

/* Iterations to 1e-6 for random velocities and spins */
static int iterations(const rotating *g, sd_precondition *P, void *ctx)
{
  const int n = g->s->n;
  const sd_system system = {.n = n,
                            .drag = g->s->drag,
                            .spin = g->spin,
                            .apply = apply_pairs,
                            .apply_ctx = (void *) g,
                            .precondition = P,
                            .precondition_ctx = ctx};
  double *slip = malloc(6 * sizeof(double) * (size_t) n),
         *F = malloc(6 * sizeof(double) * (size_t) n),
         *work = malloc(sizeof(double) * SD_SOLVE_WORK(n, 6));
  uint64_t seed = 5;
  for (int i = 0; i < 6 * n; i++)
    slip[i] = uniform(&seed, -1, 1) / (i % 6 < 3 ? 1.0 : g->s->a[i / 6]);
  sd_solve_report report;
  assert_int_equal(sd_solve_gradients(&system, slip, 1e-6, 1000, F, work, &report), SD_OK);
  free(slip);
  free(F);
  free(work);
  return report.iterations;
}

static void between(int low, int count, int high, const char *what)
{
  if (count < low || count > high)
    fail_msg("%s: %d iterations, expected %d to %d", what, count, low, high);
}

/* A factor that left torques to the diagonal would need 21 (lattice) and 45 (flocs), 70 and 160 by the diagonal
   alone. */
static void iterations_with_random_spins(void **state)
{
  (void) state;
  const sd_law law = {.tensor = SD_TENSOR_RPY};
  sd_sparse f = {0};
  sd_blocks b = {0};
  scene s = scene_lattice(7, 7, 7, 2.0, A, ETA);
  rotating g = rotating_create(&s, law);
  sparse_of(&f, &g, 3.0, 0, 1);
  between(40, iterations(&g, NULL, NULL), 1000, "lattice, diagonal");
  between(1, iterations(&g, sd_sparse_apply, &f), 15, "lattice, sparse");
  sd_sparse_free(&f);
  free(g.spin);
  scene_free(&s);

  s = cloud_flocs(20, 20, 1.0, 25.6, 1, ETA, 1);
  g = rotating_create(&s, law);
  sparse_of(&f, &g, 3.0, 0, 1);
  blocks_of(&b, &g, 20);
  between(100, iterations(&g, NULL, NULL), 1000, "flocs, diagonal");
  between(1, iterations(&g, sd_sparse_apply, &f), 20, "flocs, sparse");
  between(1, iterations(&g, sd_blocks_apply, &b), 30, "flocs, blocks");
  sd_sparse_free(&f);
  sd_blocks_free(&b);
  free(g.spin);
  scene_free(&s);
}

/* A rigid clump of overlapping spheres, solved without its dense matrix; the resistance is that of the dense one. A
 * factor without torques would need some hundred iterations. */
static void clumps_with_torques_are_solved_in_few_iterations(void **state)
{
  (void) state;
  enum { SIDE = 6, N = SIDE * SIDE * SIDE };
  double x[3 * N], a[N];
  for (int i = 0; i < N; i++) {
    x[3 * i] = 0.9 * A * (i % SIDE) + 0.01 * (i % 7);
    x[3 * i + 1] = 0.9 * A * (i / SIDE % SIDE);
    x[3 * i + 2] = 0.92 * A * (i / SIDE / SIDE);
    a[i] = A;
  }
  sd_shape shape;
  sd_shells shells = {0};
  sd_clump_options o = SD_CLUMP_OPTIONS;
  sd_clump_need need;
  sd_clump dense, iterative;
  o.rotation = 1;
  assert_int_equal(sd_shape_create(N, x, a, &shape), SD_OK);
  assert_int_equal(sd_clump_create(&shape, &o, &shells, &dense, &need), SD_OK);
  o.memory = 0.9 * need.dense;
  assert_true(need.iterative < o.memory);
  assert_int_equal(sd_clump_create(&shape, &o, &shells, &iterative, &need), SD_OK);
  between(2, iterative.iterations, 40, "clump");
  for (int k = 0; k < 36; k++) CHECK_NEAR(iterative.R[k], dense.R[k], 1e-6 * dense.R[21]);
  sd_clump_free(&dense);
  sd_clump_free(&iterative);
  sd_shape_free(&shape);
  sd_shells_free(&shells);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_sees_all_is_the_inverse),
      cmocka_unit_test(both_are_symmetric_positive_definite_and_split),
      cmocka_unit_test(what_is_kept_is_the_preconditioner_of_its_positions),
      cmocka_unit_test(diagonal_where_there_is_no_other),
      cmocka_unit_test(moved_is_what_is_not_common),
      cmocka_unit_test(ranks_fail_together),
      cmocka_unit_test(iterations_with_random_spins),
      cmocka_unit_test(clumps_with_torques_are_solved_in_few_iterations),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
