/* Blocks of a body above a wall. */
#include "check.h"

#include <string.h>

#include "sd_body_shape.h"
#include "sd_constants.h"
#include "sd_linear.h"
#include "sd_product.h"

enum { M = 5, SIZE = 6 * M };

static const double x[3 * M] = {0.0, 0.3, 1.4, 1.9, 0.1, 1.2, 0.4, 2.0, 0.8, -1.2, 0.6, 1.5, 0.2, 0.5, 3.1};
static const double a[M] = {1.0, 0.8, 1.0, 0.6, 0.9}; /* the third cuts the wall */
static const sd_wall ground = {.axis = 2, .sign = 1};

/* Products with unit vectors, and the diagonal */
static void matrix_is_that_of_the_product(void **state)
{
  (void) state;
  for (int width = 3; width <= 6; width += 3) {
    const int n = width * M;
    const sd_law law = {.tensor = SD_TENSOR_RPY, .wall = ground};
    const double w[M] = {1, 1, 1, 1, 1};
    double A[SIZE * SIZE], F[SIZE], u[SIZE];
    sd_packed p = {0};
    sd_wall_matrix(&ground, M, width, x, a, A);
    assert_int_equal(sd_packed_all(&p, SD_ISA_BEST, &law, &(sd_spheres){x, a, w}, M, width), SD_OK);
    for (int q = 0; q < n; q++) {
      memset(F, 0, sizeof F);
      F[q] = 1.0;
      sd_packed_share(&p, 0, 1, F, u);
      const double b = a[q / width];
      u[q] += 1.0 / (q % width < 3 ? 6.0 * SD_PI * b : 8.0 * SD_PI * b * b * b);
      for (int k = 0; k < n; k++) CHECK_NEAR(A[k * n + q], u[k], 1e-15);
    }
    sd_packed_free(&p);
  }
}

/* A lone sphere is its own 6x6: pushed along the wall it turns */
static void lone_sphere_moves_by_its_closed_form(void **state)
{
  (void) state;
  const double z = 1.3, s = 1.0 / z, at[3] = {0.2, -0.4, z}, one = 1.0;
  sd_body_shape shape;
  assert_int_equal(sd_body_wall_shape(&ground, 1, 6, at, &one, at, &shape), SD_OK);
  const double *N = shape.mobility;
  CHECK_NEAR(6.0 * SD_PI * N[0], 1.0 - 9.0 / 16.0 * s + pow(s, 3) / 8.0 - pow(s, 5) / 16.0, 1e-14);
  CHECK_NEAR(6.0 * SD_PI * N[14], 1.0 - 9.0 / 8.0 * s + pow(s, 3) / 2.0 - pow(s, 5) / 8.0, 1e-14);
  CHECK_NEAR(8.0 * SD_PI * N[24], pow(s, 4) / 8.0, 1e-14);
  CHECK_NEAR(8.0 * SD_PI * N[9], -pow(s, 4) / 8.0, 1e-14);
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 6; q++) {
      double one_there = 0.0;
      for (int k = 0; k < 6; k++) one_there += N[6 * p + k] * shape.resistance[6 * k + q];
      CHECK_NEAR(one_there, p == q, 1e-13);
      CHECK_NEAR(shape.rigid[6 * p + q], shape.inverse[6 * p + q], 1e-15);
    }
  sd_body_shape_free(&shape);
}

/* As a body whose centre is a length d below it: a force there has the torque d F on the sphere */
static void sphere_off_the_centre_moves_it_more(void **state)
{
  (void) state;
  const double d = 0.7, a = 1.2, at[3] = {0.0, 0.0, d};
  double M[36] = {0.0};
  for (int p = 0; p < 6; p++) M[7 * p] = 1.0 / (p < 3 ? 6.0 * SD_PI * a : 8.0 * SD_PI * a * a * a);
  sd_body_shape shape;
  assert_int_equal(sd_body_shape_of(1, 6, at, &a, M, &shape), SD_OK);
  CHECK_NEAR(shape.mobility[0], M[0] + d * d * M[21], 1e-15);
  CHECK_NEAR(shape.mobility[14], M[0], 1e-15);
  sd_body_shape_free(&shape);
}

/* Far from the wall the blocks are those of open space, and before that they are worth no more */
static void blocks_are_made_where_they_pay(void **state)
{
  (void) state;
  double far[3 * M], middle[3] = {0.0, 0.0, 1e9};
  sd_body_shape here, open;
  for (int k = 0; k < 3 * M; k++) far[k] = x[k] + middle[k % 3];
  double A[SIZE * SIZE];
  assert_int_equal(sd_body_wall_shape(&ground, M, 6, far, a, middle, &here), SD_OK);
  sd_wall_matrix(NULL, M, 6, x, a, A);
  assert_int_equal(sd_body_shape_of(M, 6, x, a, A, &open), SD_OK);
  for (int e = 0; e < 36; e++) CHECK_NEAR(here.resistance[e], open.resistance[e], 1e-5);
  sd_body_shape_free(&here);
  sd_body_shape_free(&open);
  assert_true(sd_body_wall_pays(12, 1, 2.0, 1.0) && !sd_body_wall_pays(12, 1, 10.5, 1.0));
  assert_true(!sd_body_wall_pays(240, 10, 2.0, 1.0) && sd_body_wall_pays(240, 100, 2.0, 1.0));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(matrix_is_that_of_the_product),
      cmocka_unit_test(lone_sphere_moves_by_its_closed_form),
      cmocka_unit_test(sphere_off_the_centre_moves_it_more),
      cmocka_unit_test(blocks_are_made_where_they_pay),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
