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

/* A splitting of so many digits at points (sd_ewald_choose_at_points), for spheres of radius 0.7 */
static sd_ewald at_points(double digits)
{
  sd_ewald e = {.range = 2.3, .a_ref = 0.7};
  e.band = 0.95 * SD_PI * (digits - 0.5) / e.range;
  e.xi = sqrt(0.5 * e.band / e.range);
  return e;
}

/* The near part of a sphere and a point, which stops at the range */
static void a_band_leaves_little_beyond_the_range(void **state)
{
  (void) state;
  for (double digits = 3.0; digits < 13.0; digits++) {
    const sd_ewald e = at_points(digits);
    for (double r = e.range; r < 4.0 * e.range; r += 0.03) {
      const double unit = 1.0 / (8.0 * SD_PI * r), q = e.a_ref * e.a_ref / (r * r);
      double D[SD_RADIALS];
      sd_radial(&e, r, D);
      const double off = 40.0 * pow(10.0, -digits) / (8.0 * SD_PI * e.range);
      CHECK_NEAR(D[SD_I0], unit * (1.0 + q / 3.0), off);
      CHECK_NEAR(D[SD_J0] * r * r, unit * (1.0 - q), off);
    }
    CHECK_NEAR(sd_ewald_wave_screen(&e, 1e-6), 1.0 - e.a_ref * e.a_ref * 1e-6 / 6.0, 1e-12);
    CHECK_NEAR(sd_ewald_wave_screen(&e, e.band * e.band), 0.0, 0.0);
  }
}

/* With k = K sin(angle) H is smooth at its end too. */
static void functions_of_a_band_are_the_integrals(void **state)
{
  (void) state;
  enum { STEPS = 4000 };
  const sd_ewald e = at_points(7.0);
  for (double r = 0.0; r < 1.2 * e.range; r += 0.1) {
    double D[SD_RADIALS], expected[SD_RADIALS] = {0.0}, there[SD_RADIALS], j[3];
    for (int s = 0; s < STEPS; s++) {
      const double angle = (s + 0.5) * 0.5 * SD_PI / STEPS, k = e.band * sin(angle), k2 = k * k;
      const double weight = e.band * cos(angle) * 0.5 * SD_PI / STEPS / (2.0 * SD_PI * SD_PI);
      bessel(k * r, j);
      for (int n = 0; n < 3; n++) {
        const double power = weight * sd_ewald_wave_screen(&e, k2) * pow(k2, n);
        expected[SD_I0 + 2 * n] += power * (j[0] - j[1]);
        expected[SD_J0 + 2 * n] += power * k2 * j[2];
        if (n < 2) expected[SD_K0 + n] += 0.5 * power * k2 * j[1];
      }
    }
    sd_radial(&e, r, there);
    sd_radial(&e, 0.0, D);
    for (int f = 0; f < SD_RADIALS; f++) CHECK_NEAR(there[f], expected[f], 1e-7 * fabs(D[f])); /* 10^-digits */
  }
}

/* What is within the range and what is beyond it add up to what the longest waves say. */
static void tail_of_a_band_is_the_rest_of_the_mean(void **state)
{
  (void) state;
  enum { STEPS = 400 };
  const sd_ewald e = at_points(7.0);
  double tail[3], within[3] = {0.0};
  for (int s = 0; s <= STEPS; s++) {
    const double r = s * e.range / STEPS, weight = (s == 0 || s == STEPS ? 1.0 : s % 2 ? 4.0 : 2.0) / 3.0 * e.range /
        STEPS;
    double D[SD_RADIALS];
    sd_radial(&e, r, D);
    for (int n = 0; n < 3; n++)
      within[n] += weight * 4.0 * SD_PI * r * ((n == 0 ? 1.0 / (6.0 * SD_PI) : 0.0) - r * D[SD_I0 + 2 * n] - pow(r, 3) /
                                               3.0 * D[SD_J0 + 2 * n]);
  }
  sd_radial_tail(&e, tail);
  CHECK_NEAR(tail[0] + within[0], e.a_ref * e.a_ref / 9.0, 1e-8);
  CHECK_NEAR(tail[1] + within[1], -2.0 / 3.0, 1e-8);
  CHECK_NEAR(tail[2] + within[2], 0.0, 1e-7);
}

