/* Preconditioners with forces and torques as unknowns. */
#include "clouds.h"

#include "sd_clump.h"
#include "sd_precondition.h"
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
  assert_int_equal(sd_sparse_create(f, &g->law, &spheres, g->s->n, 6, rho, part, parts), SD_OK);
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

static void couple(sd_blocks *b, const rotating *g, int m)
{
  in_clumps k;
  clumps_in(&k, g, m);
  k.c.rho = 3.0;
  assert_int_equal(sd_blocks_couple(b, &k.c), SD_OK);
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

/* Everything seen, both are the inverse of the matrix that the product applies: unequal radii, overlaps, viscosity that varies,
 * a taper, spheres that take no part. The factor is kept in single precision. */
static void what_sees_all_is_the_inverse(void **state)
{
  (void) state;
  const sd_law laws[] = {{SD_TENSOR_RPY, SD_TAPER_NONE, 0.0},
                         {SD_TENSOR_RPY, SD_TAPER_WENDLAND, 9.0}};
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

/* Sums over parts of blocks, by the blocks in one part that do not need any: each number is that or 0 in
 * a part. */
static sd_status sum_over_parts(void *ctx, double *values, int count)
{
  const sd_blocks *all = ctx;
  if (count == 1) return SD_OK; /* of failures */
  const int of_mobility = count == 9 * all->blocks;
  assert_true(of_mobility || count == 18 * all->first[all->blocks]);
  const double *sum = of_mobility ? all->mobility : all->rigid;
  for (int i = 0; i < count; i++) assert_true(values[i] == 0.0 || values[i] == sum[i]);
  memcpy(values, sum, sizeof(double) * (size_t) count);
  return SD_OK;
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
  const rotating g = rotating_create(&s, (sd_law){SD_TENSOR_RPY, SD_TAPER_NONE, 0.0});
  sd_sparse f[1 + PARTS] = {{0}};
  sd_blocks b[1 + PARTS] = {{0}};
  void *fs[1 + PARTS], *bs[1 + PARTS];
  const double turn[9] = {0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1};
  for (int k = 0; k <= PARTS; k++) {
    sparse_of(&f[k], &g, 2.0, k ? k - 1 : 0, k ? PARTS : 1);
    in_clumps clumps;
    clumps_in(&clumps, &g, M);
    clumps.c.rho = 3.0;
    if (k) {
      clumps.c.part = k - 1;
      clumps.c.parts = PARTS;
      clumps.c.sum = sum_over_parts;
      clumps.c.sum_ctx = &b[0];
    }
    assert_int_equal(sd_blocks_make(&b[k], &clumps.c), SD_OK);
    fs[k] = &f[k];
    bs[k] = &b[k];
    sd_blocks_turn(&b[k], 2, turn); /* after coupling: far and near need not agree */
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

static void blocks_turn_with_forces_and_torques(void **state)
{
  (void) state;
  enum { M = 25 };
  scene s = cloud_flocs(1, M, 2.0, 5.0, 0, ETA, 3);
  const rotating g = rotating_create(&s, (sd_law){SD_TENSOR_RPY, SD_TAPER_NONE, 0.0});
  sd_blocks b = {0};
  blocks_of(&b, &g, M);
  const double R[9] = {0.48, -0.8, 0.36, 0.64, 0.6, 0.48, -0.6, 0.0, 0.8};
  for (int i = 0; i < M; i++) {
    double *x = s.x + 3 * i, y[3];
    for (int d = 0; d < 3; d++) y[d] = R[3 * d] * x[0] + R[3 * d + 1] * x[1] + R[3 * d + 2] * x[2];
    memcpy(x, y, sizeof(y));
  }
  assert_true(error_of_inverse(&g, sd_blocks_apply, &b) > 0.1);
  sd_blocks_turn(&b, 0, R);
  assert_true(error_of_inverse(&g, sd_blocks_apply, &b) < 1e-9);
  s.x[3] += 0.1;
  assert_true(error_of_inverse(&g, sd_blocks_apply, &b) > 1e-3);
  in_clumps k;
  assert_int_equal(sd_blocks_renew(&b, clumps_in(&k, &g, M), 0), SD_OK);
  assert_true(error_of_inverse(&g, sd_blocks_apply, &b) < 1e-9);
  sd_blocks_free(&b);
  free(g.spin);
  scene_free(&s);
}

/* Moved: flocs that turned and went their own way, one that bent. As if made where they are now. */
static void moved_blocks_are_as_new_ones(void **state)
{
  (void) state;
  enum { FLOCS = 6, M = 8, N = FLOCS * M };
  scene s = cloud_flocs(FLOCS, M, 2.0, 14.0, 0, ETA, 3);
  const rotating g = rotating_create(&s, (sd_law){SD_TENSOR_RPY, SD_TAPER_NONE, 0.0});
  sd_blocks moved = {0}, anew = {0};
  in_clumps k;
  clumps_in(&k, &g, M);
  k.c.rho = 3.0;
  const sd_precondition_kind *blocks = &sd_precondition_blocks;
  assert_true(blocks->size == sizeof(sd_blocks));
  assert_int_equal(blocks->make(&moved, &k.c), SD_OK);
  const double R[9] = {0.48, -0.8, 0.36, 0.64, 0.6, 0.48, -0.6, 0.0, 0.8};
  for (int i = 0; i < N; i++) {
    double *x = s.x + 3 * i, y[3];
    const int floc = i / M;
    for (int d = 0; d < 3; d++)
      y[d] = floc % 2 ? R[3 * d] * x[0] + R[3 * d + 1] * x[1] + R[3 * d + 2] * x[2] : x[d];
    for (int d = 0; d < 3; d++) x[d] = y[d] + 20.0 * floc;
  }
  s.x[3 * (2 * M + 3)] += 0.6;
  assert_int_equal(blocks->move(&moved, &k.c), SD_OK);
  assert_int_equal(blocks->make(&anew, &k.c), SD_OK);
  double r[6 * N], z[6 * N], expected[6 * N], largest = 0.0;
  uint64_t seed = 5;
  for (int i = 0; i < 6 * N; i++) r[i] = uniform(&seed, -1, 1);
  assert_int_equal(blocks->apply(&moved, r, z), SD_OK);
  assert_int_equal(blocks->apply(&anew, r, expected), SD_OK);
  for (int i = 0; i < 6 * N; i++) largest = fmax(largest, fabs(expected[i]));
  for (int i = 0; i < 6 * N; i++) CHECK_NEAR(z[i], expected[i], 1e-9 * largest);
  blocks->free(&moved);
  blocks->free(&anew);
  free(g.spin);
  scene_free(&s);
}

/* Another rank whose nth sum of failures counts one */
typedef struct {
  int sums, fails_at;
} other_rank;

static sd_status sum_with_other(void *ctx, double *values, int count)
{
  other_rank *other = ctx;
  if (count == 1 && ++other->sums == other->fails_at) values[0]++;
  return SD_OK;
}

/* What fails on one rank fails on all; blocks that cannot be coupled on one are coupled on none. */
static void ranks_fail_together(void **state)
{
  (void) state;
  scene s = cloud_flocs(4, 5, 2.0, 12.0, 0, ETA, 3);
  const rotating g = rotating_create(&s, (sd_law){SD_TENSOR_RPY, SD_TAPER_NONE, 0.0});
  const sd_precondition_kind *kinds[] = {&sd_precondition_none, &sd_precondition_blocks,
                                         &sd_precondition_sparse};
  for (int kind = 0; kind < 3; kind++)
    for (int fails_at = 0; fails_at < 3; fails_at++) {
      other_rank other = {0, fails_at};
      in_clumps k;
      clumps_in(&k, &g, 5);
      k.c.rho = 3.0;
      k.c.sum = sum_with_other;
      k.c.sum_ctx = &other;
      union {
        sd_blocks blocks;
        sd_sparse sparse;
      } P;
      memset(&P, 0, sizeof(P));
      const sd_status status = kinds[kind]->make(&P, &k.c);
      assert_int_equal(status, fails_at == 1 ? SD_EINDEFINITE : SD_OK);
      if (kind == 1 && status == SD_OK) assert_int_equal(P.blocks.far.n, fails_at == 2 ? 0 : 4);
      kinds[kind]->free(&P);
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

/* A factor that left torques to the diagonal would need 21 (lattice) and 45 (flocs), 70 and 160 by the diagonal alone. */
static void iterations_with_random_spins(void **state)
{
  (void) state;
  const sd_law law = {SD_TENSOR_RPY, SD_TAPER_NONE, 0.0};
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
  couple(&b, &g, 20);
  between(1, iterations(&g, sd_blocks_apply, &b), 20, "flocs, coupled blocks");
  sd_sparse_free(&f);
  sd_blocks_free(&b);
  free(g.spin);
  scene_free(&s);
}

/* A rigid clump of overlapping spheres, solved without its dense matrix; the resistance is that of the dense one. A factor without
 * torques would need some hundred iterations. */
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
      cmocka_unit_test(blocks_turn_with_forces_and_torques),
      cmocka_unit_test(moved_blocks_are_as_new_ones),
      cmocka_unit_test(ranks_fail_together),
      cmocka_unit_test(iterations_with_random_spins),
      cmocka_unit_test(clumps_with_torques_are_solved_in_few_iterations),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
