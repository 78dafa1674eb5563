/* Grains in the water of SPH: sums that must be exact, limits of the own flow, implicit drag. */
#include "sd_constants.h"
#include "sd_sph_grains.h"

#include "check.h"

/* Water on a lattice of spacing 0.5 that is disturbed, walls below z = 0, and grains among it. */
enum { SIDE = 9, WATER = SIDE * SIDE * SIDE, GRAINS = 20 };
static double points[3 * WATER], volume[WATER], x[3 * GRAINS], V[GRAINS];
static int wall[WATER], first[GRAINS + 1];
static int *particle;
static double *weight, wet[GRAINS], h = 1.1;
static sd_sph_around list;
static const sd_sph_grains grains = {NULL, V, wet};

static int set_up(void **state)
{
  (void) state;
  uint64_t seed = 3;
  for (int a = 0; a < WATER; a++) {
    const int cell[3] = {a % SIDE, a / SIDE % SIDE, a / SIDE / SIDE};
    for (int c = 0; c < 3; c++)
      points[3 * a + c] = 0.5 * cell[c] - (c == 2 ? 1.5 : 0.0) + uniform(&seed, -0.1, 0.1);
    volume[a] = 0.125 * uniform(&seed, 1.0, 1.3);
    wall[a] = cell[2] < 3;
  }
  for (int j = 0; j < GRAINS; j++) {
    for (int c = 0; c < 3; c++) x[3 * j + c] = uniform(&seed, 0.1, c == 2 ? 3.2 : 3.9);
    V[j] = uniform(&seed, 0.01, 0.06);
  }
  sd_cells cells = {0};
  if (sd_cells_fill(&cells, points, WATER, 1.0) != SD_OK) return -1;
  sd_sph_look_around(&cells, points, GRAINS, x, 2.0 * h, first, NULL);
  particle = malloc(sizeof(int) * (size_t) first[GRAINS]);
  weight = malloc(sizeof(double) * (size_t) first[GRAINS]);
  sd_sph_look_around(&cells, points, GRAINS, x, 2.0 * h, first, particle);
  sd_cells_free(&cells);
  list = (sd_sph_around){GRAINS, first, particle, weight};
  sd_sph_grain_weights(SD_SPH_WENDLAND, h, &list, x, &(sd_sph_points){points, volume, wall}, wet);
  return 0;
}

static int tear_down(void **state)
{
  (void) state;
  free(particle);
  free(weight);
  return 0;
}

static void all_that_is_near_is_found(void **state)
{
  (void) state;
  int pairs = 0;
  for (int j = 0; j < GRAINS; j++)
    for (int a = 0; a < WATER; a++) {
      double r2 = 0.0;
      for (int c = 0; c < 3; c++) r2 += pow(x[3 * j + c] - points[3 * a + c], 2);
      pairs += r2 < 4.0 * h * h;
    }
  assert_int_equal(pairs, first[GRAINS]);
}

/* sum_a V_a phi_a = sum_j t_j V_j, whatever the water is. */
static void no_volume_is_lost(void **state)
{
  (void) state;
  double phi[WATER] = {0.0}, in_water = 0.0, of_grains = 0.0;
  sd_sph_grain_fractions(&list, &grains, volume, phi);
  for (int a = 0; a < WATER; a++) in_water += volume[a] * phi[a];
  for (int j = 0; j < GRAINS; j++) {
    of_grains += wet[j] * V[j];
    assert_true(wet[j] > 0.1 && wet[j] <= 1.0);
  }
  CHECK_NEAR(in_water, of_grains, 1e-14 * of_grains);
}

/* The work of forces f on the water, which keeps 1 - phi of them, and of the stresses that they
 * put on grains is f.q: what pressure gives, the rate of the density takes. Momentum is kept. */
