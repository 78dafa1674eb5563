/* sd_two_sphere.h: the table against the solver that it is made by, definiteness, continuity. */
#include "check.h"
#include "pair_blocks.h"
#include "table.h"

#include "sd_constants.h"
#include "sd_linear.h"
#include "sd_two_sphere.h"
#include "sd_two_sphere_exact.h"
#include "sd_two_sphere_near.h"
#include "sd_two_sphere_table_internal.h"

enum { FUNCTIONS = 16 };

/* Scales of Jeffrey & Onishi 1984 for XA YA YB XC YC */
static void scales(double a1, double a2, double s[FUNCTIONS])
{
  const double a[4] = {2.0 * a1, a1 + a2, a1 + a2, 2.0 * a2};
  for (int k = 0; k < 4; k++) s[6 + k] = SD_PI * a[k] * a[k];
  for (int k = 0; k < 3; k++) {
    const double sum = a[k == 2 ? 3 : k];
    s[k] = s[3 + k] = 3.0 * SD_PI * sum;
    s[10 + k] = s[13 + k] = SD_PI * sum * sum * sum;
  }
}

static sd_pair_resistance difference(const sd_pair_resistance *A, const sd_pair_resistance *B)
{
  return sd_pair_resistance_sum(1.0, A, -1.0, B);
}

static sd_pair_resistance rpy(double a1, double a2, double xi)
{
  return sd_pair_resistance_rpy(a1, a2, (a1 + a2) * (1.0 + 0.5 * xi));
}

static sd_pair_resistance correction(const sd_two_sphere *t, double a1, double a2, double xi,
                                     sd_pair_resistance *relative)
{
  sd_pair_resistance full;
  assert_int_equal(sd_two_sphere_correction(t, a1, a2, xi, 1.0, 0.0, &full), SD_OK);
  assert_int_equal(sd_two_sphere_correction(t, a1, a2, xi, 0.0, 1.0, relative), SD_OK);
  return full;
}

static sd_two_sphere *create(double ratio)
{
  sd_two_sphere *t;
  assert_int_equal(sd_two_sphere_create(ratio, &t), SD_OK);
  return t;
}

/* |table - exact| <= tolerance max(|exact|, 0.05) of every scaled function */
static void same_functions(double ratio, const sd_pair_resistance *full, double xi,
                           const double exact[FUNCTIONS], double tolerance)
{
  const sd_pair_resistance model = rpy(1.0, ratio, xi);
  const sd_pair_resistance sum = sd_pair_resistance_sum(1.0, full, 1.0, &model);
  double f[FUNCTIONS], s[FUNCTIONS];
  memcpy(f, &sum, sizeof f);
  scales(1.0, ratio, s);
  for (int k = 0; k < FUNCTIONS; k++)
    CHECK_NEAR(f[k] / s[k], exact[k], tolerance * fmax(fabs(exact[k]), 0.05));
}

/* Ten times better than 1e-5 to ratio 10 and 1e-4 beyond, at gaps from 1e-6 to 5 of the smaller
 * radius, ratios 1 to 20, and for all lengths of the table: one ratio, those asked for, all. */
static void table_has_the_exact_functions(void **state)
{
  (void) state;
  table t = table_open("two_sphere/resistance.csv");
  sd_two_sphere *all = create(100.0);
  while (table_next(&t)) {
    const double ratio = table_number(&t, 0), xi = 2.0 * table_number(&t, 1) / (1.0 + ratio);
    double exact[FUNCTIONS];
    for (int k = 0; k < FUNCTIONS; k++) exact[k] = table_number(&t, 3 + k);
    sd_two_sphere *own = create(ratio);
    sd_pair_resistance relative;
    sd_pair_resistance full = correction(own, 1.0, ratio, xi, &relative);
    same_functions(ratio, &full, xi, exact, ratio > 10.0 ? 1e-5 : 1e-6);
    full = correction(all, 1.0, ratio, xi, &relative);
    same_functions(ratio, &full, xi, exact, ratio > 10.0 ? 1e-5 : 1e-6);
    sd_two_sphere_free(own);
  }
  sd_two_sphere_free(all);
}

