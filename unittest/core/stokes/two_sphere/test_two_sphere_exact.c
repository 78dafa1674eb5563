/* sd_two_sphere_exact.h: against computations by another elimination, and against what others
 * have published. */
#include "check.h"
#include "table.h"

#include "sd_constants.h"
#include "sd_two_sphere_exact.h"
#include "sd_two_sphere_near.h"

static double scaled(char kind, double a, double b, double R)
{
  const double s = a + b;
  return R / (kind == 'A' ? 3.0 * SD_PI * s : SD_PI * s * s * (kind == 'B' ? 1.0 : s));
}

/* the scalars in the order of the tables: XA YA YB XC YC */
enum { SCALARS = 16 };
static const char *const names[SCALARS] = {"XA11", "XA12", "XA22", "YA11", "YA12", "YA22",
                                           "YB11", "YB12", "YB21", "YB22", "XC11", "XC12",
                                           "XC22", "YC11", "YC12", "YC22"};

static void scalars(double a1, double a2, double gap, double s[SCALARS], double *asymmetry)
{
  const double a[2] = {a1, a2};
  const sd_pair_resistance R = sd_two_sphere_exact(a1, a2, gap, asymmetry);
  const double raw[SCALARS] = {R.XA[0], R.XA[1], R.XA[2], R.YA[0], R.YA[1], R.YA[2],
                               R.YB[0], R.YB[1], R.YB[2], R.YB[3], R.XC[0], R.XC[1],
                               R.XC[2], R.YC[0], R.YC[1], R.YC[2]};
  for (int k = 0; k < SCALARS; k++)
    s[k] = scaled(names[k][1], a[names[k][2] - '1'], a[names[k][3] - '1'], raw[k]);
}

/* 1e-10 of every function from gaps of 1e-4 on, 1e-8 below. The table itself is less sure of small
 * numbers beside large ones: 5 of its own asymmetries of the largest across the axis. */
static void table_of_another_computation(void **state)
{
  (void) state;
  table t = table_open("two_sphere/resistance.csv");
  int rows = 0;
  while (table_next(&t)) {
    double s[SCALARS], largest = 0.0, asymmetry;
    const double ratio = table_number(&t, 0), gap = table_number(&t, 1);
    scalars(1.0, ratio, gap, s, &asymmetry);
    for (int k = 3; k < SCALARS; k++) largest = fmax(largest, fabs(s[k]));
    for (int k = 0; k < SCALARS; k++) {
      const double expected = table_number(&t, 3 + k), relative = gap < 9e-5 ? 1e-8 : 1e-10;
      CHECK_NEAR(s[k], expected, relative * fabs(expected) + 5 * table_number(&t, 19) * largest);
    }
    assert_true(asymmetry < (gap < 9e-5 ? 1e-8 : 1e-11));
    rows++;
  }
  assert_int_equal(rows, 92);
}

/* A table of ratio, gap and 16 numbers in units, from the column `first` on, to a relative
 * tolerance; numbers below `small` of their scale count as that. Returns the asymmetry. */
static double same_row(const table *t, int first, double tolerance, double small)
{
  const double ratio = table_number(t, 0), a[2] = {1.0, ratio};
  double s[SCALARS], asymmetry;
  scalars(1.0, ratio, table_number(t, 1), s, &asymmetry);
  for (int k = 0; k < SCALARS; k++) {
    const double expected =
        scaled(names[k][1], a[names[k][2] - '1'], a[names[k][3] - '1'], table_number(t, first + k));
    CHECK_NEAR(s[k], expected, tolerance * fmax(fabs(expected), small));
  }
  return asymmetry;
}

/* Rounding and the end of the sums: 1e-10 of every function for gaps from 1e-4 on, 1e-8 below. */
static void same_in_quadruple_precision(void **state)
{
  (void) state;
  table t = table_open("two_sphere/resistance_quad.csv");
  int rows = 0;
  for (; table_next(&t); rows++) {
    const double tolerance = table_number(&t, 1) < 9e-5 ? 1e-8 : 1e-10;
    assert_true(same_row(&t, 2, tolerance, 1e-3) < tolerance);
  }
  assert_int_equal(rows, 16);
}

/* Lamb's solution knows no bispherical coordinates. */
static void lamb(void **state)
{
  (void) state;
  table t = table_open("two_sphere/lamb.csv");
  int rows = 0;
  for (; table_next(&t); rows++) same_row(&t, 3, 3.0 * table_number(&t, 2), 0.1);
  assert_int_equal(rows, 2);
}

/* Two spheres falling along their line, by stream functions (Stimson & Jeffery 1926): force over
 * that of one alone, and both by multipoles across it; from a computation outside this project. */
