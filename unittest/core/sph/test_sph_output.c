/* Energies, probes, the free surface, walls that turn: closed forms. */
#include "sd_sph_energy.h"
#include "sd_sph_probe.h"
#include "sd_sph_wall.h"

#include "check.h"

#include <string.h>

static const sd_sph_state STATES[] = {{SD_SPH_ABSOLUT, 11.0, 0.0, 0.0, 0.0, 0},
                                      {SD_SPH_RELATIV, 130.0, 900.0, 0.0, 40.0, 0},
                                      {SD_SPH_TAIT, 5e4, 900.0, 7.0, 300.0, 0},
                                      {SD_SPH_TAIT, 5e4, 900.0, 1.0, 300.0, 0},
                                      {SD_SPH_TAIT, 5e4, 905.0, 7.0, 300.0, 1}};

/* Central difference: the error is that of the third derivative, (step/rho)^2. */
static void elastic_energy_is_the_work_of_pressure(void **state)
{
  (void) state;
  for (int k = 0; k < 5; k++)
    for (double rho = 700.0; rho < 1100.0; rho += 90.0) {
      const double step = 1e-3 * rho;
      const double slope = (sd_sph_elastic(&STATES[k], rho + step) -
                            sd_sph_elastic(&STATES[k], rho - step)) /
          (2.0 * step);
      CHECK_NEAR(slope * rho * rho, sd_sph_pressure(&STATES[k], rho), 3e-5 * 5e4);
    }
}

/* c^2 s^2 / 2 of a small strain s, which differences of powers would lose. */
static void elastic_energy_of_a_small_strain(void **state)
{
  (void) state;
  const sd_sph_state water = {SD_SPH_TAIT, 5e4, 900.0, 7.0, 0.0, 0};
  const double s = 1e-6, c2 = 7.0 * 5e4 / 900.0;
  CHECK_NEAR(sd_sph_elastic(&water, 900.0 * (1.0 + s)) / (0.5 * c2 * s * s), 1.0, 2e-5);
}

static void power_of_members_and_of_others(void **state)
{
  (void) state;
  const int mask[3] = {3, 1, 7};
  const double m[3] = {2.0, 3.0, 5.0}, v[9] = {1, 2, 3, 4, 5, 6, 0, 0, 2}, b[3] = {0, 0, -2};
  const double F[12] = {1, 1, 1, 99, 2, 0, 0, 99, 0, 0, 7, 99};
  const sd_sph_members two = {3, mask, 2, m, v};
  double others;
  CHECK_NEAR(sd_sph_power(&two, 4, F, &others), 6.0 + 14.0, 1e-15);
  CHECK_NEAR(others, 8.0, 1e-15);
  CHECK_NEAR(sd_sph_power(&two, 3, v, &others), 14.0 + 4.0, 1e-15);
  CHECK_NEAR(sd_sph_sum(&two, m), 7.0, 1e-15);
  CHECK_NEAR(sd_sph_kinetic_energy(&two), 0.5 * (2.0 * 14.0 + 5.0 * 4.0), 1e-15);
  CHECK_NEAR(sd_sph_along(&two, b, v), -2.0 * (2.0 * 3.0 + 5.0 * 2.0), 1e-15);
}

/* A lattice of spacing 0.1 that fills -2 < x < 2, 0 < y < 0.8, and its pressure. */
static void at(int k, double p[2])
{
  p[0] = -1.95 + 0.1 * (k % 40);
  p[1] = 0.05 + 0.1 * (k / 40);
}

static const sd_sph_spread SPREAD = {SD_SPH_WENDLAND, 2, 0.2, 0.01};

static void a_probe_in_the_middle_has_the_linear_pressure(void **state)
{
  (void) state;
  double sums[2] = {0.0, 0.0};
  assert_true(sd_sph_probe_pressure(sums) == 0.0);
  for (int k = 0; k < 320; k++) {
    double p[2];
    at(k, p);
    sd_sph_probe_add(&SPREAD, hypot(p[0], p[1] - 0.4), 5.0 - 4.0 * p[1], sums);
  }
  CHECK_NEAR(sd_sph_probe_pressure(sums), 5.0 - 4.0 * 0.4, 1e-12);
}