static void forces_work_on_the_flux(void **state)
{
  (void) state;
  uint64_t seed = 12;
  double f[3 * WATER], v[3 * WATER], U[3 * GRAINS], shared[3 * WATER], T[3 * GRAINS], phi[WATER] = {0.0},
      q[3 * WATER] = {0.0}, work = 0.0, of_flux = 0.0, size = 0.0, kept[3] = {0.0};
  for (int k = 0; k < 3 * WATER; k++) {
    f[k] = wall[k / 3] ? 0.0 : uniform(&seed, -1.0, 2.0);
    v[k] = uniform(&seed, -3.0, 1.0);
    shared[k] = f[k];
  }
  for (int k = 0; k < 3 * GRAINS; k++) U[k] = uniform(&seed, -1.0, 5.0);
  sd_sph_grain_stresses(&list, &grains, WATER, volume, shared, T);
  sd_sph_grain_fractions(&list, &grains, volume, phi);
  sd_sph_grain_flux(&list, &grains, volume, U, q);
  sd_sph_grain_water_flux(WATER, phi, v, q);
  for (int k = 0; k < 3 * WATER; k++) {
    const double eps = 1.0 - phi[k / 3];
    work += eps * f[k] * v[k];
    kept[k % 3] -= phi[k / 3] * f[k];
    of_flux += f[k] * q[k];
    size += fabs(f[k] * v[k]);
  }
  for (int k = 0; k < 3 * GRAINS; k++) {
    work += T[k] * U[k];
    kept[k % 3] += T[k];
  }
  CHECK_NEAR(work, of_flux, 1e-13 * size);
  for (int c = 0; c < 3; c++) CHECK_NEAR(kept[c], 0.0, 1e-13 * WATER);
}

/* The water gets what the grains get, to rounding, and a field that is the same everywhere is its
 * own mean. */
static void means_and_reactions_are_adjoint(void **state)
{
  (void) state;
  uint64_t seed = 8;
  double F[3 * GRAINS], u[3 * WATER], reaction[3 * WATER] = {0.0}, mean[3 * GRAINS];
  double work_of_grains = 0.0, work_of_water = 0.0, sum[2][3] = {{0.0}};
  for (int k = 0; k < 3 * GRAINS; k++) F[k] = uniform(&seed, -2.0, 3.0);
  for (int k = 0; k < 3 * WATER; k++) u[k] = uniform(&seed, -1.0, 4.0);
  sd_sph_grain_vector_means(&list, u, mean);
  double up[WATER], mean_up[GRAINS];
  for (int i = 0; i < WATER; i++) up[i] = u[3 * i + 2];
  sd_sph_grain_means(&list, up, mean_up);
  for (int j = 0; j < GRAINS; j++) CHECK_NEAR(mean_up[j], mean[3 * j + 2], 1e-15);
  sd_sph_grain_reactions(&list, F, reaction);
  for (int k = 0; k < 3 * GRAINS; k++) {
    work_of_grains += F[k] * mean[k];
    sum[0][k % 3] += F[k];
  }
  for (int k = 0; k < 3 * WATER; k++) {
    work_of_water += reaction[k] * u[k];
    sum[1][k % 3] -= reaction[k];
  }
  CHECK_NEAR(work_of_water, -work_of_grains, 1e-12 * fabs(work_of_grains));
  for (int c = 0; c < 3; c++) CHECK_NEAR(sum[1][c], sum[0][c], 1e-12 * 60.0);
}

/* T(0) by the closed form of a kernel's mean of 1/r over both sides: the Oseen tensor's trace,
 * with S = 1 for waves that are long beside h, would be 1.074; the friction of SPH lets it rise to
 * 1.171 (both by a quadrature of another program). At Re_h = 20, 0.1237. Large Re: like 1/Re, as
 * momentum goes away with the flow. */
static void own_flow_has_its_limits(void **state)
{
  (void) state;
  sd_sph_wake wake, laplacian;
  sd_sph_wake_make(SD_SPH_WENDLAND, 0, &wake);
  sd_sph_wake_make(SD_SPH_WENDLAND, 1, &laplacian);
  CHECK_NEAR(sd_sph_wake_of(&wake, 0.0, 0.0), 1.1710, 2e-4);
  CHECK_NEAR(sd_sph_wake_of(&wake, 20.0, 0.0), 0.1237, 1e-3);
  CHECK_NEAR(sd_sph_wake_of(&wake, 8e4, 0.0) / sd_sph_wake_of(&wake, 4e4, 0.0), 0.5, 0.02);
  /* S falls as with k: that of laplacian, k^2/20 <r^2>, more than central, k^2/28 <r^2> */
  assert_true(laplacian.T[0] > wake.T[0] && laplacian.T[0] < 1.3);
  /* Brinkman: 1 - K/T(0) for small K, T_2/K^2 for large */
  const double K = 1e-4, T = wake.T[0];
  CHECK_NEAR((sd_sph_wake_of(&wake, 0.0, K) - T) / K, -1.0, 1e-3);
  CHECK_NEAR(sd_sph_wake_of(&wake, 0.0, 1e4) * 1e8, wake.T_2, 1e-2 * wake.T_2);
}

/* Carnahan & Starling's compressibility: s = 1/(d(phi Z)/d phi), Z = (1 + phi + phi^2 - phi^3)/(1
 * - phi)^3. */