static void both_move_alike(void **state)
{
  (void) state;
  table t = table_open("two_spheres_unequal.csv");
  int rows = 0;
  while (table_next(&t)) {
    const double ratio = table_number(&t, 0), R = table_number(&t, 2), p6 = 6.0 * SD_PI;
    const sd_pair_resistance r = sd_two_sphere_exact(1.0, ratio, R - 1.0 - ratio, NULL);
    CHECK_NEAR((r.XA[0] + r.XA[1]) / p6, table_number(&t, 3), 2e-9);
    CHECK_NEAR((r.XA[1] + r.XA[2]) / (p6 * ratio), table_number(&t, 4), 2e-9);
    rows++;
    if (!*t.column[5]) continue;
    const double F[2] = {r.YA[0] + r.YA[1], r.YA[1] + r.YA[2]};
    CHECK_NEAR(F[0] / p6, table_number(&t, 5), 1e-7);
    CHECK_NEAR(F[1] / p6, table_number(&t, 6), 1e-7);
    /* free to turn: T = YB (1 1) + YC W = 0 */
    const double T[2] = {r.YB[0] + r.YB[1], r.YB[2] + r.YB[3]};
    const double det = r.YC[0] * r.YC[2] - r.YC[1] * r.YC[1];
    const double W[2] = {(r.YC[1] * T[1] - r.YC[2] * T[0]) / det,
                         (r.YC[1] * T[0] - r.YC[0] * T[1]) / det};
    CHECK_NEAR((F[0] + r.YB[0] * W[0] + r.YB[2] * W[1]) / p6, table_number(&t, 7), 1e-7);
    CHECK_NEAR((F[1] + r.YB[1] * W[0] + r.YB[3] * W[1]) / p6, table_number(&t, 8), 1e-7);
  }
  assert_true(rows > 0);
}

/* What is left at contact when all that grows is taken off, ratios 1/2, 1, 2: the constants of
 * Jeffrey & Onishi (1984 print four digits of some: 0.9954, 0.9983), here as computed by another
 * program; those of rotation about the line are closed, 7 zeta(3)/8 and -zeta(3)/8. */
static void constants_at_contact(void **state)
{
  (void) state;
  static const struct {
    int scalar;
    double value[3];
  } left[] = {{0, {1.08807, 0.99536, 0.80831}},  {1, {-0.29573, -0.35022, -0.29573}},
              {3, {1.01932, 0.99832, 0.90089}},  {4, {-0.22456, -0.27366, -0.22456}},
              {6, {0.12004, 0.23897, 0.40156}},  {7, {0.08176, -0.00167, -0.06855}},
              {10, {1.02078, 1.05180, 1.09405}}, {11, {-0.10553, -0.15026, -0.10553}},
              {13, {0.84894, 0.70285, 0.48406}}, {14, {-0.03486, -0.02743, -0.03486}}};
  const double ratio[3] = {0.5, 1.0, 2.0}, xi = 2e-6, zeta3 = 1.2020569031595942;
  for (int r = 0; r < 3; r++) {
    const double a[2] = {1.0, ratio[r]};
    double s[SCALARS], near[SCALARS];
    scalars(1.0, ratio[r], 0.5 * xi * (1.0 + ratio[r]), s, NULL);
    const sd_pair_resistance N = sd_two_sphere_near(1.0, ratio[r], xi);
    memcpy(near, &N, sizeof near);
    for (size_t k = 0; k < sizeof left / sizeof *left; k++) {
      const int f = left[k].scalar;
      const double pole = scaled(names[f][1], a[names[f][2] - '1'], a[names[f][3] - '1'], near[f]);
      CHECK_NEAR(s[f] - pole, left[k].value[r], 1.2e-5);
    }
    if (r == 1) CHECK_NEAR(s[10], 7.0 * zeta3 / 8.0, 1e-5);
    if (r == 1) CHECK_NEAR(s[11], -zeta3 / 8.0, 1e-5);
  }
}

/* Far apart the RPY model is exact but for the stresslets: a fourth power of the distance. */
static void far_apart_as_rpy(void **state)
{
  (void) state;
  double D[2];
  for (int k = 0; k < 2; k++) {
    const double R = k ? 200.0 : 100.0;
    D[k] = sd_two_sphere_exact(1.0, 2.5, R - 3.5, NULL).XA[0] -
        sd_pair_resistance_rpy(1.0, 2.5, R).XA[0];
  }
  assert_true(D[1] > 0.0);
  CHECK_NEAR(log2(D[0] / D[1]), 4.0, 0.02);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(table_of_another_computation),
      cmocka_unit_test(same_in_quadruple_precision),
      cmocka_unit_test(lamb),
      cmocka_unit_test(both_move_alike),
      cmocka_unit_test(constants_at_contact),
      cmocka_unit_test(far_apart_as_rpy),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
