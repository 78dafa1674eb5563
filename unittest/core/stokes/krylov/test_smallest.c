/* Smallest eigenvalue of the mobility, scaled to unit diagonal or by inertia, against LAPACK's of the dense matrix. */
#include "clouds.h"

#include "in_clumps.h"
#include "sd_smallest.h"

#include <string.h>

void dsyev_(const char *jobz, const char *uplo, const int *n, double *A, const int *lda, double *w,
            double *work, const int *lwork, int *info);

static const double ETA = 1.3;
static const sd_law RPY = {SD_TENSOR_RPY, SD_TAPER_NONE, 0.0};

typedef struct {
  scene s;
  int width;
  double *spin;
  double *weight; /* NULL: scaled to unit diagonal */
  sd_packed packed;
} problem;

static problem problem_create(scene s, int width)
{
  problem p = {.s = s, .width = width};
  p.spin = malloc(sizeof(double) * (size_t) s.n);
  for (int i = 0; i < s.n; i++) p.spin[i] = 4.0 / 3.0 * s.drag[i] * s.a[i] * s.a[i];
  return p;
}

static void problem_free(problem *p)
{
  free(p->spin);
  sd_packed_free(&p->packed);
  scene_free(&p->s);
}

static sd_status apply(void *ctx, const double *F, double *u)
{
  problem *p = ctx;
  const sd_spheres spheres = {p->s.x, p->s.a, p->s.w};
  if (!p->packed.n)
    assert_int_equal(sd_packed_all(&p->packed, SD_ISA_BEST, &RPY, &spheres, p->s.n, p->width),
                     SD_OK);
  sd_packed_share(&p->packed, 0, 1, F, u);
  return SD_OK;
}

static double drag_of(const problem *p, int row)
{
  return row % p->width < 3 ? p->s.drag[row / p->width] : p->spin[row / p->width];
}

static double root(const problem *p, int row)
{
  return sqrt(p->weight ? p->weight[row] : drag_of(p, row));
}

static double dense(problem *p)
{
  const int size = p->width * p->s.n, many = 10 * size;
  double *C = calloc((size_t) size * (size_t) size, sizeof(double)),
         *F = calloc((size_t) size, sizeof(double)), *u = calloc((size_t) size, sizeof(double)),
         *w = calloc((size_t) size, sizeof(double)), *work = malloc(sizeof(double) * (size_t) many);
  for (int k = 0; k < size; k++) {
    F[k] = root(p, k);
    apply(p, F, u);
    F[k] = 0.0;
    for (int i = 0; i < size; i++)
      C[(size_t) size * (size_t) k + (size_t) i] =
          i == k ? root(p, i) * root(p, i) / drag_of(p, i) : u[i] * root(p, i);
    if (p->s.a[k / p->width] == 0.0) C[(size_t) (size + 1) * (size_t) k] = 1e3;
  }
  int info;
  dsyev_("N", "L", &size, C, &size, w, work, &many, &info);
  assert_int_equal(info, 0);
  const double lowest = w[0];
  free(C);
  free(F);
  free(u);
  free(w);
  free(work);
  return lowest;
}

/* P: NULL, or of the kind sd_sparse or sd_blocks. Checks lambda against `lowest` and the eigenvector against M. */
static void check(problem *p, sd_precondition *P, void *ctx, double lowest, double off,
                  int most_products)
{
  const int size = p->width * p->s.n;
  const sd_system A = {.n = p->s.n,
                       .drag = p->s.drag,
                       .spin = p->width == 6 ? p->spin : NULL,
                       .apply = apply,
                       .apply_ctx = p,
                       .precondition = P,
                       .precondition_ctx = ctx};
  double *v = malloc(sizeof(double) * (size_t) size), *u = malloc(sizeof(double) * (size_t) size),
         *work = malloc(sizeof(double) * SD_SOLVE_WORK(p->s.n, p->width)), lambda, power = 0.0,
         norm = 0.0;
  uint64_t seed = 5;
  int products;
  for (int k = 0; k < size; k++) v[k] = uniform(&seed, -1, 1) * root(p, k);
  assert_int_equal(sd_smallest_eigenvalue(&A, p->weight, 0.2, 300, v, work, &lambda, &products),
                   SD_OK);
  if (products > most_products) fail_msg("%d products, at most %d", products, most_products);
  if (!(lambda > (1.0 - 1e-9) * lowest && lambda < (1.0 + off) * lowest))
    fail_msg("lambda %g, dense %g", lambda, lowest);
  apply(p, v, u);
  for (int k = 0; k < size; k++) {
    if (p->s.a[k / p->width] == 0.0) {
      CHECK_NEAR(v[k], 0.0, 0.0);
      continue;
    }
    power += v[k] * (u[k] + v[k] / drag_of(p, k));
    norm += v[k] * v[k] / (root(p, k) * root(p, k));
  }
  CHECK_NEAR(norm, 1.0, 1e-9);
  CHECK_NEAR(power / lambda, 1.0, 1e-9);
  free(v);
  free(u);
  free(work);
}