static double pressure_of_spheres(double phi)
{
  return phi * (1.0 + phi + phi * phi - phi * phi * phi) / pow(1.0 - phi, 3);
}
static void structure_is_the_compressibility_of_spheres(void **state)
{
  (void) state;
  const double d = 1e-5;
  assert_true(sd_sph_structure(0.0) == 1.0);
  for (double phi = 0.05; phi < 0.6; phi += 0.11) {
    const double slope = (pressure_of_spheres(phi + d) - pressure_of_spheres(phi - d)) / (2.0 * d);
    CHECK_NEAR(sd_sph_structure(phi) * slope, 1.0, 1e-7);
  }
}

static void a_lone_grain_sees_no_other(void **state)
{
  (void) state;
  const double mean[3] = {0.02, 0.02, 0.4}, own[3] = {0.02, 0.01, 0.02};
  double phi[3];
  sd_sph_grain_phi(3, mean, own, phi);
  CHECK_NEAR(phi[0], 0.0, 1e-6);
  for (int k = 1; k < 3; k++) CHECK_NEAR(phi[k], mean[k] - sd_sph_structure(phi[k]) * own[k], 1e-8);
  assert_true(phi[2] > 0.398);
}

/* Without own flow: (1 - phi) of the law, at rest and fast. With it: the drag is that of the slip
 * without the flow which that drag makes. */
static void drag_is_that_of_the_law(void **state)
{
  (void) state;
  static sd_sph_wake wake;
  sd_sph_wake_make(SD_SPH_WENDLAND, 0, &wake);
  const double a = 0.27, rho = 1.3, eta = 0.7, u[3] = {0.0, 0.0, 0.0}, one = 1.0, none = 0.0,
               some = 0.3;
  for (double Re = 0.1; Re < 300.0; Re *= 10.0) {
    const double speed = Re * eta / (2.0 * a * rho), v[3] = {0.0, 0.6 * speed, -0.8 * speed};
    sd_sph_grain_law law = {SD_SPH_WENDLAND,
                            1.2,
                            eta,
                            {SD_DRAG_BROWN_LAWLER, SD_HINDRANCE_RICHARDSON_ZAKI, 0.0},
                            0.0,
                            NULL};
    const sd_sph_grains grain = {&a, NULL, &one};
    const sd_sph_slip slipping = {u, v};
    double k;
    sd_sph_grain_drag(&law, 1, &grain, &slipping, &rho, &some, &k);
    const double right = sd_drag_factor(law.drag, rho, eta, a, 0.7, speed);
    CHECK_NEAR(k, 0.7 * right, 1e-12 * right);
    law.wake = &wake;
    sd_sph_grain_drag(&law, 1, &grain, &slipping, &rho, &none, &k);
    const double D = k * speed,
                 slip = speed +
        D *
            sd_sph_wake_of(
                &wake, rho * law.h * D / eta / sd_drag_factor(law.drag, rho, eta, a, 1.0, speed),
                0.0) /
            (6.0 * SD_PI * eta * law.h);
    CHECK_NEAR(D, sd_drag_factor(law.drag, rho, eta, a, 1.0, slip) * slip, 0.01 * D);
    assert_true(D > 1.001 * sd_drag_factor(law.drag, rho, eta, a, 1.0, speed) * speed);
  }
}

/* Drag without end between grains and water of any velocities: one step takes kinetic energy away,
 * at least half of what all of the drag could, since x.C x <= sum_j x_j^2 sum_i C_ji k_i/k_j for
 * what grains do to each other through the water, C = sum_a w_aj w_ai/m_a. */
static void stiff_drag_takes_energy(void **state)
{
  (void) state;
  uint64_t seed = 21;
  double k[GRAINS], M[GRAINS], v[3 * GRAINS], U[3 * WATER], u[3 * GRAINS], D[3 * GRAINS],
      total[WATER] = {0.0}, change[3 * WATER] = {0.0}, before = 0.0, after = 0.0;
  const double dt = 0.01;
  for (int j = 0; j < GRAINS; j++) {
    k[j] = uniform(&seed, 1e9, 3e9);
    M[j] = uniform(&seed, 300.0, 1000.0) * V[j];
  }
  for (int n = 0; n < 3 * GRAINS; n++) v[n] = uniform(&seed, -1.0, 2.0);
  for (int n = 0; n < 3 * WATER; n++) U[n] = uniform(&seed, -1.0, 1.0);
  sd_sph_grain_load(&list, k, total);
  for (int a = 0; a < WATER; a++) total[a] /= volume[a];
  sd_sph_grain_vector_means(&list, U, u);
  sd_sph_grain_drags(&list, dt, &(sd_sph_slip){u, v}, M, k, total, D);
  sd_sph_grain_reactions(&list, D, change);
  double possible = 0.0;
  for (int n = 0; n < 3 * GRAINS; n++) {
    possible += 0.5 * dt * D[n] * (u[n] - v[n]);
    before += 0.5 * M[n / 3] * v[n] * v[n];
    after += 0.5 * M[n / 3] * pow(v[n] + dt * D[n] / M[n / 3], 2);
  }
  for (int n = 0; n < 3 * WATER; n++) {
    before += 0.5 * volume[n / 3] * U[n] * U[n];
    after += 0.5 * volume[n / 3] * pow(U[n] + dt * change[n] / volume[n / 3], 2);
  }
  assert_true(possible > 0.1);
  assert_true(before - after >= possible * (1.0 - 1e-9));
}

