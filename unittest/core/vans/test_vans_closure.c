/* Closures where they have a closed form, and what profiles tell. */
#include "column.h"

#include "sd_vans_random.h"

/* Mixing lengths where they have a closed form. */
static void mixing_lengths(void **state)
{
  (void) state;
  enum { N = 51 };
  column *c = column_create(N, 0.5, 0.0);
  sd_vans_fluid fluid = {
      .rho = 1000, .eta = 1e-3, .kappa = 0.4, .phi_max = 0.6, .phi_bed = 0.1, .radius = 0.003};
  const double dz = 0.01, H = 0.5;
#define LENGTH(which)       \
  fluid.turbulence = which; \
  find_lengths(c, &fluid, NULL)
  LENGTH(SD_VANS_KZ);
  for (int j = 0; j < N; j++) assert_true(fabs(c->length[j] - 0.4 * j * dz) < 1e-15);
  LENGTH(SD_VANS_PARABOLIC);
  for (int j = 0; j < N; j++)
    assert_true(fabs(c->length[j] - 0.4 * j * dz * sqrt(fmax(1.0 - j * dz / H, 0.0))) < 1e-9);
  assert_true(c->length[N - 1] == 0.0);
  /* clear water: Li & Sawamoto is kappa z, pipe the distance to the nearer of bottom and surface */
  LENGTH(SD_VANS_LI_SAWAMOTO);
  for (int j = 0; j < N; j++) assert_true(fabs(c->length[j] - 0.4 * j * dz) < 1e-14);
  LENGTH(SD_VANS_PIPE);
  for (int j = 0; j < N; j++)
    assert_true(fabs(c->length[j] - 0.4 * fmin(j * dz, H - j * dz)) < 1e-14);
  /* a bed of 20 slices above phi_max: no length in it, kappa (z - bed) above; Yade's loses a little in the highest of
     them */
  for (int n = 0; n < 20; n++) c->phi[n] = 0.62;
  LENGTH(SD_VANS_LI_SAWAMOTO);
  for (int j = 0; j < N; j++) assert_true(fabs(c->length[j] - 0.4 * fmax(j - 20, 0) * dz) < 1e-14);
  fluid.rules = SD_VANS_YADE;
  LENGTH(SD_VANS_LI_SAWAMOTO);
  assert_true(fabs(c->length[20] - 0.4 * dz * (0.6 - 0.62) / 0.6) < 1e-15);
  fluid.rules = SD_VANS_CONSISTENT;
  LENGTH(SD_VANS_NI_CAPART); /* the bed is the lower edge of the highest slice above phi_bed */
  const double pore = (1 - 0.62) / 0.62 * 0.003 / 3;
  for (int j = 0; j < N; j++)
    assert_true(
        fabs(c->length[j] - fmax(j < 20 ? fmin(pore / 2, 0.2 * 0.006) : 0.0, 0.4 * (j - 19) * dz)) <
            1e-12 ||
        (j >= 20 && c->length[j] >= 0.4 * (j - 19) * dz));
  LENGTH(SD_VANS_ROUSSEAU);
  for (int j = 1; j < N; j++)
    assert_true(fabs(c->length[j] - 0.5 * 0.4 / 0.6 * 0.001) <
                1e-15); /* water at rest: van Driest's factor is 0 */
  LENGTH(SD_VANS_PORE);
  assert_true(c->length[0] == 0.0 && c->length[10] <= 0.4 * dz * 1.0000001);
#undef LENGTH
  column_free(c);
}

/* The lengths over a bed, told in micrometres: clear water has no pores, so no number stands for theirs. */
static void lengths_are_the_same_in_any_unit(void **state)
{
  (void) state;
  enum { N = 51 };
  const double unit[2] = {1.0, 1e6};
  const sd_vans_turbulence laws[2] = {SD_VANS_PORE, SD_VANS_NI_CAPART};
  for (int law = 0; law < 2; law++) {
    double length[2][N];
    for (int u = 0; u < 2; u++) {
      column *c = column_create(N, 0.5 * unit[u], 0.0);
      const sd_vans_fluid fluid = {.kappa = 0.4, .phi_max = 0.6, .phi_bed = 0.1, .radius = 0.003 * unit[u],
                                   .turbulence = laws[law]};
      for (int n = 0; n < 20; n++) c->phi[n] = 0.62;
      find_lengths(c, &fluid, NULL);
      for (int j = 0; j < N; j++) length[u][j] = c->length[j] / unit[u];
      column_free(c);
    }
    for (int j = 0; j < N; j++) assert_true(fabs(length[1][j] - length[0][j]) < 1e-12);
    assert_true(length[1][N - 1] > 0.4 * 0.29);
  }
}

/* With bed_mixing C no length is below C diameters at a node with grains on either side, of their mean diameter where
 * there are two sizes; elsewhere, and on the bottom, the law stands. Between narrow walls the width has the last
 * word. */
