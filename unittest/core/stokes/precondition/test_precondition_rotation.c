/* Preconditioners with forces and torques as unknowns. */
#include "clouds.h"

#include "sd_clump.h"
#include "sd_precondition.h"

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
  plain_all(&g->law, &spheres, g->s->n, 6, 0, g->s->n, F, u);
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
  f->drag = g->s->drag;
  f->spin = g->spin;
}

/* Blocks of m consecutive spheres; the rest are in none. */
static void blocks_part(sd_blocks *b, const rotating *g, int m, int part, int parts)
{
  const sd_spheres spheres = {g->s->x, g->s->a, g->s->w};
  long first[100];
  int member[2000];
  assert_true(g->s->n <= 2000 && g->s->n / m < 100);
  for (int k = 0; k <= g->s->n / m; k++) first[k] = (long) m * k;
  for (int i = 0; i < g->s->n; i++) member[i] = i;
  assert_int_equal(sd_blocks_create_part(b, &g->law, &spheres, g->s->n, 6, g->s->n / m, first,
                                         member, part, parts),
                   SD_OK);
  b->drag = g->s->drag;
  b->spin = g->spin;
}

static void blocks_of(sd_blocks *b, const rotating *g, int m)
{
  blocks_part(b, g, m, 0, 1);
}

/* What the caller of sd_blocks_create_part does with the parts */
static void sum_over(sd_blocks *b, int parts)
{
  const long rigid = 18 * b[0].first[b[0].blocks], mobility = 9 * (long) b[0].blocks;
  for (int k = 1; k < parts; k++) {
    for (long i = 0; i < rigid; i++) b[0].rigid[i] += b[k].rigid[i];
    for (long i = 0; i < mobility; i++) b[0].mobility[i] += b[k].mobility[i];
  }
  for (int k = 1; k < parts; k++) {
    memcpy(b[k].rigid, b[0].rigid, sizeof(double) * (size_t) rigid);
    memcpy(b[k].mobility, b[0].mobility, sizeof(double) * (size_t) mobility);
  }
}

static void couple(sd_blocks *b, const rotating *g)
{
  const sd_spheres spheres = {g->s->x, g->s->a, g->s->w};
  assert_int_equal(sd_blocks_couple(b, &g->law, &spheres, 3.0), SD_OK);
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
    blocks_part(&b[k], &g, M, k ? k - 1 : 0, k ? PARTS : 1);
    fs[k] = &f[k];
    bs[k] = &b[k];
  }
  sum_over(b + 1, PARTS);
  for (int k = 0; k <= PARTS; k++) {
    couple(&b[k], &g);
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
  const sd_spheres spheres = {s.x, s.a, s.w};
  s.x[3] += 0.1;
  assert_true(error_of_inverse(&g, sd_blocks_apply, &b) > 1e-3);
  assert_int_equal(sd_blocks_renew(&b, &g.law, &spheres, 0), SD_OK);
  assert_true(error_of_inverse(&g, sd_blocks_apply, &b) < 1e-9);
  sd_blocks_free(&b);
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
  couple(&b, &g);
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
      cmocka_unit_test(iterations_with_random_spins),
      cmocka_unit_test(clumps_with_torques_are_solved_in_few_iterations),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