/* The sum of a lattice at its edge is that of the integral to 1e-3, and of slope 1.4 / h. The stretch of
 * the line may begin anywhere below the edge. */
static void height_of_the_edge_of_a_lattice(void **state)
{
  (void) state;
  double found[2];
  for (int part = 0; part < 2; part++) {
    const sd_sph_stretch at_line = {part ? 20.0 : 0.0, 0.025, part ? 40 : 60};
    double fraction[60] = {0.0};
    for (double z = -1e12; z < 1e13; z += 2e12) sd_sph_gauge_add(&SPREAD, 0.0, z, &at_line, fraction);
    assert_true(sd_sph_gauge_height(&at_line, fraction) == 0.0);
    for (int k = 0; k < 320; k++) {
      double p[2];
      at(k, p);
      sd_sph_gauge_add(&SPREAD, fabs(p[0] - 0.013), p[1], &at_line, fraction);
    }
    found[part] = sd_sph_gauge_height(&at_line, fraction);
    CHECK_NEAR(found[part], 0.8, 0.005);
  }
  CHECK_NEAR(found[1], found[0], 1e-14);
}

/* M = R diag R^T for a rotation by an angle about each axis in turn. */
static void least_eigenvalue_of_turned_matrices(void **state)
{
  (void) state;
  const double diagonals[4][3] = {{0.4, 0.9, 1.1}, {1, 1, 1}, {0.7, 0.7, 1.2}, {0, 0, 0}};
  const double c = cos(0.7), s = sin(0.7), C = cos(1.9), S = sin(1.9);
  const double R[3][3] = {{c, -s * C, s * S}, {s, c * C, -c * S}, {0, S, C}};
  static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
  for (int k = 0; k < 4; k++) {
    double M[6] = {0};
    for (int e = 0; e < 6; e++)
      for (int d = 0; d < 3; d++) M[e] += R[row[e]][d] * diagonals[k][d] * R[column[e]][d];
    CHECK_NEAR(sd_sph_least_eigenvalue(3, M), diagonals[k][0], 1e-7);
  }
  const double plane[6] = {c * c * 0.3 + s * s * 0.8, s * s * 0.3 + c * c * 0.8, 0, c * s * -0.5, 0, 0};
  CHECK_NEAR(sd_sph_least_eigenvalue(2, plane), 0.3, 1e-14);
}

/* Adds a wall particle at d with the velocity u, both from the fluid particle. */
static void see(double *sums, const double d[3], const double u[3])
{
  const double row[SD_SPH_MOTION] = {1.0,
                                     d[0],
                                     d[1],
                                     d[2],
                                     u[0],
                                     u[1],
                                     u[2],
                                     d[1] * u[2] - d[2] * u[1],
                                     d[2] * u[0] - d[0] * u[2],
                                     d[0] * u[1] - d[1] * u[0],
                                     d[0] * d[0],
                                     d[1] * d[1],
                                     d[2] * d[2],
                                     d[0] * d[1],
                                     d[0] * d[2],
                                     d[1] * d[2],
                                     u[0] * u[0] + u[1] * u[1] + u[2] * u[2]};
  for (int c = 0; c < SD_SPH_MOTION; c++) sums[c] += row[c];
}

/* A block of wall particles below the fluid particle: u = V + w x d. Of a row along x that part of w
 * which is along the row is not seen. */
static void angular_velocity_of_a_rigid_wall(void **state)
{
  (void) state;
  const double V[3] = {0.3, -0.2, 0.1}, w[3] = {0.4, 0.5, -0.7};
  const int sizes[3][2] = {{3, 3}, {3, 1}, {1, 1}}; /* a block, a plane of rows, a row */
  const double seen[3] = {sqrt(0.16 + 0.25 + 0.49), sqrt(0.16 + 0.25 + 0.49), sqrt(0.25 + 0.49)};
  for (int k = 0; k < 3; k++) {
    double sums[SD_SPH_MOTION] = {0.0}, shear, found[3];
    for (int a = 0; a < 7 * sizes[k][0] * sizes[k][1]; a++) {
      const double d[3] = {0.1 * (a % 7) - 0.3, 0.1 * (a / 7 % sizes[k][0]), -0.1 * (1 + a / 21)};
      const double u[3] = {V[0] + w[1] * d[2] - w[2] * d[1], V[1] + w[2] * d[0] - w[0] * d[2],
                           V[2] + w[0] * d[1] - w[1] * d[0]};
      see(sums, d, u);
    }
    CHECK_NEAR(sd_sph_spin(sums, found, &shear), seen[k], 1e-12);
    const double squares = sums[10] + sums[11] + sums[12];
    if (k < 2) CHECK_NEAR(shear, sqrt((0.09 + 0.04 + 0.01) * sums[0] / squares), 1e-12);
    for (int c = k < 2 ? 0 : 1; c < 3; c++) CHECK_NEAR(found[c], w[c], 1e-12);
  }
}

