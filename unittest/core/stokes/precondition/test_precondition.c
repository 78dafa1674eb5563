#include "clouds.h"

#include "in_clumps.h"
#include "sd_constants.h"
#include "sd_precondition_internal.h"

#include <string.h>

static const double A = 0.7, ETA = 1.3, U = 0.9;
static const sd_law RPY = {.tensor = SD_TENSOR_RPY};

static sd_status blocks_of(sd_blocks *b, const scene *s, int m)
{
  in_clumps k;
  return sd_blocks_make(b, clumps_of(&k, RPY, (sd_spheres){s->x, s->a, s->w}, s->n, 3, m));
}

static sd_status sparse_of(sd_sparse *f, const scene *s, double rho)
{
  const sd_spheres spheres = {s->x, s->a, s->w};
  const sd_precondition_case c = {.law = RPY, .spheres = spheres, .n = s->n, .width = 3, .parts = 1};
  return sd_sparse_create(f, &c, rho);
}

/* Iterations for uniform velocity to the tolerance; checks that it converges. Total force along x in *total. */
static int iterations(scene *s, sd_precondition *P, void *ctx, double tolerance, double *total)
{
  double *slip = scene_uniform_slip(s, U, 0, 0);
  sd_status status;
  sd_solve_report report;
  s->precondition = P;
  s->precondition_ctx = ctx;
  double *F = scene_solve(s, sd_solve_gradients, slip, tolerance, 1000, &status, &report);
  assert_int_equal(status, SD_OK);
  assert_true(report.residual <= tolerance);
  if (total) {
    *total = 0.0;
    for (int i = 0; i < s->n; i++) *total += F[3 * i];
  }
  free(F);
  free(slip);
  return report.iterations;
}

static void at_most(int count, int limit, const char *what)
{
  if (count > limit) fail_msg("%s: %d iterations, at most %d", what, count, limit);
}

/* By brute force: each sphere is the one farthest from all before it, to seven digits, the smaller index first, and
 * sees those of them that are within 1.5 times that distance. */
static void spheres_come_farthest_first(void **state)
{
  (void) state;
  enum { N = 300 };
  for (int kind = 0; kind < 3; kind++) {
    uint64_t seed = 4;
    scene s = scene_create(N);
    for (int i = 0; i < N;
         i++) /* random; lattice with many ties; a far group and many at one point */
      if (kind == 0)
        scene_set(&s, i, uniform(&seed, 0, 9), uniform(&seed, 0, 9), uniform(&seed, 0, 9), A, ETA);
      else if (kind == 1)
        scene_set(&s, i, i % 7, i / 7 % 7, i / 49, A, ETA);
      else
        scene_set(&s, i, i % 3 ? 1e-3 * i : 5e6, i % 5 ? 0 : 1e3 * i, 0, A, ETA);
    for (int i = 5; i < N; i += 50) s.a[i] = 0.0;
    int order[N], taken[N] = {0};
    double best[N];
    const sd_spheres spheres = {s.x, s.a, s.w};
    sd_rows rows = {0};
    assert_int_equal(sd_rows_find(&rows, &spheres, N, 1.5, 0, 1), SD_OK);
    assert_int_equal(rows.columns, N - 6);
    for (int k = 0; k < rows.columns; k++) order[k] = rows.row[rows.first[k]];
    for (int i = 0; i < N; i++) best[i] = s.a[i] > 0.0 ? INFINITY : -1.0;
    for (int k = 0; k < rows.columns; k++) {
      int far = -1, near = 0;
      for (int i = 0; i < N; i++)
        if (!taken[i] && best[i] >= 0.0 && (far < 0 || best[i] > best[far])) far = i;
      assert_int_equal(order[k], far);
      const double reach = 2.25 * best[far] * (1.0 + 1e-6);
      for (int i = 0; i < N; i++) {
        double sq = 0.0;
        for (int d = 0; d < 3; d++) sq += pow(s.x[3 * i + d] - s.x[3 * far + d], 2);
        near += taken[i] && sq <= reach;
        if (s.a[i] > 0.0) best[i] = fmin(best[i], (float) sq);
      }
      taken[far] = 1;
      assert_int_equal(rows.first[k + 1] - rows.first[k], 1 + near);
    }
    sd_rows_free(&rows);
    scene_free(&s);
  }
}

