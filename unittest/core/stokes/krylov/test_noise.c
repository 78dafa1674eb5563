/* Noise of covariance M by Lanczos's process: identities that hold after any number of products, and the variance of
 * every single mode at the default tolerance, without the scatter of sampling. */
#include "clouds.h"

#include "sd_noise_spheres.h"
#include "sd_random.h"

#include <string.h>

/* LAPACK: eigenvalues w, and eigenvectors, the rows of A then */
void dsyev_(const char *job, const char *uplo, const int *n, double *A, const int *lda, double *w, double *work,
            const int *lwork, int *info, size_t, size_t);

/* What noise_tolerance 0.01 asks of the step in the energy norm */
static const double BY_DEFAULT = 0.01 / 3.0;

/* A dense symmetric matrix */
typedef struct {
  int n;
  double *A;
} dense;

static sd_status dense_apply(void *ctx, const double *x, double *y)
{
  const dense *M = ctx;
  for (int p = 0; p < M->n; p++) {
    y[p] = 0.0;
    for (int q = 0; q < M->n; q++) y[p] += M->A[(long) M->n * p + q] * x[q];
  }
  return SD_OK;
}

/* The mobility of a scene, with the spheres' own */
static sd_status whole(void *ctx, const double *F, double *u)
{
  scene *s = ctx;
  const sd_status status = scene_apply(s, F, u);
  for (int k = 0; k < 3 * s->n; k++) u[k] += F[k] / s->drag[k / 3];
  return status;
}

static double *drags(const scene *s)
{
  double *D = malloc(sizeof(double) * 3 * (size_t) s->n);
  for (int k = 0; k < 3 * s->n; k++) D[k] = s->drag[k / 3];
  return D;
}

static dense matrix_of(scene *s)
{
  dense M = {3 * s->n, calloc(9 * (size_t) s->n * (size_t) s->n, sizeof(double))};
  double *F = calloc((size_t) M.n, sizeof(double));
  for (int q = 0; q < M.n; q++) {
    F[q] = 1.0;
    assert_int_equal(whole(s, F, M.A + (long) M.n * q), SD_OK);
    F[q] = 0.0;
  }
  free(F);
  return M;
}

static void draw_normals(int n, uint64_t step, double *w)
{
  const sd_random_key key = {99, SD_RANDOM_SPHERE, step};
  sd_random_normals(&key, 1, n, w);
}

static double dot(int n, const double *a, const double *b)
{
  double sum = 0.0;
  for (int k = 0; k < n; k++) sum += a[k] * b[k];
  return sum;
}

/* 20 spheres of several radii, some of which overlap */
static scene few(void)
{
  return cloud_flocs(5, 4, 2.0, 12.0, 0, 1.3, 17);
}

/* Whatever the tolerance, and so after any number of products, with P = 1: the total variance y.y = w.M w */
static void total_variance_is_exact_at_every_product(void **state)
{
  (void) state;
  scene s = few();
  dense M = matrix_of(&s);
  double *w = calloc(3 * (size_t) M.n, sizeof(double)), *y = w + M.n, *Mw = y + M.n;
  double *ones = malloc(sizeof(double) * (size_t) M.n);
  for (int k = 0; k < M.n; k++) ones[k] = 0.4;
  draw_normals(M.n, 1, w);
  sd_noise noise = {0};
  int last = 0;
  for (double tolerance = 0.9; tolerance > 1e-9; tolerance *= 0.3) {
    sd_noise_report report;
    const sd_noise_matrix plain = {.n = M.n, .apply = dense_apply, .ctx = &M, .D = ones};
    assert_int_equal(sd_noise_velocities(&noise, &plain, w, tolerance, y, &report), SD_OK);
    dense_apply(&M, w, Mw);
    CHECK_NEAR(dot(M.n, y, y) / dot(M.n, w, Mw), 1.0, 1e-10);
    assert_true(report.products >= last);
    last = report.products;
  }
  assert_true(last > 15);
  sd_noise_free(&noise);
  free(ones);
  free(w);
  free(M.A);
  scene_free(&s);
}

/* With P = 1 the root is the symmetric one: applied twice it is M. */
static void noise_of_noise_is_the_product(void **state)
{
  (void) state;
  scene s = few();
  const int n = 3 * s.n;
  double *w = calloc(5 * (size_t) n, sizeof(double)), *y = w + n, *yy = y + n, *Mw = yy + n, *ones = Mw + n;
  for (int k = 0; k < n; k++) ones[k] = 1.0;
  draw_normals(n, 2, w);
  sd_noise noise = {0};
  sd_noise_report report;
  const sd_noise_matrix M = {.n = n, .apply = whole, .ctx = &s, .D = ones};
  assert_int_equal(sd_noise_velocities(&noise, &M, w, 1e-8, y, &report), SD_OK);
  assert_int_equal(sd_noise_velocities(&noise, &M, y, 1e-8, yy, &report), SD_OK);
  whole(&s, w, Mw);
  for (int k = 0; k < n; k++) CHECK_NEAR(yy[k], Mw[k], 1e-6 * sqrt(dot(n, Mw, Mw) / n));
  sd_noise_free(&noise);
  free(w);
  scene_free(&s);
}

