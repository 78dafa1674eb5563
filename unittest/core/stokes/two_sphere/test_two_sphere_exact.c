/* sd_two_sphere_exact.h: against computations by another elimination, and against what others
 * have published. */
#include "check.h"
#include "table.h"

#include "sd_constants.h"
#include "sd_two_sphere_exact.h"

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
 * numbers beside large ones: allowed are 5 of its own asymmetries of the largest across the axis. */
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
      CHECK_NEAR(s[k], expected,
                 relative * fabs(expected) + 5 * table_number(&t, 19) * largest);
    }
    assert_true(asymmetry < (gap < 9e-5 ? 1e-8 : 1e-11));
    rows++;
  }
  assert_int_equal(rows, 92);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(table_of_another_computation),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
