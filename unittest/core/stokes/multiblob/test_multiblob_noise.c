/* Brownian forces on spheres as shells of points: that the velocities which follow from them have
 * the covariance of the mobility, without sampling. */
#include "blob_flock.h"

#include "clouds.h"
#include "unit_normals.h"

#include "sd_bodies_noise.h"
#include "sd_lubrication_noise.h"
#include "sd_pose.h"
#include "sd_random.h"

static void make_roots(blob_flock *f)
{
  assert_int_equal(sd_body_shape_take_root(&f->lone.points), SD_OK);
  if (f->m) assert_int_equal(sd_body_shape_take_root(&f->shape.points), SD_OK);
}

/* N [6 bodies]^2 by unit forces, which act on the first sphere of a body */
static double *mobility_of(blob_flock *f, const sd_bodies *A)
{
  const int size = 6 * A->shaped, own = f->m ? f->m : 1;
  double *N = malloc(sizeof(double) * (size_t) (size * size)), F[6 * MOST] = {0.0};
  for (int j = 0; j < size; j++) {
    const int b = j / 6, first = own * b;
    double *on = F + 6 * first;
    on[j % 6] = 1.0;
    if (j % 6 < 3 && f->m) { /* about the centre of the body */
      const double e[3] = {j % 6 == 0, j % 6 == 1, j % 6 == 2};
      sd_cross(e, f->arm + 3 * first, on + 3);
    }
    assert_int_equal(move(f, A, F, 0, 1e-9), SD_OK);
    memcpy(N + size * j, f->V, sizeof(double) * (size_t) size);
    memset(on, 0, 6 * sizeof(double));
  }
  return N;
}

/* C += V V^T, V = N f of the bodies' forces that F [spheres] makes */
static void add_square(const sd_bodies *A, const double *N, const double *F, double *C)
{
  const int size = 6 * A->shaped;
  double f[6 * MOST], V[6 * MOST];
  sd_rigid_collect(&A->spheres, F, A->shaped, f);
  for (int p = 0; p < size; p++) {
    V[p] = 0.0;
    for (int q = 0; q < size; q++) V[p] += N[size * p + q] * f[q];
  }
  for (int p = 0; p < size; p++)
    for (int q = 0; q < size; q++) C[size * p + q] += V[p] * V[q];
}

/* Covariance of the velocities less N, over the root of the diagonal of N */
static double worst_of(blob_flock *f, const sd_bodies *A)
{
  const int size = 6 * A->shaped, rows = (int) sd_bodies_rows(A), n = A->spheres.n;
  double *N = mobility_of(f, A), *C = calloc((size_t) (size * size), sizeof(double)), worst = 0.0;
  double *w = calloc((size_t) rows, sizeof(double)), F[6 * MOST];
  sd_bodies_noise noise = {0};
  sd_noise_report report;
  for (int j = 0; j < rows; j++) {
    w[j] = 1.0;
    assert_int_equal(sd_bodies_draw(&noise, A, A->body, w, 1e-8, F, &report), SD_OK);
    w[j] = 0.0;
    add_square(A, N, F, C);
  }
  for (unit_normals u = {n, 0}; A->tie && u.unit < 12 * n * n; u.unit++) {
    memset(F, 0, sizeof F);
    assert_int_equal(sd_lubrication_noise(A->tie->L, unit_of_pair, &u, F), SD_OK);
    add_square(A, N, F, C);
  }
  for (int p = 0; p < size; p++)
    for (int q = 0; q < size; q++)
      worst = fmax(worst, fabs(C[size * p + q] - N[size * p + q]) /
                       sqrt(N[(size + 1) * p] * N[(size + 1) * q]));
  sd_bodies_noise_free(&noise);
  free(N), free(C), free(w);
  return worst;
}

static const double THREE[9] = {0, 0, 0, 2.15, 0.1, 0, 0.3, 1.5, 1.3}, RADII[3] = {1.0, 1.1, 0.8};

static void free_spheres_have_the_covariance_of_their_mobility(void **state)
{
  (void) state;
  blob_flock *f = free_spheres(12, 3, THREE, RADII);
  const sd_bodies A = place(f, 0.0, 0.0);
  make_roots(f);
  assert_true(worst_of(f, &A) < 1e-7);
  blob_flock_free(f);
}

static void films_take_their_part(void **state)
{
  (void) state;
  blob_flock *f = free_spheres(12, 3, THREE, RADII);
  sd_bodies A = place(f, 0.0, 0.0);
  make_roots(f);
  tie_with_films(f, &A);
  assert_true(worst_of(f, &A) < 1e-7);
  blob_flock_free(f);
}