/* Water at rest 0.2 over a wall that slides by, and half of the wall at rest: across the row, as a row that
 * turns, or along it. */
static void a_wall_that_slides_does_not_turn(void **state)
{
  (void) state;
  for (int both = 0; both < 3; both++) {
    double sums[SD_SPH_MOTION] = {0.0}, shear, found[3];
    for (int a = 0; a < 7; a++) {
      const double d[3] = {0.1 * a - 0.3, -0.2, 0.0}, v = 0.5 * (!both || a < 3);
      see(sums, d, (const double[3]){both < 2 ? v : 0.0, 0.0, both < 2 ? 0.0 : v});
    }
    CHECK_NEAR(sd_sph_spin(sums, found, &shear), 0.0, 1e-12);
  }
}

/* A cylinder with 2 pi G a length of it, a sphere of the radius R with 6 pi G R, G from the page of the pair
 * style: 0.01 P and 0.014 P with wendland at h of 2 spacings, 0.005 P at 2.5, 0.07 P with the cubic spline. A fifth
 * with pliant shift, nothing with correction. */
static void particles_hold_a_body_as_a_weak_solid(void **state)
{
  (void) state;
  const double pi = acos(-1.0), P = 4900.0, dx = 0.02, R = 0.3, V = 4.0 / 3.0 * pi * R * R * R;
  const sd_sph_model flat = {.kernel = SD_SPH_WENDLAND, .dimension = 2}, deep = {.kernel = SD_SPH_WENDLAND,
                                                                                 .dimension = 3},
                     spline = {.kernel = SD_SPH_CUBICSPLINE, .dimension = 2};
  CHECK_NEAR(sd_sph_arrangement(&flat, 2.0 * dx, dx, P, 0.7), 2.0 * pi * 0.01 * P, 1e-9);
  CHECK_NEAR(sd_sph_arrangement(&flat, 2.5 * dx, dx, P, 0.7), 2.0 * pi * 0.005 * P, 0.03 * 154.0);
  CHECK_NEAR(sd_sph_arrangement(&deep, 2.0 * dx, dx, P, V), 6.0 * pi * 0.014 * P * R, 1e-9);
  CHECK_NEAR(sd_sph_arrangement(&spline, 1.3 * dx, dx, P, 0.7), 2.0 * pi * 0.07 * P, 1e-9);
  sd_sph_model moved = flat;
  moved.scheme = SD_SPH_SHIFT_PLIANT;
  CHECK_NEAR(sd_sph_arrangement(&moved, 2.0 * dx, dx, P, 0.7), 2.0 * pi * 0.002 * P, 1e-9);
  moved.scheme = SD_SPH_CORRECTION;
  CHECK_NEAR(sd_sph_arrangement(&moved, 2.0 * dx, dx, P, 0.7), 0.0, 0.0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(elastic_energy_is_the_work_of_pressure),
      cmocka_unit_test(elastic_energy_of_a_small_strain),
      cmocka_unit_test(power_of_members_and_of_others),
      cmocka_unit_test(a_probe_in_the_middle_has_the_linear_pressure),
      cmocka_unit_test(height_of_the_edge_of_a_lattice),
      cmocka_unit_test(least_eigenvalue_of_turned_matrices),
      cmocka_unit_test(angular_velocity_of_a_rigid_wall),
      cmocka_unit_test(a_wall_that_slides_does_not_turn),
      cmocka_unit_test(particles_hold_a_body_as_a_weak_solid)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