/* Tetrahedra, whose distances are equal but for rounding, which differs from rank to rank */
static void rounding_does_not_change_the_order(void **state)
{
  (void) state;
  enum { CLUMPS = 50, N = 4 * CLUMPS };
  static const double CORNER[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  uint64_t seed = 6;
  scene s = scene_create(N);
  for (int c = 0; c < CLUMPS; c++) {
    const double at[3] = {uniform(&seed, 0, 20), uniform(&seed, 0, 20), uniform(&seed, 0, 20)};
    for (int k = 0; k < 4; k++)
      scene_set(&s, 4 * c + k, at[0] + CORNER[k][0] / sqrt(2), at[1] + CORNER[k][1] / sqrt(2),
                at[2] + CORNER[k][2] / sqrt(2), A, ETA);
  }
  const sd_spheres spheres = {s.x, s.a, s.w};
  sd_rows first = {0};
  assert_int_equal(sd_rows_find(&first, &spheres, N, 1.5, 0, 1), SD_OK);
  for (int draw = 0; draw < 5; draw++) {
    sd_rows rows = {0};
    for (int d = 0; d < 3 * N; d++) s.x[d] += uniform(&seed, -1e-14, 1e-14);
    assert_int_equal(sd_rows_find(&rows, &spheres, N, 1.5, 0, 1), SD_OK);
    assert_memory_equal(rows.first, first.first, sizeof(long) * (N + 1));
    for (int k = 0; k < N; k++) assert_int_equal(rows.row[rows.first[k]], first.row[first.first[k]]);
    sd_rows_free(&rows);
  }
  sd_rows_free(&first);
  scene_free(&s);
}

/* Everything seen, the factor is exact, but for its storage in single precision; a block of the whole scene as well. */
static void whole_inverse_converges_at_once(void **state)
{
  (void) state;
  scene s = cloud_flocs(1, 40, 3.0, 1.0, 0, ETA, 2);
  sd_sparse f = {0};
  sd_blocks b = {0};
  assert_int_equal(sparse_of(&f, &s, 1e6), SD_OK);
  assert_int_equal(f.rows.first[f.rows.columns], 40 * 41 / 2);
  assert_int_equal(blocks_of(&b, &s, 40), SD_OK);
  double plain, with;
  assert_true(iterations(&s, NULL, NULL, 1e-9, &plain) > 30);
  at_most(iterations(&s, sd_sparse_apply, &f, 1e-9, &with), 3, "sparse");
  CHECK_NEAR(with / plain, 1.0, 1e-8);
  at_most(iterations(&s, sd_blocks_apply, &b, 1e-9, &with), 1, "blocks");
  CHECK_NEAR(with / plain, 1.0, 1e-8);
  sd_sparse_free(&f);
  sd_blocks_free(&b);
  scene_free(&s);
}

/* P is symmetric and positive definite; its parts add up to the whole. Some spheres take no part. */
static void sparse_factor_is_symmetric_and_splits(void **state)
{
  (void) state;
  enum { N = 200 };
  scene s = cloud_dense(N, 0.4, 0.7, 1.3, ETA, 8);
  for (int i = 3; i < N; i += 20) s.a[i] = s.w[i] = s.drag[i] = 0.0;
  uint64_t seed = 3;
  double r[2][3 * N], z[2][3 * N], cross[2] = {0, 0}, power = 0.0;
  sd_sparse f = {0};
  assert_int_equal(sparse_of(&f, &s, 3.0), SD_OK);
  for (int k = 0; k < 2; k++) {
    for (int i = 0; i < 3 * N; i++) r[k][i] = uniform(&seed, -1, 1);
    sd_sparse_apply(&f, r[k], z[k]);
  }
  for (int i = 0; i < 3 * N; i++) {
    cross[0] += r[0][i] * z[1][i];
    cross[1] += r[1][i] * z[0][i];
    power += r[0][i] * z[0][i];
    if (s.a[i / 3] == 0.0) CHECK_NEAR(z[0][i], 0.0, 0.0);
  }
  assert_true(power > 0.0);
  CHECK_NEAR(cross[0], cross[1], 1e-12 * power);

  const sd_spheres spheres = {s.x, s.a, s.w};
  double sum[3 * N] = {0}, part[3 * N];
  for (int k = 0; k < 3; k++) {
    sd_sparse g = {0};
    const sd_precondition_case c = {.law = RPY, .spheres = spheres, .n = N, .width = 3, .part = k, .parts = 3};
    assert_int_equal(sd_sparse_create(&g, &c, 3.0), SD_OK);
    sd_sparse_apply(&g, r[0], part);
    for (int i = 0; i < 3 * N; i++) sum[i] += part[i];
    sd_sparse_free(&g);
  }
  for (int i = 0; i < 3 * N; i++) CHECK_NEAR(sum[i], z[0][i], 1e-12 * power);
  sd_sparse_free(&f);
  scene_free(&s);
}

/* Blocks are symmetric and positive definite: lone spheres in blocks of one, some spheres in no block, some take no
 * part, viscosity that varies. */
static void blocks_are_symmetric(void **state)
{
  (void) state;
  enum { N = 60, BLOCKS = 13 };
  scene s = cloud_flocs(12, 5, 3.0, 12.0, 0, ETA, 7);
  uint64_t seed = 13;
  for (int i = 0; i < N; i++) {
    const double eta = uniform(&seed, 0.5, 3.0);
    s.w[i] = 1.0 / sqrt(eta);
    s.drag[i] = 6 * SD_PI * eta * s.a[i];
  }
  s.a[7] = s.w[7] = s.drag[7] = s.a[50] = s.w[50] = s.drag[50] =
      0.0; /* 50: a block without spheres */
  long first[BLOCKS + 1];
  int member[N];
  for (int i = 0; i < N; i++) member[i] = i;
  for (int k = 0; k <= BLOCKS; k++) first[k] = k <= 10 ? 5 * k : 50 + k - 10;
  const sd_precondition_case c = {.law = RPY,
                                  .spheres = {s.x, s.a, s.w},
                                  .n = N,
                                  .width = 3,
                                  .clumps = BLOCKS,
                                  .first = first,
                                  .member = member,
                                  .parts = 1};
  sd_blocks b = {0};
  assert_int_equal(sd_blocks_make(&b, &c), SD_OK);
  double *P = malloc(sizeof(double) * 9 * N * N), r[3 * N] = {0}, z[3 * N];
  double scale = 0.0;
  for (int k = 0; k < 3 * N; k++) {
    r[k] = 1.0;
    sd_blocks_apply(&b, r, z);
    r[k] = 0.0;
    for (int i = 0; i < 3 * N; i++) {
      P[3 * N * i + k] = z[i];
      scale = fmax(scale, fabs(z[i]));
    }
  }
  for (int i = 0; i < 3 * N; i++)
    for (int k = 0; k < i; k++) CHECK_NEAR(P[3 * N * i + k], P[3 * N * k + i], 1e-12 * scale);
  for (int i = 0; i < 3 * N; i++)
    if (s.a[i / 3] == 0.0) {
      CHECK_NEAR(P[3 * N * i + i], 0.0, 0.0);
      P[3 * N * i + i] = scale;
    }
  assert_true(positive_definite(P, 3 * N, 0.0));
  free(P);
  sd_blocks_free(&b);
  scene_free(&s);
}

/* Touching lattice of 1000 spheres: 42 iterations by the diagonal; total drag of the model from a dense
   factorisation. */
static void iterations_of_the_lattice(void **state)
{
  (void) state;
  scene s = scene_lattice(10, 10, 10, 2.0, A, ETA);
  s.fast = 1;
  sd_sparse f = {0};
  assert_int_equal(sparse_of(&f, &s, 3.0), SD_OK);
  double total;
  at_most(iterations(&s, NULL, NULL, 1e-6, NULL), 43, "diagonal");
  at_most(iterations(&s, sd_sparse_apply, &f, 1e-6, NULL), 18, "sparse");
  for (int k = 0; k < 2; k++) {
    iterations(&s, k ? sd_sparse_apply : NULL, &f, 1e-10, &total);
    CHECK_NEAR(total / (6 * SD_PI * ETA * A * U), 12.852858, 6e-7); /* digits of the reference */
  }
  sd_sparse_free(&f);
  scene_free(&s);
}

static double largest_difference(const double *F, const double *G, int n)
{
  double off = 0.0, largest = 0.0;
  for (int i = 0; i < n; i++) {
    off = fmax(off, fabs(F[i] - G[i]));
    largest = fmax(largest, fabs(G[i]));
  }
  return off / largest;
}

/* 50 flocs of 20 overlapping spheres at volume fraction 0.1. The answer is that without preconditioner. */
static void iterations_of_flocs(void **state)
{
  (void) state;
  enum { FLOCS = 50, M = 20 };
  scene s = cloud_flocs(FLOCS, M, 1.0, 34.7, 1, ETA, 1);
  s.fast = 1;
  sd_blocks b = {0};
  sd_sparse f = {0};
  assert_int_equal(blocks_of(&b, &s, M), SD_OK);
  assert_int_equal(sparse_of(&f, &s, 3.0), SD_OK);
  assert_true(iterations(&s, NULL, NULL, 1e-6, NULL) > 60);
  at_most(iterations(&s, sd_blocks_apply, &b, 1e-6, NULL), 25, "blocks");
  at_most(iterations(&s, sd_sparse_apply, &f, 1e-6, NULL), 15, "sparse");
  sd_sparse_free(&f);

  double *slip = scene_uniform_slip(&s, U, 0, 0), *F[2];
  for (int k = 0; k < 2; k++) {
    sd_status status;
    sd_solve_report report;
    s.precondition = k ? sd_blocks_apply : NULL;
    s.precondition_ctx = &b;
    F[k] = scene_solve(&s, sd_solve_gradients, slip, 1e-13, 1000, &status, &report);
    assert_int_equal(status, SD_OK);
  }
  assert_true(largest_difference(F[1], F[0], 3 * s.n) < 1e-9); /* residual times some thousands */
  free(F[0]);
  free(F[1]);
  free(slip);
  sd_blocks_free(&b);
  scene_free(&s);
}

/* Dense random packing, and with the same factor after every sphere moved by 0.2 of the mean radius. */
static void iterations_of_a_dense_cloud(void **state)
{
  (void) state;
  scene s = cloud_dense(1000, 0.45, 0.7, 1.3, ETA, 1);
  s.fast = 1;
  sd_sparse f = {0};
  assert_int_equal(sparse_of(&f, &s, 3.0), SD_OK);
  assert_true(iterations(&s, NULL, NULL, 1e-6, NULL) > 60);
  at_most(iterations(&s, sd_sparse_apply, &f, 1e-6, NULL), 20, "sparse");
  uint64_t seed = 2;
  for (int i = 0; i < s.n; i++) {
    double v[3];
    random_vector(&seed, 0.2, v);
    for (int d = 0; d < 3; d++) s.x[3 * i + d] += v[d];
  }
  sd_packed_free(&s.packed);
  at_most(iterations(&s, sd_sparse_apply, &f, 1e-6, NULL), 24, "sparse, moved");
  sd_sparse_free(&f);
  scene_free(&s);
}

/* Spheres at one point: both preconditioners are made and lead to the drag of one sphere. */
static void coincident_spheres_do_not_stop_the_set_up(void **state)
{
  (void) state;
  for (int k = 0; k < 2; k++) {
    scene s = scene_lattice(2, 2, 3, k ? 2.0 : 0.0, A, ETA);
    if (k) memcpy(s.x + 15, s.x + 9, 3 * sizeof(double));
    sd_sparse f = {0};
    sd_blocks b = {0};
    double total[3];
    assert_int_equal(sparse_of(&f, &s, 3.0), SD_OK);
    assert_int_equal(blocks_of(&b, &s, s.n), SD_OK);
    iterations(&s, NULL, NULL, 1e-9, &total[0]);
    iterations(&s, sd_sparse_apply, &f, 1e-9, &total[1]);
    iterations(&s, sd_blocks_apply, &b, 1e-9, &total[2]);
    if (k == 0) CHECK_NEAR(total[0] / (6 * SD_PI * ETA * A * U), 1.0, 1e-9);
    CHECK_NEAR(total[1] / total[0], 1.0, 1e-8);
    CHECK_NEAR(total[2] / total[0], 1.0, 1e-8);
    sd_sparse_free(&f);
    sd_blocks_free(&b);
    scene_free(&s);
  }
}

/* Pairs at distances where single precision sees one point, or loses most digits of what is between: the factor is as
 * good as in double precision. */
static void nearly_coincident_spheres_keep_a_good_factor(void **state)
{
  (void) state;
  for (double apart = 1e-4; apart > 1e-8; apart *= 0.5) {
    scene s = scene_lattice(4, 4, 4, 2.0, A, ETA);
    for (int i = 0; i < 32; i++) {
      memcpy(s.x + 3 * (i + 32), s.x + 3 * i, 3 * sizeof(double));
      s.x[3 * (i + 32)] += apart * A;
    }
    double *slip = malloc(sizeof(double) * 3 * (size_t) s.n);
    uint64_t seed = 5;
    for (int i = 0; i < 3 * s.n; i++) slip[i] = uniform(&seed, -1, 1);
    sd_sparse f = {0};
    sd_status status;
    sd_solve_report report;
    assert_int_equal(sparse_of(&f, &s, 3.0), SD_OK);
    s.precondition = sd_sparse_apply;
    s.precondition_ctx = &f;
    free(scene_solve(&s, sd_solve_gradients, slip, 1e-6, 1000, &status, &report));
    assert_int_equal(status, SD_OK);
    at_most(report.iterations, 7, "sparse");
    free(slip);
    sd_sparse_free(&f);
    scene_free(&s);
  }
}

static void positions_that_are_no_numbers_are_refused(void **state)
{
  (void) state;
  scene s = scene_lattice(2, 2, 3, 2.0, A, ETA);
  sd_sparse f = {0};
  sd_blocks b = {0};
  s.x[20] = NAN;
  assert_int_equal(sparse_of(&f, &s, 3.0), SD_ENOTFINITE);
  assert_int_equal(blocks_of(&b, &s, s.n), SD_ENOTFINITE);
  assert_null(f.rows.first);
  assert_null(b.first);
  scene_free(&s);
}

/* Negative curvature is seen through a preconditioner too. */
static void cut_off_is_refused_with_preconditioner(void **state)
{
  (void) state;
  scene s = scene_lattice(5, 5, 5, 2.0, A, ETA);
  s.cutoff = 6.1 * A;
  sd_sparse f = {0};
  assert_int_equal(sparse_of(&f, &s, 2.0), SD_OK);
  double *slip = scene_uniform_slip(&s, U, 0, 0);
  sd_status status;
  sd_solve_report report;
  s.precondition = sd_sparse_apply;
  s.precondition_ctx = &f;
  free(scene_solve(&s, sd_solve_gradients, slip, 1e-6, 500, &status, &report));
  assert_int_equal(status, SD_EINDEFINITE);
  assert_true(report.curvature < 0.0);
  free(slip);
  sd_sparse_free(&f);
  scene_free(&s);
}

/* What preconditioners are made of is the mobility of spheres above a wall, images and all: another matrix would only
 * cost products. */
static void factors_above_a_wall_have_images(void **state)
{
  (void) state;
  enum { M = 4 };
  static const double x[3 * M] = {0, 0, 1.1, 2.5, 0.3, 0.9, 0.4, 2.2, 2.0, 1.9, 2.1, 1.3}, w[M] = {1, 1, 1, 1};
  static const double a[M] = {1.0, 0.7, 0.9, 0.8};
  static const int member[M] = {2, 0, 3, 1};
  const sd_law law = {.tensor = SD_TENSOR_RPY, .wall = {.axis = 2, .sign = 1, .at = -0.1}};
  const sd_spheres spheres = {x, a, w};
  for (int width = 3; width <= 6; width += 3) {
    const int N = width * M;
    double L[36 * M * M], mobility[36 * M * M];
    const sd_unit_submatrix c = {&law, &spheres, member, M, width};
    assert_int_equal(sd_unit_cholesky(&c, L), SD_OK);
    sd_wall_matrix(&law.wall, M, width, x, a, mobility);
    for (int p = 0; p < N; p++)
      for (int q = 0; q <= p; q++) {
        const int i = member[p / width], j = member[q / width], d = p % width, e = q % width;
        const double ai = d < 3 ? 6.0 * a[i] : 8.0 * pow(a[i], 3.0), aj = e < 3 ? 6.0 * a[j] : 8.0 * pow(a[j], 3.0);
        double product = 0.0;
        for (int k = 0; k <= q; k++) product += L[p + N * k] * L[q + N * k];
        CHECK_NEAR(product, SD_PI * sqrt(ai * aj) * mobility[(width * i + d) * N + width * j + e], 1e-13);
      }
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(spheres_come_farthest_first),
      cmocka_unit_test(rounding_does_not_change_the_order),
      cmocka_unit_test(whole_inverse_converges_at_once),
      cmocka_unit_test(sparse_factor_is_symmetric_and_splits),
      cmocka_unit_test(blocks_are_symmetric),
      cmocka_unit_test(iterations_of_the_lattice),
      cmocka_unit_test(iterations_of_flocs),
      cmocka_unit_test(iterations_of_a_dense_cloud),
      cmocka_unit_test(coincident_spheres_do_not_stop_the_set_up),
      cmocka_unit_test(nearly_coincident_spheres_keep_a_good_factor),
      cmocka_unit_test(positions_that_are_no_numbers_are_refused),
      cmocka_unit_test(cut_off_is_refused_with_preconditioner),
      cmocka_unit_test(factors_above_a_wall_have_images),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