/* Water that is displaced by the grains leaves room for them: the particles keep their volumes. */
static void grains_displace_water(void **state)
{
  (void) state;
  const double rho[4] = {1.1, 1.2, 1.3, 1.4}, none[4] = {0.0}, phi[4] = {0.3, 0.5, 0.0, 0.2};
  const int row[3] = {3, 0, 1};
  double mass[4] = {0.4, 0.5, 0.6, 0.7}, before[3], after[3];
  sd_sph_grain_volumes(3, row, mass, rho, none, before);
  CHECK_NEAR(before[0], 0.7 / 1.4, 1e-15);
  sd_sph_grain_displace(3, row, phi, mass);
  sd_sph_grain_volumes(3, row, mass, rho, phi, after);
  for (int a = 0; a < 3; a++) CHECK_NEAR(after[a], before[a], 1e-15);
  CHECK_NEAR(mass[3], 0.8 * 0.7, 1e-15);
  assert_true(mass[2] == 0.6);
}

/* Momentum grows by the impulse of both forces; what forces do not move keeps its velocity. */
static void a_push_is_an_impulse(void **state)
{
  (void) state;
  const double dt = 0.03, f[6] = {1, 2, 3, 4, 5, 6}, F[6] = {-0.3, 0.2, 0.1, 7, 8, 9}, M[2] = {0.7, HUGE_VAL};
  for (int both = 0; both < 2; both++) {
    double v[6] = {0.5, -0.5, 0.25, 1, 2, 3};
    sd_sph_grain_push(2, dt, f, both ? F : NULL, M, v);
    CHECK_NEAR(M[0] * (v[1] + 0.5), dt * (f[1] + (both ? F[1] : 0.0)), 1e-15);
    assert_true(v[3] == 1 && v[4] == 2 && v[5] == 3);
  }
}

/* The water between fixed grains is squeezed by 1/eps of what the flux brings; what shift adds
 * stays. */
static void rates_are_those_of_the_room_between_grains(void **state)
{
  (void) state;
  const double phi[2] = {0.3, 0.0},
               slope[8] = {0.05, 0.3, -0.2, 1.1, 1, 1, 1, 1}, du[8] = {0.7, -0.3, 0.9, 0.0, 1, 1, 1, 0};
  const double shifted = 0.05 * 0.7 - 0.3 * 0.3 - 0.2 * 0.9;
  double rate[2] = {2.0 + shifted, 5.0}, plain[2] = {2.0, 5.0};
  sd_sph_grain_rates(2, phi, slope, du, rate);
  CHECK_NEAR(rate[0], 2.0 / 0.7 + shifted, 1e-15);
  CHECK_NEAR(rate[1], 5.0, 0.0);
  sd_sph_grain_rates(2, phi, NULL, NULL, plain);
  CHECK_NEAR(plain[0], 2.0 / 0.7, 1e-15);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(all_that_is_near_is_found),
                                     cmocka_unit_test(no_volume_is_lost),
                                     cmocka_unit_test(forces_work_on_the_flux),
                                     cmocka_unit_test(means_and_reactions_are_adjoint),
                                     cmocka_unit_test(own_flow_has_its_limits),
                                     cmocka_unit_test(structure_is_the_compressibility_of_spheres),
                                     cmocka_unit_test(a_lone_grain_sees_no_other),
                                     cmocka_unit_test(drag_is_that_of_the_law),
                                     cmocka_unit_test(stiff_drag_takes_energy),
                                     cmocka_unit_test(grains_displace_water),
                                     cmocka_unit_test(a_push_is_an_impulse),
                                     cmocka_unit_test(rates_are_those_of_the_room_between_grains)};
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
