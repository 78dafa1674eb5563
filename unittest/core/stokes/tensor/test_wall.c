/* The image parts of a plane wall against tables of another code, and what they must be by physics. */
#include "table.h"

#include "sd_tensor.h"
#include "sd_wall.h"

static const sd_wall floor_at_0 = {2, 1, 0.0};

/* The whole 6x6 block, heights clamped, for eta = 1 */
static void whole_block(const sd_wall *wall, const double *xi, double a, const double *xj, double b,
                        double M[36])
{
  double image[36], at_i[3], at_j[3], r[3];
  memcpy(at_i, xi, sizeof at_i);
  memcpy(at_j, xj, sizeof at_j);
  at_i[wall->axis] = wall->at + wall->sign * fmax(sd_wall_height(wall, xi), a);
  at_j[wall->axis] = wall->at + wall->sign * fmax(sd_wall_height(wall, xj), b);
  for (int d = 0; d < 3; d++) r[d] = at_i[d] - at_j[d];
  sd_tensor_grand(r, a, b, 1.0, M);
  sd_wall_block(wall, 6, xi, a, xj, b, image);
  for (int e = 0; e < 36; e++) M[e] += image[e];
}

/* Largest error of the 3x3 part of M against that of the reference, over the largest number of it or
 * of its free part */
static double error_of_part(const double *M, const double *expected, const double *only_free, int row,
                            int column)
{
  double worst = 0.0, largest = 0.0;
  for (int p = row; p < row + 3; p++)
    for (int q = column; q < column + 3; q++) {
      worst = fmax(worst, fabs(M[6 * p + q] - expected[6 * p + q]));
      largest = fmax(largest, fmax(fabs(expected[6 * p + q]), fabs(only_free[6 * p + q])));
    }
  return worst / largest;
}

/* Radii to 1:100, apart, overlapping, contained, touching the wall. Free and image part cancel for
 * spheres far apart along the wall: the error is of the size of the two, not of what is left. */
static void pairs_are_those_of_another_code(void **state)
{
  (void) state;
  double worst = 0.0;
  int pairs = 0;
  for (table t = table_open("walls/pairs.csv"); table_next(&t); pairs++) {
    double c[56], M[36], own[36], r[3], only_free[36];
    for (int k = 2; k < 56; k++) c[k] = table_number(&t, k);
    const double a[2] = {c[2], c[3]}, *x[2] = {c + 4, c + 7};
    whole_block(&floor_at_0, x[0], a[0], x[1], a[1], M);
    for (int d = 0; d < 3; d++) r[d] = x[0][d] - x[1][d];
    sd_tensor_grand(r, a[0], a[1], 1.0, only_free);
    for (int part = 0; part < 4; part++)
      worst = fmax(worst,
                   error_of_part(M, c + 10, only_free, 3 * (part / 2), 3 * (part % 2)));
    for (int k = 0; k < 2; k++) {
      const double *self = c + 46 + 5 * k;
      whole_block(&floor_at_0, x[k], a[k], x[k], a[k], own);
      CHECK_NEAR(own[0] / self[0], 1.0, 1e-13);
      CHECK_NEAR(own[14] / self[1], 1.0, 1e-13);
      CHECK_NEAR(own[4], self[2], 1e-13 * sqrt(self[0] * self[3]));
      CHECK_NEAR(own[21] / self[3], 1.0, 1e-13);
      CHECK_NEAR(own[35] / self[4], 1.0, 1e-13);
    }
  }
  assert_int_equal(pairs, 32);
  CHECK_NEAR(worst, 0.0, 1e-13);
}

