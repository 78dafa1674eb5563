/* The wave part of a pair: closed forms against the integrals over k that define them. */
#include "check.h"

#include "sd_constants.h"
#include "sd_radial.h"

/* j_l(x)/x^l for l = 0, 1, 2. Below 1.5 the closed forms cancel; the series
 *   sum_k (-x^2/2)^k / (k! (2l + 2k + 1)!!)
 * then needs a dozen terms. */
static void bessel(double x, double *j)
{
  if (x < 1.5) {
    for (int l = 0; l < 3; l++) {
      double term = l == 0 ? 1.0 : l == 1 ? 1.0 / 3.0 : 1.0 / 15.0, sum = term;
      for (int k = 1; k < 16; k++) {
        term *= -0.5 * x * x / (k * (2.0 * l + 2.0 * k + 1.0));
        sum += term;
      }
      j[l] = sum;
    }
    return;
  }
  j[0] = sin(x) / x;
  j[1] = (j[0] - cos(x)) / (x * x);
  j[2] = (3.0 * j[1] - j[0]) / (x * x);
}

/* The integrands are smooth, even in k and fall like exp(-k^2/4 xi^2): equal steps converge faster than
 * any power. With the step dk the functions repeat with period 2 pi/dk in r, so dk keeps the next
 * copy, screened beyond 6.8/xi, away from r. The largest k makes exp(-x) = 1e-20. */
static void integrals(const sd_ewald *e, double r, double *value)
{
  const double most = 2.0 * e->xi * sqrt(46.0);
  const int steps = (int) ceil(most * (r + 8.0 / e->xi) / SD_PI);
  const double dk = most / steps;
  for (int f = 0; f < SD_RADIALS; f++) value[f] = 0.0;
  for (int s = 0; s <= steps; s++) {
    const double k = s * dk, k2 = k * k, weight = (s == 0 ? 0.5 : 1.0) * dk / (2.0 * SD_PI * SD_PI);
    const double H = weight * sd_ewald_wave_screen(e, k2);
    double j[3];
    bessel(k * r, j);
    for (int n = 0; n < 3; n++) {
      const double power = H * pow(k2, n);
      value[SD_I0 + 2 * n] += power * (j[0] - j[1]);
      value[SD_J0 + 2 * n] += power * k2 * j[2];
      if (n < 2) value[SD_K0 + n] += 0.5 * power * k2 * j[1];
    }
  }
}

static void closed_forms_are_the_integrals(void **state)
{
  (void) state;
  for (int with = 0; with < 2; with++)
    for (double z = 0.0; z < 8.0; z += 0.05) {
      const sd_ewald e = {.xi = 0.8, .a_ref = with ? 0.9 : 0.0};
      double D[SD_RADIALS], there[SD_RADIALS], bare[SD_RADIALS];
      integrals(&e, z / e.xi, D);
      integrals(&e, 0.0, bare);
      sd_radial(&e, z / e.xi, there);
      for (int f = 0; f < SD_RADIALS; f++) CHECK_NEAR(there[f], D[f], 4e-15 * fabs(bare[f]));
    }
}

/* Far away the mean of the pair's tensor is all there is, and the tail begins at nothing. */
static void nothing_is_left_out_of_a_wide_range(void **state)
{
  (void) state;
  const sd_ewald near_by = {.xi = 0.8, .a_ref = 0.9, .range = 2.0};
  const sd_ewald wide = {.xi = 0.8, .a_ref = 0.9, .range = 9.0};
  double tail[2][3];
  sd_radial_tail(&near_by, tail[0]);
  sd_radial_tail(&wide, tail[1]);
  for (int n = 0; n < 3; n++) {
    assert_true(fabs(tail[0][n]) > 1e-4);
    CHECK_NEAR(tail[1][n], 0.0, 1e-13);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(closed_forms_are_the_integrals),
      cmocka_unit_test(nothing_is_left_out_of_a_wide_range),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