static void lengths_among_grains(void **state)
{
  (void) state;
  enum { N = 51 };
  column *c = column_create(N, 0.5, 0.0);
  const double a[2] = {0.003, 0.006};
  sd_vans_fluid fluid = {.rho = 1000, .eta = 1e-3, .kappa = 0.4, .phi_max = 0.6, .radius = 0.003,
                         .turbulence = SD_VANS_LI_SAWAMOTO};
  double plain[N], classes[2 * SD_VANS_ROWS * N] = {0};
  for (int n = 0; n < 20; n++) c->phi[n] = n < 15 ? 0.61 : 0.59;
  find_lengths(c, &fluid, NULL);
  memcpy(plain, c->length, sizeof plain);
  fluid.bed_mixing = 0.7;
  find_lengths(c, &fluid, NULL);
  for (int j = 0; j < N; j++)
    assert_true(fabs(c->length[j] - (j > 0 && j <= 20 ? fmax(plain[j], 0.7 * 0.006) : plain[j])) < 1e-17);
  assert_true(plain[10] == 0.0 && c->length[10] > 0.0 && plain[20] < 0.7 * 0.006);
  /* as many grains of either size: 6 sum V/sum S. Yade weights both sums with phi. */
  for (int n = 0; n < 15; n++) classes[n] = 0.61 * 27 / (27 + 216.0), classes[SD_VANS_ROWS * N + n] = 0.61 * 216 /
      (27 + 216.0);
  fluid.nclass = 2;
  fluid.class_radius = a;
  find_lengths(c, &fluid, classes);
  assert_true(fabs(c->length[10] / (0.7 * 2 * (27 + 216) / (9 + 36.0) * 0.001) - 1) < 1e-14);
  fluid.rules = SD_VANS_YADE;
  find_lengths(c, &fluid, classes);
  assert_true(fabs(c->length[10] / (0.7 * 2 * (27 * 27 + 216 * 216) / (27 * 9 + 216 * 36.0) * 0.001) - 1) < 1e-14);
  fluid.rules = SD_VANS_CONSISTENT;
  fluid.narrow = 1;
  fluid.width = 0.01;
  find_lengths(c, &fluid, NULL);
  assert_true(c->length[10] == 0.5 * 0.4 * 0.01);
  column_free(c);
}

static void effective_viscosities(void **state)
{
  (void) state;
  sd_vans_fluid fluid = {.rho = 1100, .eta = 2e-3};
  const double nu = 2e-3 / 1100;
  assert_true(sd_vans_effective_viscosity(&fluid, 0.3, 0) == nu);
  fluid.viscosity = SD_VANS_EINSTEIN;
  assert_true(fabs(sd_vans_effective_viscosity(&fluid, 0.3, 0) / nu - 1.75) < 1e-15);
  fluid.viscosity = SD_VANS_POWER;
  assert_true(fabs(sd_vans_effective_viscosity(&fluid, 0.3, 1) / nu - pow(0.7, -2.8)) < 1e-14);
  fluid.rules = SD_VANS_YADE;
  assert_true(fabs(sd_vans_effective_viscosity(&fluid, 0.3, 1) / nu - 1.75) < 1e-15);
}

/* Between the bottom and the middle of the lowest slice the stress is eta U/(dz/2), whatever the sign. */
static void the_lowest_slice_is_measured_by_its_own_stress(void **state)
{
  (void) state;
  const double edge[3] = {0.0, 0.004, 0.007}, u_star = 0.05, rho = 1100, eta = 2e-3;
  const double U[4] = {0.0, -rho * u_star * u_star / eta * 0.002, 7.0, 7.0};
  const sd_vans_mesh mesh = {2, 0.1, 0.0, edge};
  const sd_vans_fluid fluid = {.rho = rho, .eta = eta};
  assert_true(fabs(sd_vans_bottom_slice(&mesh, &fluid, U) / (0.004 * u_star * rho / eta) - 1.0) < 1e-14);
}