/* Over the ball of the range polynomials have the mean of the functions; in an open box, less the tail's. */
static void polynomials_keep_means(void **state)
{
  (void) state;
  enum { STEPS = 2000 };
  const sd_ewald_sizes sizes = {.all = {1e4, 1e4, 1e4, 1.0}};
  for (int open = 0; open < 2; open++) {
    const sd_ewald_box box = {.periodic = !open, .edge = {60, 60, 60}};
    sd_ewald e;
    double c[SD_RADIALS][SD_RADIAL_TERMS], D[SD_RADIALS], tail[3], off[3] = {0.0}, scale[3] = {0.0};
    assert_int_equal(sd_ewald_choose(&box, &sizes, 3, 1e-3, &e), SD_OK);
    const int degree = sd_radial_fit(&e, 3, c[0]);
    sd_radial_tail(&e, tail);
    for (int s = 0; s <= STEPS; s++) {
      const double r = s * e.range / STEPS, r2 = r * r, t = 2.0 * s * s / (STEPS * (double) STEPS) - 1.0;
      const double weight = (s == 0 || s == STEPS ? 1.0 : s % 2 ? 4.0 : 2.0) / 3.0 * e.range / STEPS * 4.0 * SD_PI * r2;
      sd_radial(&e, r, D);
      for (int n = 0; n < 3; n++) {
        double I = 0.0, J = 0.0, power = 1.0;
        for (int m = 0; m <= degree; m++, power *= t) {
          I += c[SD_I0 + 2 * n][m] * power;
          J += c[SD_J0 + 2 * n][m] * power;
        }
        off[n] += weight * (I - D[SD_I0 + 2 * n] + (J - D[SD_J0 + 2 * n]) * r2 / 3.0);
        scale[n] += weight * fabs(D[SD_I0 + 2 * n]);
      }
    }
    for (int n = 0; n < 3; n++) CHECK_NEAR(off[n] + open * tail[n], 0.0, 1e-10 * scale[n]);
  }
}

/* Kernels of floats end at a degree, so that no scene with sums of floats may need a longer polynomial, and two terms
 * are left: few or many spheres, thin or overlapping, alike or with some that are up to a hundred times as large. */
static void floats_do_with_short_polynomials(void **state)
{
  (void) state;
  uint64_t seed = 5;
  int scenes = 0, longest = 0;
  for (int k = 0; k < 300; k++) {
    const double many = floor(pow(10.0, uniform(&seed, 0, 6))), large = k % 3 ? pow(10.0, uniform(&seed, 0, 2)) : 1.0;
    const double few = ceil(many * pow(10.0, uniform(&seed, -4, 0))), a2 = large * large;
    const double side = cbrt((many + few * a2 * large) / pow(10.0, uniform(&seed, -4, 0.5)));
    const sd_ewald_sizes sizes = {.all = {many + few, many + few * a2, many + few * a2 * a2, large}};
    const sd_ewald_box box = {.periodic = k % 2, .edge = {side, 2 * side, 0.5 * side}};
    const int width = k % 4 < 2 ? 3 : 6;
    double c[SD_RADIALS][SD_RADIAL_TERMS];
    sd_ewald e;
    assert_int_equal(sd_ewald_choose(&box, &sizes, width, pow(10.0, uniform(&seed, -5, -4)), &e), SD_OK);
    scenes += e.single;
    if (!e.single) continue;
    e.single = 0; /* as many terms as there should be */
    const int degree = sd_radial_fit(&e, width, c[0]);
    longest = degree > longest ? degree : longest;
    assert_true(degree < SD_RADIAL_SINGLE_TERMS - 2);
  }
  assert_true(scenes > 100 && longest > SD_RADIAL_SINGLE_TERMS - 8);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(closed_forms_are_the_integrals),
      cmocka_unit_test(nothing_is_left_out_of_a_wide_range),
      cmocka_unit_test(a_band_leaves_little_beyond_the_range),
      cmocka_unit_test(functions_of_a_band_are_the_integrals),
      cmocka_unit_test(tail_of_a_band_is_the_rest_of_the_mean),
      cmocka_unit_test(polynomials_keep_means),
      cmocka_unit_test(floats_do_with_short_polynomials),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