/* Two dumbbells at a gap of 0.05, the second turned */
static void clumps_have_the_covariance_of_their_mobility(void **state)
{
  (void) state;
  static const double X[6] = {0, 0, 0, 2, 0, 0}, centre[6] = {0, 0, 0, 0.3, 2.1, 0.2};
  double R[18] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, turn[3] = {0.3, -0.2, 0.5};
  sd_rotation(turn, R + 9);
  blob_flock *f = clumps_at(12, 2, 2, X, R, centre);
  sd_bodies A = place(f, 0.0, 0.0);
  make_roots(f);
  tie_with_films(f, &A);
  assert_true(worst_of(f, &A) < 1e-7);
  blob_flock_free(f);
}

/* 30 spheres at a volume fraction of 0.45 */
static blob_flock *dense(sd_bodies *A)
{
  scene s = cloud_dense(30, 0.45, 1.0, 1.0, 1.0, 3);
  blob_flock *f = free_spheres(12, s.n, s.x, NULL);
  *A = place(f, 0.0, 0.0);
  make_roots(f);
  scene_free(&s);
  return f;
}

/* The variance of every mode of the resistance, by what more products would change in it */
static void every_mode_is_right_at_the_default_tolerance(void **state)
{
  (void) state;
  enum { DRAWS = 12 };
  sd_bodies A;
  blob_flock *f = dense(&A);
  const int size = 6 * A.shaped, rows = (int) sd_bodies_rows(&A);
  double *N = mobility_of(f, &A), *sum = calloc((size_t) size, sizeof(double));
  double *w = malloc(sizeof(double) * (size_t) rows), F[6 * MOST], exact[6 * MOST];
  double *L = malloc(sizeof(double) * (size_t) (size * size)), worst = 0.0;
  sd_bodies_noise noise = {0};
  sd_noise_report report;
  int products = 0;
  memcpy(L, N, sizeof(double) * (size_t) (size * size));
  assert_int_equal(sd_symmetric_root(size, L), SD_OK);
  for (int k = 0; k < DRAWS; k++) {
    const sd_random_key key = {3, SD_RANDOM_SPHERE, (uint64_t) k};
    sd_random_normals(&key, 1, rows, w);
    assert_int_equal(sd_bodies_draw(&noise, &A, A.body, w, 1e-3, F, &report), SD_OK);
    if (report.products > products) products = report.products;
    assert_int_equal(sd_bodies_draw(&noise, &A, A.body, w, 1e-6, exact, &report), SD_OK);
    for (int p = 0; p < size; p++) { /* N^1/2 F has the covariance 1 */
      double now = 0.0, better = 0.0;
      for (int q = 0; q < size; q++) {
        now += L[size * p + q] * F[q];
        better += L[size * p + q] * exact[q];
      }
      sum[p] += (now * now - better * better) / DRAWS;
    }
  }
  for (int p = 0; p < size; p++) worst = fmax(worst, fabs(sum[p]));
  assert_true(worst < 0.015);
  assert_in_range(products, 10, 26);
  sd_bodies_noise_free(&noise);
  free(N), free(L), free(sum), free(w);
  blob_flock_free(f);
}

/* Other blocks, the same covariance: by the diagonal alone it takes more products. */
static void blocks_save_products_and_change_nothing(void **state)
{
  (void) state;
  blob_flock *f = free_spheres(12, 3, THREE, RADII);
  const sd_bodies A = place(f, 0.0, 0.0);
  double w[108], F[18];
  const sd_random_key key = {3, SD_RANDOM_SPHERE, 1};
  sd_bodies_noise noise = {0};
  sd_noise_report by_diagonal, by_blocks;
  sd_random_normals(&key, 1, 108, w);
  assert_int_equal(sd_bodies_draw(&noise, &A, A.body, w, 1e-3, F, &by_diagonal), SD_OK);
  assert_true(worst_of(f, &A) < 1e-7);
  make_roots(f);
  assert_int_equal(sd_bodies_draw(&noise, &A, A.body, w, 1e-3, F, &by_blocks), SD_OK);
  assert_true(2 * by_blocks.products < by_diagonal.products);
  sd_bodies_noise_free(&noise);
  blob_flock_free(f);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(free_spheres_have_the_covariance_of_their_mobility),
      cmocka_unit_test(films_take_their_part),
      cmocka_unit_test(clumps_have_the_covariance_of_their_mobility),
      cmocka_unit_test(every_mode_is_right_at_the_default_tolerance),
      cmocka_unit_test(blocks_save_products_and_change_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
