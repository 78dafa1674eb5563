/* Films between spheres and a plane wall. */
#include "table.h"

#include "sd_constants.h"
#include "sd_linear.h"
#include "sd_wall_film.h"

static const double up[3] = {0.0, 0.0, 1.0};

static sd_wall_film film_at(double a, double gap, double floor)
{
  return sd_wall_film_at(a, a * (1.0 + gap), floor);
}

/* normal, parallel, coupling, roll, spin over 6 pi, 8 pi of a film of a unit sphere */
static void over_stokes(const sd_wall_film *film, double D[5])
{
  const double F = 6.0 * SD_PI, T = 8.0 * SD_PI;
  D[0] = film->normal / F;
  D[1] = film->parallel / F;
  D[2] = film->coupling / T;
  D[3] = film->roll / T;
  D[4] = film->spin / T;
}

/* The same of the model, whose self mobilities above a wall are polynomials of s = a/z:
 *   parallel 1 - 9/16 s + s^3/8 - s^5/16, normal 1 - 9/8 s + s^3/2 - s^5/8, coupling s^4/8 over
 *   8 pi, rotation 1 - 5/16 s^3, spin 1 - s^3/8 */
static void model_at(double gap, double R[5])
{
  const double s = 1.0 / (1.0 + gap), s3 = s * s * s, s5 = s3 * s * s;
  const double p = 1.0 - 9.0 / 16.0 * s + s3 / 8.0 - s5 / 16.0, q = 3.0 / 32.0 * s3 * s,
               r = 0.75 * (1.0 - 5.0 / 16.0 * s3), det = p * r - q * q;
  R[0] = 1.0 / (1.0 - 9.0 / 8.0 * s + s3 / 2.0 - s5 / 8.0);
  R[1] = r / det;
  R[2] = -0.75 * q / det;
  R[3] = 0.75 * p / det;
  R[4] = 1.0 / (1.0 - s3 / 8.0);
}

static void exact_at(double gap, double R[5])
{
  const sd_wall_film exact = sd_wall_film_exact(1.0, 1.0 + gap, 1e-9);
  over_stokes(&exact, R);
}

/* What is left of the series when the model is taken off: 5e-6 of 1 + its size at every gap */
static void tabulated_gaps(void **state)
{
  (void) state;
  table t = table_open("walls/wall_functions.csv");
  double worst = 0.0;
  while (table_next(&t)) {
    const double gap = table_number(&t, 0);
    const sd_wall_film film = film_at(1.0, gap, 1e-9);
    double D[5], R[5], exact[5];
    over_stokes(&film, D);
    model_at(gap, R);
    exact_at(gap, exact);
    for (int k = 0; k < 5; k++) {
      const double model = table_number(&t, 6 + k), known = table_number(&t, 1 + k) - model;
      CHECK_NEAR(R[k], model, 1e-11 * fabs(model) + 1e-15);
      CHECK_NEAR(exact[k], D[k] + R[k], 1e-10 + 1e-14 * exact[0]);
      CHECK_NEAR(D[k], known, 5e-6 * (1.0 + fabs(known)));
      worst = fmax(worst, fabs(D[k] - known) / (1.0 + fabs(known)));
    }
  }
  print_message("tabulated gaps: largest difference %.2g of 1 + D\n", worst);
}

/* Lubrication theory, constants included, and a remainder of the order of the gap */
static void near_contact(void **state)
{
  (void) state;
  const double remainder[5] = {0.17, 0.43, 0.10, 0.34, 0.45};
  for (double e = 1e-6; e < 5e-3; e *= 3.0) {
    const double L = log(1.0 / e);
    const double form[5] = {1.0 / e + L / 5.0 + 0.97127993 + e * L / 21.0,
                            8.0 / 15.0 * L + 0.95429372 + 64.0 / 375.0 * e * L,
                            -(L / 10.0 - 0.19295275 + 43.0 / 250.0 * e * L),
                            2.0 / 5.0 * L + 0.37089257 + 66.0 / 125.0 * e * L,
                            1.2020569031595942 - 0.5 * e * L};
    double R[5];
    exact_at(e, R);
    for (int k = 0; k < 5; k++)
      CHECK_NEAR(R[k], form[k], 5e-6 * (1.0 + fabs(form[k])) + 1.3 * remainder[k] * e);
  }
}

/* The matrix is symmetric and has no negative eigenvalue at any gap, radius and direction; that of
 * (parallel, coupling; coupling, roll) in 6 pi and 8 pi is the one of the table. */