/* The bias of each mode k of A = P M P, eigenvalue l and vector v: mean of (v.P y)^2/l - (v.w)^2, over the same w, so
 * that what is exact has none of the scatter of w. The largest of all modes, and the most products of a draw. */
typedef struct {
  double worst;
  int products;
} bias;

static bias bias_of(scene *s, double tolerance, int draws)
{
  dense M = matrix_of(s);
  const int n = M.n, lwork = 40 * n;
  double *D = drags(s), *value = malloc(sizeof(double) * (size_t) n), *work = malloc(sizeof(double) * (size_t) lwork);
  double *A = malloc(sizeof(double) * (size_t) n * (size_t) n), *sum = calloc(3 * (size_t) n, sizeof(double));
  double *w = sum + n, *y = w + n;
  int info;
  for (int p = 0; p < n; p++)
    for (int q = 0; q < n; q++) A[(long) n * p + q] = sqrt(D[p] * D[q]) * M.A[(long) n * p + q];
  dsyev_("V", "L", &n, A, &n, value, work, &lwork, &info, 1, 1);
  assert_int_equal(info, 0);
  sd_noise noise = {0};
  const sd_noise_matrix of = {.n = n, .apply = dense_apply, .ctx = &M, .D = D};
  bias b = {0};
  for (int k = 0; k < draws; k++) {
    sd_noise_report report;
    draw_normals(n, (uint64_t) k, w);
    assert_int_equal(sd_noise_velocities(&noise, &of, w, tolerance, y, &report), SD_OK);
    if (report.products > b.products) b.products = report.products;
    for (int p = 0; p < n; p++) y[p] *= sqrt(D[p]);
    for (int m = 0; m < n; m++) {
      const double c = dot(n, A + (long) n * m, y), z = dot(n, A + (long) n * m, w);
      sum[m] += c * c / value[m] - z * z;
    }
  }
  for (int m = 0; m < n; m++) {
    const double mean = sum[m] / draws;
    if (fabs(mean) > fabs(b.worst)) b.worst = mean;
  }
  sd_noise_free(&noise);
  free(D);
  free(value);
  free(work);
  free(A);
  free(sum);
  free(M.A);
  return b;
}

/* Chains of ten beads at a fifth of a radius: eigenvalues 0.019 to 16 */
static scene chains(int count)
{
  scene s = scene_create(10 * count);
  uint64_t seed = 11;
  for (int c = 0; c < count; c++) {
    double x[3], e[3];
    for (int d = 0; d < 3; d++) x[d] = uniform(&seed, 0, 12);
    random_vector(&seed, 0.2, e);
    for (int k = 0; k < 10; k++)
      scene_set(&s, 10 * c + k, x[0] + k * e[0], x[1] + k * e[1], x[2] + k * e[2], 1.0, 1.3);
  }
  return s;
}

/* The scene is freed. */
static bias bias_in(scene s, double tolerance, int draws)
{
  const bias b = bias_of(&s, tolerance, draws);
  scene_free(&s);
  return b;
}

static void every_mode_of_a_dense_cloud_is_right(void **state)
{
  (void) state;
  const bias y = bias_in(cloud_dense(100, 0.45, 1.0, 1.0, 1.3, 3), BY_DEFAULT, 60);
  assert_true(fabs(y.worst) < 0.015);
  assert_true(y.products <= 20);
}

static void every_mode_of_overlapping_chains_is_right(void **state)
{
  (void) state;
  assert_true(fabs(bias_in(chains(10), BY_DEFAULT, 60).worst) < 0.015);
}

/* What the mean of variances hides: so few products as the usual rule takes (a step of y of 1e-3) leave bonds a tenth
 * and more too hot. */
static void too_few_products_make_slow_modes_hot(void **state)
{
  (void) state;
  const bias b = bias_in(chains(10), 0.08, 60);
  assert_true(b.worst > 0.1);
  assert_in_range(b.products, 10, 25);
}

static void lone_spheres_take_one_product(void **state)
{
  (void) state;
  const int n = 9;
  double A[81] = {0.0}, D[9], w[9], y[9];
  for (int k = 0; k < n; k++) {
    D[k] = k == 4 ? 0.0 : 1.5 + k / 3;
    A[(n + 1) * k] = k == 4 ? 0.0 : 1.0 / D[k];
  }
  draw_normals(n, 5, w);
  dense M = {n, A};
  const sd_noise_matrix of = {.n = n, .apply = dense_apply, .ctx = &M, .D = D};
  sd_noise noise = {0};
  sd_noise_report report;
  assert_int_equal(sd_noise_velocities(&noise, &of, w, BY_DEFAULT, y, &report), SD_OK);
  assert_int_equal(report.products, 1);
  for (int k = 0; k < n; k++) CHECK_NEAR(y[k], k == 4 ? 0.0 : w[k] / sqrt(D[k]), 1e-14);
  sd_noise_free(&noise);
}