/* The same between the nodes: random ratios to 100, gaps to the end of the table */
static void table_has_them_between_its_nodes(void **state)
{
  (void) state;
  uint64_t seed = 15;
  sd_two_sphere *all = create(100.0);
  for (int i = 0; i < 100; i++) {
    const double ratio = exp(uniform(&seed, 0.0, log(100.0)));
    const double xi = 8.0 * exp(-fabs(uniform(&seed, -10.0, 10.0)));
    const sd_pair_resistance R = sd_two_sphere_exact(1.0, ratio, 0.5 * xi * (1.0 + ratio), NULL);
    double exact[FUNCTIONS], s[FUNCTIONS];
    memcpy(exact, &R, sizeof exact);
    scales(1.0, ratio, s);
    for (int k = 0; k < FUNCTIONS; k++) exact[k] /= s[k];
    sd_pair_resistance relative;
    const sd_pair_resistance full = correction(all, 1.0, ratio, xi, &relative);
    same_functions(ratio, &full, xi, exact, ratio > 10.0 ? 1e-5 : 1e-6);
  }
  sd_two_sphere_free(all);
}

/* Smallest and largest eigenvalue in Stokes drags: along d forces, torques; across all of them */
static void extremes(const sd_pair_resistance *D, double a1, double a2, double *low, double *high)
{
  const double d[3] = {0.0, 0.0, 1.0}, a[2] = {a1, a2};
  double B[3][36], s[12];
  pair_blocks(D, d, B[0], B[1], B[2]);
  for (int p = 0; p < 12; p++)
    s[p] = p % 6 < 3 ? 1.0 / sqrt(6.0 * SD_PI * a[p / 6])
                     : 1.0 / sqrt(8.0 * SD_PI * pow(a[p / 6], 3));
  static const int set[3][4] = {{2, 8}, {5, 11}, {0, 6, 4, 10}}, size[3] = {2, 2, 4};
  *low = INFINITY, *high = -INFINITY;
  for (int b = 0; b < 3; b++) {
    const int n = size[b];
    double A[16], w[4], V[16];
    for (int i = 0; i < n; i++)
      for (int j = 0; j < n; j++) {
        const int p = set[b][i], q = set[b][j], r = p % 6, c = q % 6;
        const double v = p < 6 ? B[q < 6 ? 0 : 1][6 * r + c]
            : q < 6            ? B[1][6 * c + r]
                               : B[2][6 * r + c];
        A[n * i + j] = v * s[p] * s[q];
      }
    sd_eigen(n, A, w, V);
    *high = fmax(*high, w[0]);
    *low = fmin(*low, w[n - 1]);
  }
}

/* D >= 0 and Q^T D Q >= 0, but for rounding and table: -1e-8 of the largest eigenvalue at that gap,
 * for ratios above 10 of a Stokes drag. (Far from contact the largest is 1e-4 there, and the
 * smallest 1e-12.) */
static void correction_is_positive(void **state)
{
  (void) state;
  sd_two_sphere *all = create(100.0);
  for (int i = 0; i <= 40; i++)
    for (int j = 0; j <= 80; j++) {
      const double ratio = exp(log(100.0) * i / 40), xi = fmin(8.0, 1e-6 * exp(log(8e6) * j / 80));
      double low, high;
      sd_pair_resistance R[2];
      R[0] = correction(all, 1.0, ratio, xi, &R[1]);
      for (int k = 0; k < 2; k++) {
        extremes(&R[k], 1.0, ratio, &low, &high);
        if (low < -1e-8 * (ratio > 10.0 ? fmax(high, 1.0) : high))
          fail_msg("%s, ratio %g, xi %g: %g of %g", k ? "relative" : "D", ratio, xi, low, high);
      }
    }
  sd_two_sphere_free(all);
}

/* The relative part is that of D, though it is read from numbers of its own, and resists no rigid
 * motion: a turn about sphere 2 takes sphere 1 along by R. */