/* A bed up to 10 slices with its loosest grains on top, water of 0.5 above it. */
static void profiles_tell_bed_transport_and_times(void **state)
{
  (void) state;
  enum { N = 21 };
  const double dz = 0.002;
  double edge[N + 1], profile[SD_VANS_ROWS * N] = {0}, U[N + 1], stress[N] = {0};
  for (int n = 0; n <= N; n++) edge[n] = n * dz;
  for (int n = 0; n <= N; n++) U[n] = n > 10 ? 0.5 : 0.01;
  for (int n = 0; n < 10; n++) profile[n] = n == 9 ? 0.3 : n == 6 ? 0.62 : 0.6;
  for (int n = 0; n < 10; n++) profile[SD_VANS_VX * N + n] = 0.02 * n;
  const sd_vans_mesh mesh = {N, 0.1, dz, edge};
  double q = 0.3 * 0.18 * dz + 0.62 * 0.12 * dz;
  for (int n = 0; n < 9; n++) q += n == 6 ? 0.0 : 0.6 * 0.02 * n * dz;
  assert_true(fabs(sd_vans_transport(&mesh, profile) / q - 1.0) < 1e-14);
  assert_true(sd_vans_bed_elevation(&mesh, profile) == 0.5 * (edge[8] + edge[9]));
  profile[7] = profile[8] = 0.4; /* the maximum of 0.62 is the highest above 0.5 */
  assert_true(sd_vans_bed_elevation(&mesh, profile) == 0.5 * (edge[6] + edge[7]));
  for (int n = 0; n < N; n++) profile[n] *= 0.5;
  assert_true(sd_vans_bed_elevation(&mesh, profile) == 0.0);
  /* 10 slices under the surface at edge 20 */
  assert_true(fabs(sd_vans_depth_over_velocity(&mesh, U, 10 * dz) - 10 * dz / 0.5) < 1e-15);
  assert_true(sd_vans_depth_over_velocity(&mesh, U, 20 * dz) == 0.0);
  /* 30 H/u_star, u_star from the slope or from the stress */
  sd_vans_fluid fluid = {.rho = 1200, .eta = 1e-3, .gx = -0.3, .dpdx = 60, .longest_life = 7.0};
  const double H = 20 * dz;
  assert_true(fabs(sd_vans_longest_life(&mesh, &fluid, stress) / (30 * sqrt(H / 0.35)) - 1.0) <
              1e-14);
  stress[3] = 40.0;
  assert_true(fabs(sd_vans_longest_life(&mesh, &fluid, stress) / (30 * H / sqrt(40.0 / 1200)) -
                   1.0) < 1e-14);
  fluid.rules = SD_VANS_YADE;
  assert_true(sd_vans_longest_life(&mesh, &fluid, stress) == 7.0);
}

/* u' scales with the friction velocity of the grain's slice; none below the bed and above the mesh. */
static void eddies_follow_their_slice(void **state)
{
  (void) state;
  const double edge[4] = {0, 0.01, 0.02, 0.03}, u_star[3] = {0.05, 0.0, 0.02};
  const sd_vans_mesh mesh = {3, -1.0, 0.01, edge};
  const sd_vans_walk walk = {42, 1, 0.004, u_star, 0.9, 0.001};
  const double z[5] = {0.003, 0.005, 0.015, 0.025, 0.035}, expected[5] = {0, 0.05, 0, 0.02, 0};
  for (int k = 0; k < 5; k++) {
    sd_vans_eddy eddy = {-1.0, 6.0};
    double u[3], normal[3], unit[3];
    sd_vans_normal3(42, 77, 6, normal);
    sd_vans_fluctuation(normal, 1.0, 1, unit);
    sd_vans_new_eddy(&mesh, 1e-6, &walk, z[k] - 1.0, 77, &eddy, u);
    for (int d = 0; d < 3; d++) assert_true(fabs(u[d] - expected[k] * unit[d]) < 1e-16);
    assert_true(eddy.count == 7.0);
    const double life =
        expected[k] > 0 ? sd_vans_eddy_life(z[k] - 0.004, 1e-6, expected[k], 0.9, 0.001) : 0.01;
    assert_true(fabs(eddy.life - life) < 1e-12);
  }
}

static void friction_velocities_have_the_sign_of_the_stress(void **state)
{
  (void) state;
  sd_vans_fluid fluid = {.rho = 900};
  const double stress[3] = {0.36, -2.25, 0.0};
  double u_star[3];
  sd_vans_friction_velocities(&fluid, 3, stress, u_star);
  assert_true(fabs(u_star[0] - 0.02) < 1e-16 && fabs(u_star[1] + 0.05) < 1e-16 && u_star[2] == 0.0);
  fluid.rules = SD_VANS_YADE;
  sd_vans_friction_velocities(&fluid, 3, stress, u_star);
  assert_true(fabs(u_star[0] - 0.02) < 1e-16 && u_star[1] == 0.0);
}

/* The step is implicit: reach (V' - V) = T (comes - U V') with the speed U = passes/V, at most comes/U after any time.
 * Water that leaves at the end where it should come in makes no step shorter. */
static void a_reach_fills_until_what_comes_passes(void **state)
{
  (void) state;
  const double V = 0.3, comes = 0.12, passes = 0.06, reach = 7.0, speed = passes / V;
  for (double T = 0.1; T < 1e5; T *= 10.0) {
    const double after = sd_vans_inflow(V, comes, passes, reach, T);
    assert_true(fabs(reach * (after - V) / (T * (comes - speed * after)) - 1.0) < 1e-9);
    assert_true(after > V && after < comes / speed);
  }
  assert_true(fabs(sd_vans_inflow(V, comes, -0.03, reach, 2.0) - (V + 2.0 * 0.15 / reach)) < 1e-16);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(mixing_lengths),
      cmocka_unit_test(lengths_are_the_same_in_any_unit),
      cmocka_unit_test(lengths_among_grains),
      cmocka_unit_test(effective_viscosities),
      cmocka_unit_test(the_lowest_slice_is_measured_by_its_own_stress),
      cmocka_unit_test(profiles_tell_bed_transport_and_times),
      cmocka_unit_test(eddies_follow_their_slice),
      cmocka_unit_test(friction_velocities_have_the_sign_of_the_stress),
      cmocka_unit_test(a_reach_fills_until_what_comes_passes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
