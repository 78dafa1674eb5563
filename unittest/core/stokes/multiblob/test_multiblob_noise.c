/* Random slip of the points of spheres as shells: that the velocities which follow from it have the
 * covariance of the mobility, without sampling. */
#include "blob_flock.h"

#include "clouds.h"
#include "unit_normals.h"

#include "sd_bodies_noise.h"
#include "sd_lubrication_noise.h"
#include "sd_pose.h"
#include "sd_random.h"

/* Roots of the whole matrix, or (split) of the near part */
typedef struct {
  sd_body_root lone, shape;
  const sd_body_root *of[MOST];
} block_roots;

static block_roots *roots_of(const blob_flock *f, const sd_bodies *A, const sd_ewald *split)
{
  block_roots *r = calloc(1, sizeof(block_roots));
  assert_int_equal(sd_body_root_create(&f->lone.points, 1.0, split, &r->lone), SD_OK);
  if (f->m) assert_int_equal(sd_body_root_create(&f->shape.points, 1.0, split, &r->shape), SD_OK);
  for (int b = 0; b < A->shaped; b++) r->of[b] = f->m ? &r->shape : &r->lone;
  return r;
}

static void roots_free(block_roots *r)
{
  sd_body_root_free(&r->lone);
  sd_body_root_free(&r->shape);
  free(r);
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

static void add_square(int size, const double *V, double *C)
{
  for (int p = 0; p < size; p++)
    for (int q = 0; q < size; q++) C[size * p + q] += V[p] * V[q];
}

/* Covariance of the velocities less N, over the root of the diagonal of N: of unit numbers of the points, and of
 * films */
static double worst_of(blob_flock *f, const sd_bodies *A, const block_roots *r, double tolerance)
{
  const int size = 6 * A->shaped, rows = (int) sd_bodies_unknowns(A), n = A->spheres.n;
  double *N = mobility_of(f, A), *C = calloc((size_t) (size * size), sizeof(double)), worst = 0.0;
  double *w = calloc((size_t) rows, sizeof(double)), F[6 * MOST] = {0.0};
  const sd_bodies_blocks blocks = {A->body, r->of};
  sd_bodies_noise noise = {0};
  sd_noise_report report;
  for (int j = 0; j < rows; j++) {
    w[j] = 1.0;
    assert_int_equal(sd_bodies_draw(&noise, A, &blocks, w, 1e-8, f->u, &report), SD_OK);
    w[j] = 0.0;
    assert_int_equal(move(f, A, F, 0, tolerance), SD_OK);
    add_square(size, f->V, C);
  }
  memset(f->u, 0, sizeof f->u);
  for (unit_normals u = {n, 0}; A->tie && u.unit < 12 * n * n; u.unit++) {
    memset(F, 0, sizeof F);
    assert_int_equal(sd_lubrication_noise(A->tie->L, unit_of_pair, &u, F), SD_OK);
    assert_int_equal(move(f, A, F, 0, tolerance), SD_OK);
    add_square(size, f->V, C);
  }
  for (int p = 0; p < size; p++)
    for (int q = 0; q < size; q++)
      worst = fmax(worst, fabs(C[size * p + q] - N[size * p + q]) /
                       sqrt(N[(size + 1) * p] * N[(size + 1) * q]));
  sd_bodies_noise_free(&noise);
  free(N), free(C), free(w);
  return worst;
}

static double worst_with_roots(blob_flock *f, const sd_bodies *A)
{
  block_roots *r = roots_of(f, A, NULL);
  const double worst = worst_of(f, A, r, 1e-9);
  roots_free(r);
  return worst;
}

static const double THREE[9] = {0, 0, 0, 2.15, 0.1, 0, 0.3, 1.5, 1.3}, RADII[3] = {1.0, 1.1, 0.8};

static void free_spheres_have_the_covariance_of_their_mobility(void **state)
{
  (void) state;
  blob_flock *f = free_spheres(12, 3, THREE, RADII);
  const sd_bodies A = place(f, 0.0, 0.0);
  assert_true(worst_with_roots(f, &A) < 1e-7);
  blob_flock_free(f);
}

static void films_take_their_part(void **state)
{
  (void) state;
  blob_flock *f = free_spheres(12, 3, THREE, RADII);
  sd_bodies A = place(f, 0.0, 0.0);
  tie_with_films(f, &A);
  assert_true(worst_with_roots(f, &A) < 1e-7);
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
  tie_with_films(f, &A);
  assert_true(worst_with_roots(f, &A) < 1e-7);
  blob_flock_free(f);
}

/* 30 spheres at a volume fraction of 0.45 */
static blob_flock *dense(sd_bodies *A)
{
  scene s = cloud_dense(30, 0.45, 1.0, 1.0, 1.0, 3);
  blob_flock *f = free_spheres(12, s.n, s.x, NULL);
  *A = place(f, 0.0, 0.0);
  scene_free(&s);
  return f;
}

/* The variance of every mode of the mobility as a step has it, by what better roots and solves would change in it */
static void every_mode_is_right_at_the_default_tolerance(void **state)
{
  (void) state;
  enum { DRAWS = 12 };
  sd_bodies A;
  blob_flock *f = dense(&A);
  block_roots *r = roots_of(f, &A, NULL);
  const sd_bodies_blocks blocks = {A.body, r->of};
  const int size = 6 * A.shaped, rows = (int) sd_bodies_unknowns(&A);
  double *R = mobility_of(f, &A), *sum = calloc((size_t) size, sizeof(double));
  double *w = malloc(sizeof(double) * (size_t) rows), F[6 * MOST] = {0.0}, V[2][6 * MOST], worst = 0.0;
  sd_bodies_noise noise = {0};
  sd_noise_report report;
  int products = 0, solve = 0;
  assert_int_equal(sd_cholesky(size, R), SD_OK);
  assert_int_equal(sd_cholesky_inverse(size, R), SD_OK);
  assert_int_equal(sd_symmetric_root(size, R), SD_OK);
  for (int k = 0; k < DRAWS; k++) {
    const sd_random_key key = {3, SD_RANDOM_SPHERE, (uint64_t) k};
    sd_random_normals(&key, 1, rows, w);
    for (int sharp = 0; sharp < 2; sharp++) {
      const double tolerance = sharp ? 1e-6 : 0.01 / 3.0;
      assert_int_equal(sd_bodies_draw(&noise, &A, &blocks, w, tolerance, f->u, &report), SD_OK);
      assert_int_equal(move(f, &A, F, 0, tolerance), SD_OK);
      if (!sharp && report.products > products) products = report.products;
      if (!sharp && f->report.products > solve) solve = f->report.products;
      for (int p = 0; p < size; p++) { /* R^1/2 V has the covariance 1 */
        V[sharp][p] = 0.0;
        for (int q = 0; q < size; q++) V[sharp][p] += R[size * p + q] * f->V[q];
      }
    }
    for (int p = 0; p < size; p++) sum[p] += (V[0][p] * V[0][p] - V[1][p] * V[1][p]) / DRAWS;
  }
  for (int p = 0; p < size; p++) worst = fmax(worst, fabs(sum[p]));
  assert_true(worst < 0.01);
  assert_in_range(products, 10, 20);
  assert_in_range(solve, 5, 12);
  sd_bodies_noise_free(&noise);
  roots_free(r);
  free(R), free(sum), free(w);
  blob_flock_free(f);
}

/* Other blocks, the same covariance: by the diagonal alone it takes more products. */
static void blocks_save_products_and_change_nothing(void **state)
{
  (void) state;
  blob_flock *f = free_spheres(12, 3, THREE, RADII);
  const sd_bodies A = place(f, 0.0, 0.0);
  double w[108], y[108];
  const sd_random_key key = {3, SD_RANDOM_SPHERE, 1};
  sd_bodies_noise noise = {0};
  sd_noise_report by_diagonal, by_blocks;
  block_roots none = {.of = {NULL}}, *roots = roots_of(f, &A, NULL);
  const sd_bodies_blocks diagonal = {A.body, none.of}, blocks = {A.body, roots->of};
  sd_random_normals(&key, 1, 108, w);
  assert_int_equal(sd_bodies_draw(&noise, &A, &diagonal, w, 1e-3, y, &by_diagonal), SD_OK);
  assert_true(worst_of(f, &A, &none, 1e-9) < 1e-7);
  assert_int_equal(sd_bodies_draw(&noise, &A, &blocks, w, 1e-3, y, &by_blocks), SD_OK);
  assert_true(2 * by_blocks.products < by_diagonal.products);
  sd_bodies_noise_free(&noise);
  roots_free(roots);
  blob_flock_free(f);
}

/* The root of a body's near block is that of what the engine's near part does to it alone in a large box, so
 * that the process ends at once. */
static void near_blocks_are_those_of_the_engine(void **state)
{
  (void) state;
  const double x[3] = {7.0, 6.0, 8.0}, a[1] = {1.1};
  blob_flock *f = free_spheres(12, 1, x, a);
  sd_ewald split;
  const sd_ewald_box box = {.periodic = 1, .edge = {14.0, 14.0, 14.0}};
  sd_bodies A = place(f, 14.0, 1e-6);
  sd_ewald_sizes sizes = periodic_sizes(f->s->b, 12);
  sizes.all.count *= 1e3; /* of a box so filled */
  assert_int_equal(sd_ewald_choose_positive(&box, &sizes, 3, 1e-4, SD_EWALD_POSITIVE_ADDITION, &split), SD_OK);
  split.count = 12;
  periodic_free(&f->p);
  periodic_place(&f->p, f->s->at, f->s->b, NULL, 12, 3, &split);
  A.apply = sd_mobility_apply_rest;
  assert_true(sd_mobility_divides(&f->p.omega));
  sd_body_root root;
  assert_int_equal(sd_body_root_create(&f->lone.points, 1.1, &split, &root), SD_OK);
  assert_int_equal(root.n, 36);
  const sd_body_root *of[1] = {&root};
  const sd_bodies_blocks blocks = {A.body, of};
  double w[36], y[36];
  const sd_random_key key = {3, SD_RANDOM_SPHERE, 1};
  sd_bodies_noise noise = {0};
  sd_noise_report report;
  sd_random_normals(&key, 1, 36, w);
  assert_int_equal(sd_bodies_draw(&noise, &A, &blocks, w, 1e-3, y, &report), SD_OK);
  assert_in_range(report.products, 1, 2);
  sd_bodies_noise_free(&noise);
  sd_body_root_free(&root);
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
      cmocka_unit_test(near_blocks_are_those_of_the_engine),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
