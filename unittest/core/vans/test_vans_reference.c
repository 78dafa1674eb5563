/* Forces, averages and fluid solves against the reference tables, under both rules. Tolerances: the tables have 17
 * digits; forces and averages are sums of a few tens of terms (1e-12 of the largest entry), a fluid solve is a hundred
 * tridiagonal solves (1e-9). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h> /* after the headers that it needs */

#include "sd_vans.h"
#include "vans_table.h"
#include "yade_drag.h"

enum { N_MAX = 64 };
static double edges[N_MAX + 1];

static sd_vans_mesh mesh_of(const vans_table *t, double z_ref)
{
  const sd_vans_mesh mesh = {(int) vans_key(t, "nCell", 0), z_ref, vans_key(t, "deltaZ", 0), edges};
  for (int j = 0; j <= mesh.ncell; j++) edges[j] = j * mesh.dz;
  return mesh;
}

static void vectors(vans_table *t, const char *x, const char *y, const char *z, int n, double *out)
{
  const double *c[3] = {vans_column(t, x), vans_column(t, y), vans_column(t, z)};
  for (int i = 0; i < n; i++)
    for (int d = 0; d < 3; d++) out[3 * i + d] = c[d][i];
}

static void check_forces(const char *name, sd_vans_rules rules)
{
  char profiles[64];
  snprintf(profiles, sizeof profiles, "%s_profiles", name);
  vans_table *t = vans_read(name), *p = vans_read(profiles);
  const sd_vans_mesh mesh = mesh_of(t, vans_key(t, "zRef", 0));
  sd_vans_force_law law = {.rho = vans_key(t, "densFluid", 0),
                           .eta = vans_key(t, "viscoDyn", 0),
                           .exponent = vans_key(t, "expoRZ", 0),
                           .rest = vans_key(t, "steadyFlow", 0) == 0.0,
                           .rules = rules};
  for (int d = 0; d < 3; d++) law.g[d] = vans_key(t, "gravity", d);
  enum { n = 60 };
  double x[3 * n], v[3 * n], u[3 * n], F[3 * n], reference[3 * n], hindrance[N_MAX];
  vectors(t, "x", "y", "z", n, x);
  vectors(t, "vx", "vy", "vz", n, v);
  vectors(t, "ufx", "ufy", "ufz", n, u);
  vectors(t, "fx", "fy", "fz", n, reference);
  hindrance_of(mesh.ncell, vans_column(p, "phi"), law.exponent, hindrance);
  const sd_vans_grains grains = {n, x, v, vans_column(t, "radius"), u, NULL, NULL, NULL};
  const sd_vans_ambient stream = {&mesh, &law, vans_column(p, "vxFluid"), hindrance};
  const int outside =
      sd_vans_forces(&stream, &grains, F, NULL);
  assert_int_equal(outside, 8);
  /* Yade forgets the grains outside the mesh, which is what the table has; the consistent rule moves and lifts them. */
  if (rules == SD_VANS_CONSISTENT)
    for (int i = 0; i < n; i++)
      if (reference[3 * i] == 0.0 && reference[3 * i + 2] == 0.0) {
        assert_true(F[3 * i + 2] != 0.0);
        for (int d = 0; d < 3; d++) F[3 * i + d] = 0.0;
      }
  assert_true(vans_difference(F, reference, 3 * n) < 1e-12);
  free(t);
  free(p);
}

static void forces_steady(void **state)
{
  (void) state;
  check_forces("force_steady", SD_VANS_YADE);
  check_forces("force_steady", SD_VANS_CONSISTENT);
}

static void forces_at_rest(void **state)
{
  (void) state;
  check_forces("force_unsteady", SD_VANS_YADE);
  check_forces("force_unsteady", SD_VANS_CONSISTENT);
}