/* Polynomials in s = a/z of a lone sphere */
static void lone_sphere_has_its_closed_form(void **state)
{
  (void) state;
  for (double z = 0.7; z < 60.0; z *= 1.7) {
    const double a = 0.7, s = a / z, s3 = s * s * s, x[3] = {0.3, -0.2, z};
    double M[36];
    whole_block(&floor_at_0, x, a, x, a, M);
    const double U = 6.0 * SD_PI * a, UW = 8.0 * SD_PI * a * a, W = 8.0 * SD_PI * a * a * a;
    CHECK_NEAR(U * M[0], 1.0 - 9.0 / 16.0 * s + s3 / 8.0 - s3 * s * s / 16.0, 1e-15);
    CHECK_NEAR(U * M[14], 1.0 - 9.0 / 8.0 * s + s3 / 2.0 - s3 * s * s / 8.0, 1e-15);
    CHECK_NEAR(UW * M[4], s3 * s / 8.0, 1e-15);
    CHECK_NEAR(UW * M[9], -s3 * s / 8.0, 1e-15);
    CHECK_NEAR(W * M[21], 1.0 - 5.0 / 16.0 * s3, 1e-15);
    CHECK_NEAR(W * M[35], 1.0 - s3 / 8.0, 1e-15);
  }
}

/* Of a sphere so small that it is a point of the fluid, on the wall */
static void fluid_rests_on_the_wall(void **state)
{
  (void) state;
  uint64_t seed = 3;
  for (int trial = 0; trial < 100; trial++) {
    const double b = exp(uniform(&seed, -3.0, 3.0)), tiny = 1e-12 * b;
    const double at_wall[3] = {uniform(&seed, -9, 9), uniform(&seed, -9, 9), 0.0};
    const double x[3] = {uniform(&seed, -9, 9), uniform(&seed, -9, 9),
                         b * uniform(&seed, 1.0, 4.0)};
    double r[3], M[36], image[36], largest[2] = {0.0, 0.0};
    for (int d = 0; d < 3; d++) r[d] = at_wall[d] - x[d];
    if (r[0] * r[0] + r[1] * r[1] + r[2] * r[2] < 1.01 * b * b) continue;
    sd_tensor_grand(r, tiny, b, 1.0, M);
    const sd_wall_pair pair = sd_wall_pair_of(at_wall, 0.0, x, b);
    for (int q = 0; q < 6; q++) {
      double FT[6] = {0.0}, UW[6] = {0.0};
      FT[q] = 1.0 / (8.0 * SD_PI);
      sd_wall_pair_add(&pair, 6, FT, UW);
      for (int p = 0; p < 3; p++) image[6 * p + q] = UW[p];
    }
    for (int e = 0; e < 18; e++) largest[e % 6 / 3] = fmax(largest[e % 6 / 3], fabs(M[e]));
    for (int e = 0; e < 18; e++) CHECK_NEAR((M[e] + image[e]) / largest[e % 6 / 3], 0.0, 4e-15);
  }
}

static void images_are_reciprocal(void **state)
{
  (void) state;
  uint64_t seed = 11;
  for (int trial = 0; trial < 200; trial++) {
    const sd_wall wall = {trial % 3, trial % 2 ? 1 : -1, 0.3};
    const double a = exp(uniform(&seed, -3, 3)), b = exp(uniform(&seed, -3, 3));
    double x[2][3], M[2][36];
    for (int k = 0; k < 6; k++) x[k / 3][k % 3] = uniform(&seed, -5, 5);
    for (int k = 0; k < 2; k++)
      x[k][wall.axis] = wall.at + wall.sign * (k ? b : a) * uniform(&seed, 0.6, 4.0);
    sd_wall_block(&wall, 6, x[0], a, x[1], b, M[0]);
    sd_wall_block(&wall, 6, x[1], b, x[0], a, M[1]);
    for (int p = 0; p < 6; p++)
      for (int q = 0; q < 6; q++) {
        const double scale = fmax(fabs(M[0][7 * p]), fabs(M[0][7 * q])) + 1e-3;
        CHECK_NEAR(M[0][6 * p + q], M[1][6 * q + p], 1e-14 * scale);
      }
  }
}