static void relative_part_is_that_of_d(void **state)
{
  (void) state;
  uint64_t seed = 4;
  sd_two_sphere *all = create(100.0);
  for (int i = 0; i < 1000; i++) {
    const double a2 = i % 5 ? 1.3 * exp(uniform(&seed, 0.0, log(100.0))) : 1.3;
    const double xi = exp(uniform(&seed, log(1e-7), log(8.0))), R = (1.3 + a2) * (1.0 + 0.5 * xi);
    sd_pair_resistance Q;
    const sd_pair_resistance D = correction(all, 1.3, a2, xi, &Q);
    const sd_pair_resistance P = sd_pair_resistance_relative(&D, 1.3, a2, R);
    double p[FUNCTIONS], q[FUNCTIONS], unit[FUNCTIONS];
    memcpy(p, &P, sizeof p);
    memcpy(q, &Q, sizeof q);
    sd_two_sphere_scales(1.3, a2, unit);
    for (int k = 0; k < FUNCTIONS; k++)
      CHECK_NEAR(q[k], p[k], 1e-7 * fmax(fabs(p[k]), unit[k]));
    const double *YB = Q.YB, *YC = Q.YC;
    assert_true(Q.XA[0] == -Q.XA[1] && Q.XC[2] == -Q.XC[1] && YB[0] == -YB[1] && YB[2] == -YB[3]);
    CHECK_NEAR(Q.YA[0] * R, YB[1] + YB[3], 1e-13 * (fabs(YB[1]) + fabs(YB[3])));
    CHECK_NEAR(YB[1] * R, YC[0] + YC[1], 1e-13 * (YC[0] + fabs(YC[1])));
    CHECK_NEAR(YB[3] * R, YC[1] + YC[2], 1e-13 * (YC[2] + fabs(YC[1])));
  }
  sd_two_sphere_free(all);
}

/* What is common instead fails: the near-contact form, exact at contact with its constants, used at
 * larger gaps. */
static void usual_forms_are_not_positive(void **state)
{
  (void) state;
  sd_two_sphere *one = create(1.0);
  sd_pair_resistance relative, full = correction(one, 1.0, 1.0, 1e-7, &relative);
  const sd_pair_resistance touching = rpy(1.0, 1.0, 1e-7),
                           pole = sd_two_sphere_near(1.0, 1.0, 1e-7);
  sd_pair_resistance constants = sd_pair_resistance_sum(1.0, &full, 1.0, &touching);
  constants = difference(&constants, &pole);
  const double xi[3] = {0.2, 0.5, 1.0};
  for (int k = 0; k < 3; k++) {
    const sd_pair_resistance model = rpy(1.0, 1.0, xi[k]),
                             near = sd_two_sphere_near(1.0, 1.0, xi[k]);
    sd_pair_resistance form = sd_pair_resistance_sum(1.0, &near, 1.0, &constants);
    form = difference(&form, &model);
    double low, high;
    extremes(&form, 1.0, 1.0, &low, &high);
    if (low > -1e-3 * high) fail_msg("xi %g: %g of %g", xi[k], low, high);
    full = correction(one, 1.0, 1.0, xi[k], &relative);
    extremes(&full, 1.0, 1.0, &low, &high);
    assert_true(low > 1e-4);
  }
  sd_two_sphere_free(one);
}

/* Where the table goes from one of its cells to the next nothing jumps. */
static void no_jumps(void **state)
{
  (void) state;
  sd_two_sphere *all = create(100.0);
  for (double ratio = 1.0; ratio < 100.0; ratio *= 1.7)
    for (int c = 0; c < 2000; c++) {
      const double xi = 1e-6 * exp(log(7.9e6) * c / 2000), e = 1e-3 * xi;
      sd_pair_resistance unused;
      double f[4][FUNCTIONS];
      for (int k = 0; k < 4; k++) {
        const sd_pair_resistance full = correction(all, 1.0, ratio, xi + (k - 1.5) * e, &unused);
        memcpy(f[k], &full, sizeof f[k]);
      }
      /* third differences: a jump would stay, e^3 of the functions goes */
      for (int k = 0; k < FUNCTIONS; k++) {
        const double jump = f[3][k] - 3.0 * f[2][k] + 3.0 * f[1][k] - f[0][k];
        CHECK_NEAR(jump, 0.0,
                   1e-8 * fabs(f[0][k]) +
                       1e-7 *
                           (k < 6        ? 1
                                : k < 10 ? ratio
                                         : ratio * ratio));
      }
    }
  sd_two_sphere_free(all);
}

/* Lengths: forces over velocities like a, torques over spins like a^3. Exchanged spheres are the
 * same pair, equal ones to the last bit. */