static void agrees_with_the_dense_matrix(void **state)
{
  (void) state;
  for (int width = 3; width <= 6; width += 3)
    for (int kind = 0; kind < 3; kind++) {
      scene s = kind == 0 ? cloud_dense(120, 0.45, 0.7, 1.3, ETA, 1)
          : kind == 1     ? cloud_flocs(6, 20, 2.0, 20.0, 1, ETA, 1)
                          : scene_lattice(3, 1, 1, 2.0, 0.7, ETA);
      if (kind == 0) s.a[17] = s.w[17] = s.drag[17] = 0.0;
      problem p = problem_create(s, width);
      const sd_spheres spheres = {s.x, s.a, s.w};
      const double lowest = dense(&p);
      check(&p, NULL, NULL, lowest, 0.15, 200);
      sd_sparse f = {0};
      assert_int_equal(sd_sparse_create(&f, &RPY, &spheres, s.n, width, 3.0, 0, 1), SD_OK);
      check(&p, sd_sparse_apply, &f, lowest, 0.15, 20);
      sd_sparse_free(&f);
      if (kind == 1) {
        in_clumps six;
        sd_blocks b = {0};
        assert_int_equal(sd_blocks_make(&b, clumps_of(&six, RPY, spheres, s.n, width, 20)), SD_OK);
        check(&p, sd_blocks_apply, &b, lowest, 0.15, 20);
        sd_blocks_free(&b);
      }
      problem_free(&p);
    }
}

/* W = m in rows of forces, 2/5 m a^2 in those of torques: a sphere alone has m/(6 pi eta a) = 2/9 rho a^2 / eta, and 3/10 of that for
 * its spin, which is less. Radii 1:2, so times 1:4; and ten spheres of the cloud a hundred times as heavy, as if held. */
static void agrees_with_the_dense_matrix_weighed_by_inertia(void **state)
{
  (void) state;
  const double rho = 1.7;
  for (int width = 3; width <= 6; width += 3)
    for (int kind = 0; kind < 3; kind++) {
      problem p = problem_create(kind == 0 ? cloud_dense(120, 0.45, 0.7, 1.4, ETA, 1)
                                     : kind == 1 ? cloud_flocs(6, 20, 2.0, 20.0, 1, ETA, 1)
                                                 : scene_lattice(1, 1, 1, 2.0, 0.7, ETA),
                                 width);
      p.weight = malloc(sizeof(double) * (size_t) (width * p.s.n));
      for (int k = 0; k < width * p.s.n; k++) {
        const double a = p.s.a[k / width], m = rho * 4.0 / 3.0 * SD_PI * a * a * a;
        p.weight[k] = (kind == 0 && k / width < 10 ? 100.0 : 1.0) * (k % width < 3 ? m : 0.4 * m * a * a);
      }
      const sd_spheres spheres = {p.s.x, p.s.a, p.s.w};
      const double lowest = dense(&p), alone = 2.0 / 9.0 * rho * 0.7 * 0.7 / ETA;
      if (kind == 2) CHECK_NEAR(lowest / (width == 6 ? 0.3 * alone : alone), 1.0, 1e-12);
      check(&p, NULL, NULL, lowest, 0.15, 200);
      sd_sparse f = {0};
      assert_int_equal(sd_sparse_create(&f, &RPY, &spheres, p.s.n, width, 3.0, 0, 1), SD_OK);
      check(&p, sd_sparse_apply, &f, lowest, 0.15, 30);
      sd_sparse_free(&f);
      free(p.weight);
      problem_free(&p);
    }
}

static sd_status fail_at_third(void *ctx, const double *F, double *u)
{
  int *calls = ctx;
  (void) F;
  for (int k = 0; k < 12; k++) u[k] = 0.0;
  return ++*calls == 3 ? SD_ECALLBACK : SD_OK;
}

static void failed_callback_is_handed_up(void **state)
{
  (void) state;
  int calls = 0, products;
  const double drag[4] = {1.3, 0.7, 2.1, 0.4};
  double v[12], work[SD_SOLVE_WORK(4, 3)], lambda;
  const sd_system A = {.n = 4, .drag = drag, .apply = fail_at_third, .apply_ctx = &calls};
  for (int k = 0; k < 12; k++) v[k] = 1.0 + k % 5;
  double weight[12];
  for (int k = 0; k < 12; k++) weight[k] = 0.3 + k;
  assert_int_equal(sd_smallest_eigenvalue(&A, weight, 1e-9, 300, v, work, &lambda, &products),
                   SD_ECALLBACK);
  assert_int_equal(calls, 3);
}

static void lone_sphere_has_one(void **state)
{
  (void) state;
  problem p = problem_create(scene_lattice(1, 1, 1, 2.0, 0.7, ETA), 6);
  check(&p, NULL, NULL, 1.0, 1e-9, 2);
  problem_free(&p);
}

/* A lattice in which only touching spheres see each other has a negative eigenvalue. */
static void cut_off_shows_by_its_sign(void **state)
{
  (void) state;
  scene s = scene_lattice(4, 4, 4, 2.0, 0.7, ETA);
  s.cutoff = 3.1 * 0.7;
  const sd_system A = {.n = s.n, .drag = s.drag, .apply = scene_apply, .apply_ctx = &s};
  double v[3 * 64], work[SD_SOLVE_WORK(64, 3)], lambda;
  uint64_t seed = 5;
  int products;
  for (int k = 0; k < 3 * 64; k++) v[k] = uniform(&seed, -1, 1);
  assert_int_equal(sd_smallest_eigenvalue(&A, NULL, 0.2, 300, v, work, &lambda, &products), SD_OK);
  assert_true(lambda < 0.0);
  v[0] = NAN;
  assert_int_equal(sd_smallest_eigenvalue(&A, NULL, 0.2, 300, v, work, &lambda, &products),
                   SD_ENOTFINITE);
  scene_free(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(agrees_with_the_dense_matrix),
      cmocka_unit_test(agrees_with_the_dense_matrix_weighed_by_inertia),
      cmocka_unit_test(failed_callback_is_handed_up),
      cmocka_unit_test(lone_sphere_has_one),
      cmocka_unit_test(cut_off_shows_by_its_sign),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
