/* Random slip of rigid clumps and free spheres of one point each that feel each other: shells,
 * films and all, without sampling. */
#include "tied_flock.h"
#include "unit_normals.h"

#include "sd_bodies_noise.h"
#include "sd_constants.h"
#include "sd_ewald_kernels.h"
#include "sd_ewald_pairs.h"
#include "sd_lubrication_noise.h"

/* Two clumps of an L and two free spheres */
static flock *some(int shell)
{
  static const double X[9] = {0, 0, 0, 2, 0, 0, 0, 2, 0}, a[3] = {1, 1, 1};
  flock *f = flock_create(3, X, a, shell, 2, 2, 1.3);
  flock_scatter(f, 0.12, 5);
  return f;
}

/* V [6 bodies] for forces F on the spheres */
static void move_by(flock *f, const sd_bodies *A, const double *F, double *V)
{
  memcpy(f->F, F, sizeof(double) * 6 * (size_t) f->n);
  assert_int_equal(flock_solve(f, A, 0, 1e-11, 200), SD_OK);
  memcpy(V, f->all_V, sizeof(double) * 6 * (size_t) sd_bodies_count(A));
}

/* For a slip u of the spheres */
static void slip_by(flock *f, const sd_bodies *A, const double *u, double *V)
{
  const double none[6 * 8] = {0.0};
  memcpy(f->u, u, sizeof(double) * 6 * (size_t) f->n);
  move_by(f, A, none, V);
  memset(f->u, 0, sizeof(double) * 6 * (size_t) f->n);
}

static void add_square(int size, const double *V, double *C)
{
  for (int p = 0; p < size; p++)
    for (int q = 0; q < size; q++) C[size * p + q] += V[p] * V[q];
}

/* Covariance of the velocities less the mobility, by unit loads on each body, over the root of its
 * diagonal. Rows of held bodies are 0 in both, and so is what spins of those that are spun. */
static double worst_of(flock *f, const sd_bodies *A)
{
  const int size = 6 * sd_bodies_count(A), n = f->n;
  double *N = calloc((size_t) (2 * size * size), sizeof(double)), *C = N + size * size;
  double w[6 * 8] = {0.0}, F[6 * 8], V[6 * 8], worst = 0.0;
  sd_bodies_noise noise = {0};
  sd_noise_report report;
  sd_body_root root;
  const sd_body_root *roots[8];
  const sd_bodies_blocks blocks = {A->body, roots};
  assert_int_equal(sd_body_root_create(&f->body, 1.0, NULL, &root), SD_OK);
  for (int b = 0; b < A->shaped; b++) roots[b] = &root;
  assert_true(n <= 8);
  for (int j = 0; j < size; j++) {
    int first = 0;
    while (f->whole[first] != j / 6) first++;
    memset(F, 0, sizeof F);
    F[6 * first + j % 6] = 1.0;
    const double e[3] = {j % 6 == 0, j % 6 == 1, j % 6 == 2};
    if (j % 6 < 3) sd_cross(e, f->arm + 3 * first, F + 6 * first + 3);
    move_by(f, A, F, V);
    for (int p = 0; p < size; p++) N[size * p + j] = V[p];
  }
  for (int j = 0; j < 6 * n; j++) {
    w[j] = 1.0;
    assert_int_equal(sd_bodies_draw(&noise, A, &blocks, w, 1e-9, F, &report), SD_OK);
    w[j] = 0.0;
    slip_by(f, A, F, V);
    add_square(size, V, C);
  }
  for (unit_normals u = {n, 0}; A->tie && u.unit < 12 * n * n; u.unit++) {
    memset(F, 0, sizeof F);
    assert_int_equal(sd_lubrication_noise(A->tie->L, unit_of_pair, &u, F), SD_OK);
    if (flock_distance(F, w, 1) == 0.0 && F[0] == 0.0 && F[1] == 0.0 && F[2] == 0.0) continue;
    move_by(f, A, F, V);
    add_square(size, V, C);
  }
  for (int p = 0; p < size; p++)
    for (int q = 0; q < size; q++) {
      const double scale = sqrt(N[(size + 1) * p] * N[(size + 1) * q]);
      if (scale > 0.0) worst = fmax(worst, fabs(C[size * p + q] - N[size * p + q]) / scale);
    }
  sd_bodies_noise_free(&noise);
  sd_body_root_free(&root);
  free(N);
  return worst;
}

static void clumps_have_the_covariance_of_their_mobility(void **state)
{
  (void) state;
  for (int shell = 1; shell <= 12; shell += 11)
    for (int held = SD_BODY_FREE; held <= SD_BODY_PINNED; held++) {
      flock *f = some(shell);
      const sd_bodies A = flock_place(f, 6);
      f->known[0] = f->known[3] = (char) held; /* a free sphere and a clump */
      assert_true(worst_of(f, &A) < 1e-7);
      flock_free(f);
    }
}