/* The same two spheres at each of the six sides: R M R^T, R the rotation that turns the wall there */
static void six_sides_are_one_scene_turned(void **state)
{
  (void) state;
  const double at[2][3] = {{0.4, -0.3, 1.3}, {-1.1, 0.8, 0.9}}, a = 1.0, b = 0.6;
  double M[36];
  sd_wall_block(&floor_at_0, 6, at[0], a, at[1], b, M);
  for (int side = 0; side < 6; side++) {
    const sd_wall wall = {side / 2, side % 2 ? -1 : 1, 2.5};
    int axis[3];
    double x[2][3], turned[36];
    sd_wall_axes(&wall, axis);
    for (int k = 0; k < 2; k++)
      for (int d = 0; d < 3; d++)
        x[k][axis[d]] = d < 2 ? at[k][d] : wall.at + wall.sign * at[k][d];
    sd_wall_block(&wall, 6, x[0], a, x[1], b, turned);
    for (int p = 0; p < 6; p++)
      for (int q = 0; q < 6; q++) {
        const double sign = (p % 3 == 2) != (q % 3 == 2) ? wall.sign : 1.0;
        const int row = p - p % 3 + axis[p % 3], column = q - q % 3 + axis[q % 3];
        CHECK_NEAR(sign * turned[6 * row + column], M[6 * p + q], 1e-15);
      }
  }
}

/* Smallest eigenvalue above `least` of the matrix scaled to 1 on the diagonal of the free part? */
static int definite(const double *x, const double *a, int n, double least)
{
  const int size = 6 * n;
  double *M = malloc(sizeof(double) * (size_t) (size * size)), B[36];
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      whole_block(&floor_at_0, x + 3 * i, a[i], x + 3 * j, a[j], B);
      for (int p = 0; p < 6; p++)
        for (int q = 0; q < 6; q++) {
          const double own_i = p < 3 ? 6.0 * a[i] : 8.0 * pow(a[i], 3);
          const double own_j = q < 3 ? 6.0 * a[j] : 8.0 * pow(a[j], 3);
          M[size * (6 * i + p) + 6 * j + q] = SD_PI * sqrt(own_i * own_j) * B[6 * p + q];
        }
    }
  const int yes = positive_definite(M, size, least);
  free(M);
  return yes;
}

/* 2 to 15 spheres, radii to 1:100, many overlapping, 40 % touching the wall, a fifth of the sets with
 * spheres that cut it */
static void matrix_is_positive_definite(void **state)
{
  (void) state;
  uint64_t seed = 5;
  for (int set = 0; set < 2000; set++) {
    const int n = 2 + (int) uniform(&seed, 0, 13.99);
    const double spread = uniform(&seed, 0.0, log(100.0)), side = uniform(&seed, 1.0, 6.0);
    double x[45], a[15];
    for (int i = 0; i < n; i++) {
      a[i] = exp(-uniform(&seed, 0.0, spread));
      for (int d = 0; d < 2; d++) x[3 * i + d] = uniform(&seed, 0.0, side);
      x[3 * i + 2] = a[i] + (uniform(&seed, 0, 1) < 0.4 ? 0.0 : uniform(&seed, 0.0, 2.0));
      if (set % 5 == 0) x[3 * i + 2] = a[i] * uniform(&seed, 0.4, 1.4);
    }
    if (!definite(x, a, n, 1e-4)) fail_msg("set %d of %d spheres is not definite", set, n);
  }
}

/* Sheets of 10 x 10 equal spheres that touch the wall, and each other or overlap */
static void sheets_on_the_wall_are_definite(void **state)
{
  (void) state;
  for (int overlap = 0; overlap < 2; overlap++) {
    double x[300], a[100];
    for (int i = 0; i < 100; i++) {
      const double spacing = overlap ? 1.2 : 2.0;
      a[i] = 1.0;
      x[3 * i] = spacing * (i % 10);
      x[3 * i + 1] = spacing * (i / 10);
      x[3 * i + 2] = 1.0;
    }
    assert_true(definite(x, a, 100, overlap ? 1e-3 : 0.1));
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pairs_are_those_of_another_code),
      cmocka_unit_test(lone_sphere_has_its_closed_form),
      cmocka_unit_test(fluid_rests_on_the_wall),
      cmocka_unit_test(images_are_reciprocal),
      cmocka_unit_test(six_sides_are_one_scene_turned),
      cmocka_unit_test(matrix_is_positive_definite),
      cmocka_unit_test(sheets_on_the_wall_are_definite),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