static void positive_semidefinite(void **state)
{
  (void) state;
  uint64_t seed = 11;
  double B[36], w[6], V[36];
  for (int trial = 0; trial < 300; trial++) {
    double e[3];
    for (int d = 0; d < 3; d++) e[d] = uniform(&seed, -1, 1);
    sd_normalize(e);
    const double a = exp(uniform(&seed, -2, 2)), gap = exp(uniform(&seed, -14, 5));
    const sd_wall_film film = film_at(a, gap, 1e-6);
    sd_wall_film_matrix(&film, e, 1.7, B);
    sd_eigen(6, B, w, V);
    for (int p = 0; p < 6; p++)
      for (int q = 0; q < p; q++) assert_true(B[6 * p + q] == B[6 * q + p]);
    assert_true(w[5] >= -1e-15 * w[0]);
  }
  table t = table_open("walls/wall_functions.csv");
  while (table_next(&t)) {
    const sd_wall_film film = film_at(1.0, table_number(&t, 0), 1e-6);
    double D[5];
    over_stokes(&film, D);
    const double mean = 0.5 * (D[1] + D[3]), half = 0.5 * (D[1] - D[3]);
    const double least = mean - hypot(half, sqrt(4.0 / 3.0) * D[2]), known = table_number(&t, 11);
    CHECK_NEAR(least, known, 1e-3 * known + 5e-6);
  }
}

/* A sphere below the floor, at contact or in the wall is as at the floor; lengths and viscosity
 * scale. */
static void floor_and_units(void **state)
{
  (void) state;
  const double a = 0.7, eta = 2.3, gaps[] = {1e-4, 0.0, -0.3};
  double at_floor[36], B[36], unit[36];
  sd_wall_film film = film_at(a, 1e-3, 1e-3);
  sd_wall_film_matrix(&film, up, 1.0, at_floor);
  for (int k = 0; k < 3; k++) {
    film = film_at(a, gaps[k], 1e-3);
    sd_wall_film_matrix(&film, up, 1.0, B);
    for (int c = 0; c < 36; c++) CHECK_NEAR(B[c], at_floor[c], 1e-12 * fabs(at_floor[c]));
  }
  const sd_wall_film one = film_at(1.0, 0.2, 1e-3), other = film_at(a, 0.2, 1e-3);
  sd_wall_film_matrix(&one, up, 1.0, unit);
  sd_wall_film_matrix(&other, up, eta, B);
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 6; q++)
      CHECK_NEAR(B[6 * p + q], unit[6 * p + q] * eta * pow(a, 1 + (p > 2) + (q > 2)), 1e-12);
}

/* Near contact rolling along x, about y, is resisted less than turning on the spot: the coupling is
 * negative where the force is along x and the spin about y, positive along y and about x. */
static void rolling_is_easier(void **state)
{
  (void) state;
  double B[36];
  const sd_wall_film film = film_at(0.8, 1e-4, 1e-6);
  sd_wall_film_matrix(&film, up, 1.0, B);
  assert_true(film.coupling < 0.0);
  assert_true(B[6 * 0 + 4] == film.coupling && B[6 * 1 + 3] == -film.coupling);
  assert_true(B[6 * 4 + 0] == film.coupling && B[6 * 3 + 1] == -film.coupling);
}

/* The wall at any side is one matrix turned: B' = Q B Q^T, and so is E. */
static void any_direction(void **state)
{
  (void) state;
  uint64_t seed = 3;
  const sd_wall_film film = film_at(0.8, 0.05, 1e-3);
  for (int trial = 0; trial < 20; trial++) {
    double Q[9], e[3], u[3], turned[3], B[36], C[36], E[6], G[6], back[3];
    random_rotation(&seed, Q);
    for (int d = 0; d < 3; d++) u[d] = uniform(&seed, -1, 1);
    sd_multiply3(Q, up, e);
    sd_multiply3(Q, u, turned);
    sd_wall_film_matrix(&film, up, 1.0, B);
    sd_wall_film_matrix(&film, e, 1.0, C);
    for (int b = 0; b < 4; b++) {
      const int p0 = 3 * (b / 2), q0 = 3 * (b % 2);
      for (int p = 0; p < 3; p++)
        for (int q = 0; q < 3; q++) {
          double sum = 0.0;
          for (int m = 0; m < 3; m++)
            for (int n = 0; n < 3; n++)
              sum += Q[3 * p + m] * B[6 * (p0 + m) + q0 + n] * Q[3 * q + n];
          CHECK_NEAR(C[6 * (p0 + p) + q0 + q], sum, 1e-13 * film.normal);
        }
    }
    sd_wall_film_flow(&film, up, 1.0, u, E);
    sd_wall_film_flow(&film, e, 1.0, turned, G);
    for (int h = 0; h < 6; h += 3) {
      sd_multiply3(Q, E + h, back);
      for (int d = 0; d < 3; d++) CHECK_NEAR(G[h + d], back[d], 1e-14 * film.normal);
    }
  }
}