static void check_averages(const char *name, int classes, sd_vans_rules rules)
{
  char file[64];
  snprintf(file, sizeof file, "%s_spheres", name);
  vans_table *t = vans_read(file);
  snprintf(file, sizeof file, "%s_profiles", name);
  vans_table *p = vans_read(file);
  snprintf(file, sizeof file, "%s_profiles%s", name, rules == SD_VANS_YADE ? "" : ".consistent");
  vans_table *r = vans_read(file);
  const sd_vans_mesh mesh = mesh_of(t, vans_key(t, "zRef", 0));
  const int N = mesh.ncell;
  const double radii[2] = {vans_key(t, "radiusParts", 0), vans_key(t, "radiusParts", 1)};
  const sd_vans_force_law law = {.rho = vans_key(t, "densFluid", 0),
                                 .eta = vans_key(t, "viscoDyn", 0),
                                 .exponent = vans_key(t, "expoRZ", 0),
                                 .rules = rules};
  const sd_vans_averaging how = {0, classes, radii, NULL, NULL};
  enum { n = 60 };
  double x[3 * n], v[3 * n], u[3 * n], hindrance[N_MAX], V[2 * N_MAX], profile[5 * N_MAX];
  vectors(t, "x", "y", "z", n, x);
  vectors(t, "vx", "vy", "vz", n, v);
  vectors(t, "ufx", "ufy", "ufz", n, u);
  const sd_vans_grains grains = {n, x, v, vans_column(t, "radius"), u, NULL, NULL, NULL};
  double phi[N_MAX];
  memcpy(phi, vans_column(p, "phi_in"), N * sizeof(double));
  for (int call = 1; call <= 2; call++) {
    double sums[3 * N_MAX * SD_VANS_ROWS] = {0};
    hindrance_of(N, phi, law.exponent, hindrance);
    const sd_vans_ambient stream = {&mesh, &law, vans_column(p, "vxFluid"), hindrance};
    assert_int_equal(sd_vans_average(&stream, &how, &grains, sums, V),
                     -1);
    for (int c = -1; c < classes; c++) {
      sd_vans_profiles(&mesh, vans_key(t, "vCell", 0) / mesh.dz,
                       sums + (1 + c) * N * SD_VANS_ROWS, profile);
      static const char *const names[] = {"phi", "vx", "vy", "vz", "drag"};
      for (int k = 0; k < 5; k++) {
        char column[32];
        if (c < 0)
          snprintf(column, sizeof column, "%s_%d", names[k], call);
        else
          snprintf(column, sizeof column, "%s_c%d_%d", names[k], c, call);
        assert_true(vans_difference(profile + k * N, vans_column(r, column), N) < 1e-12);
      }
      if (c < 0) memcpy(phi, profile, N * sizeof(double));
    }
  }
  free(t);
  free(p);
  free(r);
}

static void averages_of_one_class(void **state)
{
  (void) state;
  check_averages("avg_fine", 0, SD_VANS_YADE);
  check_averages("avg_fine", 0, SD_VANS_CONSISTENT);
}

static void averages_of_two_classes(void **state)
{
  (void) state;
  check_averages("avg_twosize", 2, SD_VANS_YADE);
  check_averages("avg_twosize", 2, SD_VANS_CONSISTENT);
}