/* An eigenvalue below 0; a number that is none; no end within the products allowed */
static void what_has_no_root_is_refused(void **state)
{
  (void) state;
  enum { n = 600 };
  double *A = calloc((size_t) n * n, sizeof(double)), *D = malloc(3 * n * sizeof(double)), *w = D + n, *y = w + n;
  dense M = {n, A};
  const sd_noise_matrix of = {.n = n, .apply = dense_apply, .ctx = &M, .D = D};
  sd_noise noise = {0};
  sd_noise_report report;
  for (int k = 0; k < n; k++) {
    D[k] = 1.0;
    A[(long) (n + 1) * k] = pow(10.0, -7.0 * k / n);
  }
  draw_normals(n, 6, w);
  assert_int_equal(sd_noise_velocities(&noise, &of, w, 1e-9, y, &report), SD_EMAXITER);
  assert_int_equal(report.products, SD_NOISE_MOST);
  assert_true(report.error > 1e-9 && report.error < 0.1);
  A[(n + 1) * 17] = -0.2;
  assert_int_equal(sd_noise_velocities(&noise, &of, w, 1e-9, y, &report), SD_EINDEFINITE);
  A[(n + 1) * 17] = NAN;
  assert_int_equal(sd_noise_velocities(&noise, &of, w, 1e-9, y, &report), SD_ENOTFINITE);
  sd_noise_free(&noise);
  free(A);
  free(D);
}

/* An open cloud needs few products, and more only with its extent */
static void products_grow_slowly_with_the_cloud(void **state)
{
  (void) state;
  scene s = cloud_dense(900, 0.45, 1.0, 1.0, 1.3, 3);
  s.fast = 1;
  const int n = 3 * s.n;
  double *D = drags(&s), *w = malloc(2 * sizeof(double) * (size_t) n), *y = w + n;
  const sd_noise_matrix of = {.n = n, .apply = whole, .ctx = &s, .D = D};
  sd_noise noise = {0};
  sd_noise_report report;
  draw_normals(n, 7, w);
  assert_int_equal(sd_noise_velocities(&noise, &of, w, BY_DEFAULT, y, &report), SD_OK);
  assert_true(report.products <= 33);
  sd_noise_free(&noise);
  free(D);
  free(w);
  scene_free(&s);
}

/* An engine with torques, of which the noise has forces alone: the block of forces, D^-1 on its diagonal, and nothing
 * of the sphere that takes no part. Without an engine D^-1 is all. */
static void the_matrix_of_spheres_leaves_out_torques(void **state)
{
  (void) state;
  enum { N = 3, ALL = 6 * N };
  uint64_t seed = 5;
  double A[ALL * ALL], D[3 * N], F[3 * N], u[3 * N], more[3 * N] = {0.0}, scratch[2 * ALL] = {0.0};
  for (int k = 0; k < ALL * ALL; k++) A[k] = uniform(&seed, -1.0, 1.0);
  for (int k = 0; k < 3 * N; k++) {
    D[k] = k / 3 == 1 ? 0.0 : uniform(&seed, 1.0, 2.0);
    F[k] = k / 3 == 1 ? 0.0 : uniform(&seed, -1.0, 1.0);
  }
  dense Omega = {ALL, A};
  sd_noise_spheres s = {N, 3, 6, D, dense_apply, &Omega, scratch, scratch + ALL};
  assert_int_equal(sd_noise_spheres_apply(&s, F, u), SD_OK);
  for (int k = 0; k < 3 * N; k++) {
    double sum = D[k] > 0.0 ? F[k] / D[k] : 0.0;
    for (int j = 0; j < 3 * N && D[k] > 0.0; j++) sum += A[ALL * (6 * (k / 3) + k % 3) + 6 * (j / 3) + j % 3] * F[j];
    CHECK_NEAR(u[k], sum, 1e-14);
  }
  sd_noise_spheres_add(&s, scratch + ALL, more);
  for (int k = 0; k < 3 * N; k++) CHECK_NEAR(more[k], scratch[ALL + 6 * (k / 3) + k % 3], 0.0);
  s.apply = NULL;
  memset(scratch, 0, sizeof(scratch));
  assert_int_equal(sd_noise_spheres_apply(&s, F, u), SD_OK);
  for (int k = 0; k < 3 * N; k++) CHECK_NEAR(u[k], D[k] > 0.0 ? F[k] / D[k] : 0.0, 0.0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(total_variance_is_exact_at_every_product),
      cmocka_unit_test(noise_of_noise_is_the_product),
      cmocka_unit_test(every_mode_of_a_dense_cloud_is_right),
      cmocka_unit_test(every_mode_of_overlapping_chains_is_right),
      cmocka_unit_test(too_few_products_make_slow_modes_hot),
      cmocka_unit_test(lone_spheres_take_one_product),
      cmocka_unit_test(what_has_no_root_is_refused),
      cmocka_unit_test(products_grow_slowly_with_the_cloud),
      cmocka_unit_test(the_matrix_of_spheres_leaves_out_torques),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