/* Pushed along the wall without torque: velocity and spin, 6 pi eta a = 1. Near contact a sphere
 * slips more than it rolls. */
static void pushed_along(void **state)
{
  (void) state;
  const double known[2][3] = {{0.1, 0.44304988, 0.02703135}, {0.01, 0.29611765, 0.03654131}};
  double R[5];
  for (int k = 0; k < 2; k++) {
    exact_at(known[k][0], R);
    const double U = 1.0 / (R[1] - 4.0 / 3.0 * R[2] * R[2] / R[3]), W = -R[2] / R[3] * U;
    CHECK_NEAR(U, known[k][1], 3e-6);
    CHECK_NEAR(W, known[k][2], 3e-6);
  }
  exact_at(1e-3, R);
  CHECK_NEAR(-R[2] / R[3], 0.159055, 3e-6);
}

/* Time to fall from a height of 5 radii, 6 pi eta a = F = 1: the integral of the resistance, by
 * Simpson's rule in ln(gap) */
static void falls_in_time(void **state)
{
  (void) state;
  const double height[] = {3.0, 2.0, 1.5, 1.1, 1.01},
               time[] = {2.7902751, 4.5755874, 5.8482487, 7.9750854, 10.4213978};
  enum { PANELS = 400 };
  for (int k = 0; k < 5; k++) {
    const double from = log(height[k] - 1.0), step = (log(4.0) - from) / PANELS;
    double sum = 0.0, R[5];
    for (int p = 0; p <= PANELS; p++) {
      const double gap = exp(from + p * step);
      exact_at(gap, R);
      sum += (p == 0 || p == PANELS ? 1.0 : p % 2 ? 4.0 : 2.0) * step / 3.0 * R[0] * gap;
    }
    CHECK_NEAR(sum, time[k], 1e-6 * time[k]);
  }
}

/* A sphere in u_x = z, held and free: force and torque on it when it rests, over 6 pi h and 4 pi */
static void shear_flow(void **state)
{
  (void) state;
  table t = table_open("walls/wall_shear.csv");
  double worst = 0.0;
  while (table_next(&t)) {
    const double gap = table_number(&t, 0), h = 1.0 + gap, u[3] = {h, 0.0, 0.3};
    const sd_wall_film film = film_at(1.0, gap, 1e-9);
    double R[5], E[6];
    model_at(gap, R);
    sd_wall_film_flow(&film, up, 1.0, u, E);
    const double F = R[1] + 2.0 / (3.0 * h) * R[2] + E[0] / (6.0 * SD_PI * h);
    const double T = R[3] + 2.0 * h * R[2] + E[4] / (4.0 * SD_PI);
    for (int d = 0; d < 6; d++)
      if (d != 0 && d != 4) assert_true(E[d] == 0.0);
    const sd_wall_film exact = sd_wall_film_exact(1.0, h, 1e-9);
    CHECK_NEAR(exact.flow_force / (6.0 * SD_PI), F, 1e-10);
    CHECK_NEAR(exact.flow_torque * h / (4.0 * SD_PI), T, 1e-10);
    CHECK_NEAR(F, table_number(&t, 4), 2e-5);
    CHECK_NEAR(T, table_number(&t, 5), 2e-5);
    worst = fmax(worst, fmax(fabs(F - table_number(&t, 4)), fabs(T - table_number(&t, 5))));
  }
  print_message("shear: largest difference %.2g\n", worst);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(tabulated_gaps),
                                     cmocka_unit_test(near_contact),
                                     cmocka_unit_test(positive_semidefinite),
                                     cmocka_unit_test(floor_and_units),
                                     cmocka_unit_test(rolling_is_easier),
                                     cmocka_unit_test(any_direction),
                                     cmocka_unit_test(pushed_along),
                                     cmocka_unit_test(falls_in_time),
                                     cmocka_unit_test(shear_flow)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