/* The blocks by which the process goes are roots: any others would give the same noise in more products. */
static void roots_are_roots(void **state)
{
  (void) state;
  flock *f = some(12);
  sd_body_root root;
  assert_int_equal(sd_body_root_create(&f->body, 1.0, NULL, &root), SD_OK);
  const int N = root.n;
  assert_int_equal(N, f->body.width * f->body.m);
  double largest = 0.0, worst = 0.0;
  for (int p = 0; p < N; p++)
    for (int q = 0; q < N; q++) {
      double square = 0.0, unit = 0.0;
      for (int k = 0; k < N; k++) {
        square += root.inverse[p * N + k] * root.inverse[k * N + q];
        unit += root.inverse[p * N + k] * root.root[k * N + q];
      }
      square *= (p % 6 > 2 ? root.length : 1.0) * (q % 6 > 2 ? root.length : 1.0);
      largest = fmax(largest, fabs(f->body.inverse[p * N + q]));
      worst = fmax(worst, fabs(square - f->body.inverse[p * N + q]));
      CHECK_NEAR(unit, p == q, 1e-11);
      CHECK_NEAR(root.inverse[p * N + q], root.inverse[q * N + p], 1e-12 * largest);
    }
  assert_true(worst < 1e-11 * largest);
  sd_body_root_free(&root);
  flock_free(f);
}

/* Where the sum is split they are those of the near part, as the engine has it: here of spheres with torques, of unlike
 * radii, without images. */
static void roots_of_a_split_sum_are_of_its_near_part(void **state)
{
  (void) state;
  enum { M = 3, N = 6 * M };
  static const double X[3 * M] = {0, 0, 0, 2, 0, 0, 0, 2.1, 0}, a[M] = {1, 1, 0.8}, one[M] = {1, 1, 1};
  const sd_ewald_box box = {.periodic = 1, .edge = {20, 20, 20}};
  const sd_ewald_sizes sizes = {.all = {M, 2.64, 2.4096, 1.0}};
  flock *f = flock_create(M, X, a, 1, 1, 0, 1.0);
  const sd_spheres spheres = {f->body.x, f->body.radius, one};
  const sd_groups none = {0};
  sd_ewald how;
  sd_ewald_pairs near = {0};
  sd_body_root root;
  assert_int_equal(sd_ewald_choose_positive(&box, &sizes, 6, 1e-10, SD_EWALD_POSITIVE, &how), SD_OK);
  assert_int_equal(sd_body_root_create(&f->body, 1.0, &how, &root), SD_OK);
  assert_int_equal(root.n, N);
  sd_ewald_pairs_create(&near, &how, SD_KERNELS_OF(sd_ewald, plain, SD_ISA_PLAIN), 6);
  assert_int_equal(sd_ewald_pairs_place(&near, &spheres, &none, M, M, 0), SD_OK);
  for (int q = 0; q < N; q++) {
    double F[N] = {0.0}, u[N];
    F[q] = 1.0;
    assert_int_equal(sd_ewald_pairs_load(&near, M, F, NULL, NULL, NULL), SD_OK);
    sd_ewald_pairs_apply(&near);
    sd_ewald_pairs_take(&near, M, F, NULL, NULL, NULL, u);
    u[q] += q % 6 < 3 ? 1.0 / (6.0 * SD_PI * a[q / 6]) : 1.0 / (8.0 * SD_PI * pow(a[q / 6], 3.0));
    for (int p = 0; p < N; p++) {
      double square = 0.0;
      for (int k = 0; k < N; k++) square += root.root[p * N + k] * root.root[k * N + q];
      square /= (p % 6 > 2 ? root.length : 1.0) * (q % 6 > 2 ? root.length : 1.0);
      CHECK_NEAR(square, u[p], 1e-10);
    }
  }
  sd_ewald_pairs_free(&near);
  sd_body_root_free(&root);
  flock_free(f);
}

static void films_take_their_part(void **state)
{
  (void) state;
  flock *f = some(1);
  tied_flock *t = tie_flock(f, 1e-3);
  sd_bodies A = flock_place(f, 6);
  A.tie = &t->tie;
  assert_true(t->near.L.count > 0);
  assert_true(worst_of(f, &A) < 1e-7);
  for (int held = SD_BODY_SPUN; held <= SD_BODY_PINNED; held++) {
    f->known[1] = f->known[2] = (char) held; /* a free sphere and a clump */
    assert_true(worst_of(f, &A) < 1e-7);
  }
  untie(t);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(clumps_have_the_covariance_of_their_mobility),
      cmocka_unit_test(roots_are_roots),
      cmocka_unit_test(roots_of_a_split_sum_are_of_its_near_part),
      cmocka_unit_test(films_take_their_part),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