static void check_fluid(const char *name, sd_vans_rules rules)
{
  char file[64];
  vans_table *t = vans_read(name);
  snprintf(file, sizeof file, "%s%s", name, rules == SD_VANS_YADE ? "" : ".consistent");
  vans_table *r = vans_read(file);
  const sd_vans_mesh mesh = mesh_of(t, 0.0);
  const int N = mesh.ncell;
  const double radii[2] = {vans_key(t, "radiusParts", 0), vans_key(t, "radiusParts", 1)};
  const sd_vans_fluid fluid = {
      .rho = vans_key(t, "densFluid", 0),
      .eta = vans_key(t, "viscoDyn", 0),
      .gx = vans_key(t, "gravity", 0),
      .dpdx = vans_key(t, "dpdx", 0),
      .turbulence = vans_key(t, "iturbu", 0) == 0.0 ? SD_VANS_LAMINAR
                                                    : SD_VANS_KZ + (int) vans_key(t, "ilm", 0),
      .kappa = vans_key(t, "kappa", 0),
      .phi_max = vans_key(t, "phiMax", 0),
      .phi_bed = vans_key(t, "phiBed", 0),
      .sublayer = (int) vans_key(t, "viscousSubLayer", 0),
      .viscosity = (sd_vans_viscosity) vans_key(t, "irheolf", 0),
      .driven = vans_key(t, "iusl", 0) == 0.0,
      .u_top = vans_key(t, "uTop", 0),
      .width = vans_key(t, "fluidWallFriction", 0) != 0.0 ? vans_key(t, "channelWidth", 0) : 0.0,
      .wall_coef = vans_key(t, "fluidFrictionCoef", 0),
      .radius = vans_key(t, "radiusPart", 0),
      .nclass = vans_find(t, "phi_c0") ? 2 : 0,
      .class_radius = radii,
      .least_slip = 1e-5,
      .rules = rules};
  double classes[2 * SD_VANS_ROWS * N_MAX], b[N_MAX], length[N_MAX], scratch[2 * N_MAX],
      U[N_MAX + 1], nut[N_MAX], stress[N_MAX], profile[SD_VANS_ROWS * N_MAX], cut[2];
  for (int c = 0; c < fluid.nclass; c++)
    memcpy(classes + c * SD_VANS_ROWS * N, vans_column(t, c ? "phi_c1" : "phi_c0"),
           N * sizeof(double));
  const double *phi = vans_column(t, "phi"), *vx = vans_column(t, "vx");
  memcpy(U, vans_column(t, "u_in"), (N + 1) * sizeof(double));

  double dt = vans_key(t, "dt", 0);
  const int64_t steps = sd_vans_steps(rules, vans_key(t, "t_end", 0), &dt);
  assert_int_equal(steps, rules == SD_VANS_YADE ? 101 : 100);
  memcpy(profile, phi, N * sizeof(double));
  memcpy(profile + SD_VANS_VX * N, vx, N * sizeof(double));
  memcpy(profile + SD_VANS_DRAG * N, vans_column(t, "drag"), N * sizeof(double));
  sd_vans_exchange(&mesh, &fluid, dt, U, &(sd_vans_means){profile, NULL, NULL}, b, cut);
  const sd_vans_mixture now = {U, phi, fluid.nclass ? classes : NULL, phi};
  sd_vans_mixing_length(&mesh, &fluid, &now, length, scratch);
  sd_vans_solver *solver = sd_vans_solver_create(&mesh);
  const sd_vans_column column = {phi, vx, b, length, NULL};
  const sd_vans_flow flow = {U, nut, stress};
  assert_int_equal(sd_vans_solve(solver, &fluid, &column, steps, dt, &flow, NULL), SD_OK);
  sd_vans_solver_free(solver);
  assert_true(vans_difference(U, vans_column(r, "u_out"), N + 1) < 1e-9);
  assert_true(vans_difference(b, vans_column(r, "taufsi"), N) < 1e-9);
  assert_true(vans_difference(nut, vans_column(r, "nut"), N) < 1e-9);
  assert_true(vans_difference(stress, vans_column(r, "stress"), N) < 1e-9);
  free(t);
  free(r);
}

static void fluid_solves(void **state)
{
  (void) state;
  static const char *const names[] = {"fluid_lam_dpdx", "fluid_lam_visc0",     "fluid_turb_lm1",
                                      "fluid_turb_lm2", "fluid_turb_lm2_wall", "fluid_turb_lm5"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    check_fluid(names[k], SD_VANS_YADE);
    check_fluid(names[k], SD_VANS_CONSISTENT);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(forces_steady),         cmocka_unit_test(forces_at_rest),
      cmocka_unit_test(averages_of_one_class), cmocka_unit_test(averages_of_two_classes),
      cmocka_unit_test(fluid_solves),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