static void scales_and_exchange(void **state)
{
  (void) state;
  sd_two_sphere *t = create(3.0), *one = create(1.0);
  sd_pair_resistance q1, q7, qx;
  const sd_pair_resistance f1 = correction(t, 0.9, 2.7, 0.03, &q1);
  const sd_pair_resistance f7 = correction(t, 7 * 0.9, 7 * 2.7, 0.03, &q7);
  const sd_pair_resistance fx = correction(t, 2.7, 0.9, 0.03, &qx);
  const sd_pair_resistance *small[2] = {&f1, &q1}, *large[2] = {&f7, &q7},
                           *exchanged[2] = {&fx, &qx};
  for (int k = 0; k < 2; k++) {
    const sd_pair_resistance back = sd_pair_resistance_exchanged(exchanged[k]);
    double a[FUNCTIONS], b[FUNCTIONS], c[FUNCTIONS];
    memcpy(a, small[k], sizeof a);
    memcpy(b, large[k], sizeof b);
    memcpy(c, &back, sizeof c);
    for (int f = 0; f < FUNCTIONS; f++) {
      CHECK_NEAR(b[f], a[f] * (f < 6 ? 7.0 : f < 10 ? 49.0 : 343.0), 1e-11 * fabs(b[f]));
      CHECK_NEAR(c[f], a[f], 0.0);
    }
  }
  sd_pair_resistance q;
  const sd_pair_resistance f = correction(one, 1.3, 1.3, 0.2, &q);
  assert_true(f.XA[0] == f.XA[2] && f.YA[0] == f.YA[2] && f.YB[0] == -f.YB[3] &&
              f.YB[1] == -f.YB[2]);
  assert_true(f.XC[0] == f.XC[2] && f.YC[0] == f.YC[2]);
  sd_two_sphere_free(t);
  sd_two_sphere_free(one);
}

static void outside_is_refused(void **state)
{
  (void) state;
  sd_two_sphere *t;
  assert_int_equal(sd_two_sphere_create(100.1, &t), SD_EOUTSIDE);
  assert_int_equal(sd_two_sphere_create(0.9, &t), SD_EOUTSIDE);
  assert_int_equal(sd_two_sphere_create(NAN, &t), SD_EOUTSIDE);
  t = create(2.0);
  sd_pair_resistance f;
  assert_int_equal(sd_two_sphere_correction(t, 1.0, 2.0, 8.0, 1.0, 0.0, &f), SD_OK);
  assert_int_equal(sd_two_sphere_correction(t, 1.0, 2.1, 1.0, 1.0, 0.0, &f), SD_EOUTSIDE);
  assert_int_equal(sd_two_sphere_correction(t, 2.1, 1.0, 1.0, 1.0, 0.0, &f), SD_EOUTSIDE);
  assert_int_equal(sd_two_sphere_correction(t, 1.0, 2.0, 8.1, 1.0, 0.0, &f), SD_EOUTSIDE);
  assert_int_equal(sd_two_sphere_correction(t, 1.0, 2.0, 0.9e-8, 1.0, 0.0, &f), SD_EOUTSIDE);
  assert_int_equal(sd_two_sphere_correction(t, 1.0, 2.0, NAN, 1.0, 0.0, &f), SD_EOUTSIDE);
  sd_two_sphere_free(t);
}

/* A ratio that rounding has made a hair larger than the table's is read from its last row. */
static void a_hair_outside_is_inside(void **state)
{
  (void) state;
  for (double ratio = 1.0; ratio < 101.0; ratio *= 10.0) {
    sd_two_sphere *t = create(ratio);
    sd_pair_resistance at, beyond;
    assert_int_equal(sd_two_sphere_correction(t, 1.3, 1.3 * ratio, 1e-3, 0.7, 0.2, &at), SD_OK);
    assert_int_equal(
        sd_two_sphere_correction(t, 1.3, 1.3 * ratio * (1.0 + 5e-13), 1e-3, 0.7, 0.2, &beyond), SD_OK);
    CHECK_NEAR(at.XA[0], beyond.XA[0], 1e-10 * at.XA[0]);
    CHECK_NEAR(at.YC[2], beyond.YC[2], 1e-10 * at.YC[2]);
    sd_two_sphere_free(t);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(table_has_the_exact_functions),
      cmocka_unit_test(table_has_them_between_its_nodes),
      cmocka_unit_test(correction_is_positive),
      cmocka_unit_test(relative_part_is_that_of_d),
      cmocka_unit_test(usual_forms_are_not_positive),
      cmocka_unit_test(no_jumps),
      cmocka_unit_test(scales_and_exchange),
      cmocka_unit_test(outside_is_refused),
      cmocka_unit_test(a_hair_outside_is_inside),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
