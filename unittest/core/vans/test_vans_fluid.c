/* The fluid alone: closed forms, orders of convergence, balance of momentum. */
#include "column.h"

#include "sd_vans_books.h"

/* Plane Poiseuille flow, both plates at rest, H apart */
static const double H = 0.7;
static const sd_vans_fluid BETWEEN_PLATES = {.rho = 1100,
                                             .eta = 2e-3,
                                             .dpdx = -0.13,
                                             .turbulence = SD_VANS_LAMINAR,
                                             .kappa = 0.41,
                                             .phi_max = 0.6,
                                             .driven = 1};

static double parabola(double z)
{
  return -BETWEEN_PLATES.dpdx / (2 * BETWEEN_PLATES.eta) * z * (H - z);
}

/* Steady discrete solution on equal slices: u = -dpdx/(2 eta) (z (H-z) + dz^2/4) in the middles; against it 1e-10,
 * against the parabola second order. */
static void poiseuille(void **state)
{
  (void) state;
  double previous = 0.0;
  for (int N = 26; N <= 401; N = (N - 1) * 4 + 1) {
    column *c = column_create(N, H, 0.0);
    solve(c, &BETWEEN_PLATES, 1000, 1e4);
    const double dz = c->mesh.dz, more = parabola(0.5 * H) * dz * dz / (H * H);
    double discrete = 0.0, worst = 0.0;
    for (int j = 0; j < N - 1; j++) {
      const double p = parabola((j + 0.5) * dz);
      discrete = fmax(discrete, fabs(c->U[j + 1] - p - more));
      worst = fmax(worst, fabs(c->U[j + 1] - p));
    }
    assert_true(discrete < 1e-10 * parabola(0.5 * H));
    if (previous > 0.0) assert_true(fabs(log(previous / worst) / log(4.0) - 2.0) < 1e-3);
    previous = worst;
    column_free(c);
  }
}

/* The same flow between slices that grow: 2.5 times as high at the top as at the bottom, second order to the parabola
   still. */
static void poiseuille_on_an_uneven_mesh(void **state)
{
  (void) state;
  double previous = 0.0;
  for (int N = 41; N <= 321; N = (N - 1) * 2 + 1) {
    column *c = column_create(N, H, 0.75);
    solve(c, &BETWEEN_PLATES, 1000, 1e4);
    double worst = 0.0;
    for (int j = 0; j < N - 1; j++) {
      const double z = 0.5 * (c->edge[j] + c->edge[j + 1]);
      worst = fmax(worst, fabs(c->U[j + 1] - parabola(z)));
    }
    if (previous > 0.0) assert_true(log(previous / worst) / log(2.0) > 1.9);
    previous = worst;
    column_free(c);
  }
}

/* du/dz of the layer: (nu + nut) u' = u_star^2 (1 - z/H), nut = (kappa z)^2 u' above the sublayer z u_star/nu =
   11.3. */
static double layer_gradient(double z, double nu, double u_star, double H, double kappa)
{
  const double stress = u_star * u_star * (1.0 - z / H);
  if (z * u_star / nu < 11.3) return stress / nu;
  const double l2 = kappa * z * kappa * z;
  return 2.0 * stress / (nu + sqrt(nu * nu + 4.0 * l2 * stress));
}

static double layer_velocity(double z, double nu, double u_star, double H, double kappa)
{
  const double sublayer = fmin(z, 11.3 * nu / u_star);
  double u = u_star * u_star / nu * (sublayer - sublayer * sublayer / (2.0 * H));
  /* Above it in ln z, Simpson. */
  if (z > sublayer) {
    enum { PANELS = 400 };
    const double a = log(sublayer), width = (log(z) - a) / PANELS;
    for (int k = 0; k < PANELS; k++)
      for (int q = 0; q < 3; q++) {
        const double s = exp(a + (k + 0.5 * q) * width) * (k + q == 0 ? 1.0 + 1e-12 : 1.0);
        u += width / 6.0 * (q == 1 ? 4.0 : 1.0) * s * layer_gradient(s, nu, u_star, H, kappa);
      }
  }
  return u;
}

/* A turbulent layer of Re_tau 900. The end of the sublayer lies between two nodes, the same way on every mesh. */
static void turbulent_layer_converges(void **state)
{
  (void) state;
  const double nu = 1.3e-6, H = 0.05, u_star = 900 * nu / H, kappa = 0.41;
  double error[4];
  for (int level = 0; level < 4; level++) {
    const int in_sublayer = 4 << level; /* dz+ = 11.3 / (4.5, 8.5, 16.5, 32.5) */
    const double dz = 11.3 * nu / u_star / (in_sublayer + 0.5);
    const int N = (int) floor(H / dz) + 1;
    const double H_mesh = (N - 1) * dz, g = u_star * u_star / H_mesh;
    column *c = column_create(N, H_mesh, 0.0);
    const sd_vans_fluid fluid = {.rho = 1000,
                                 .eta = nu * 1000,
                                 .gx = g,
                                 .turbulence = SD_VANS_KZ,
                                 .kappa = kappa,
                                 .phi_max = 0.6,
                                 .sublayer = 1};
    solve(c, &fluid, 2500, 0.5);
    error[level] = 0.0;
    for (int j = 0; j < N - 1; j++)
      error[level] = fmax(
          error[level],
          fabs(c->U[j + 1] - layer_velocity((j + 0.5) * dz, nu, u_star, H_mesh, kappa)) / u_star);
    printf("    dz+ = %.3f: largest error %.3e u_star\n", dz * u_star / nu, error[level]);
    column_free(c);
  }
  for (int level = 1; level < 4; level++)
    assert_true(log(error[level - 1] / error[level]) / log(2.0) > 1.0);
  assert_true(error[3] < 0.02);
}

/* What the water gains is what came from outside, less what it gave to the grains, plus the source; for every closure,
 * viscosity and surface. */
static void momentum_is_balanced(void **state)
{
  (void) state;
  for (int turbulence = SD_VANS_LAMINAR; turbulence <= SD_VANS_PIPE; turbulence++)
    for (int variant = 0; variant < 6; variant++) {
      const int N = 48 + variant;
      column *c = column_create(N, 0.03, variant == 3 ? 0.6 : 0.0);
      const sd_vans_fluid fluid = {.rho = 1030,
                                   .eta = variant == 1 ? 0.2 : 2e-3,
                                   .gx = 0.4,
                                   .dpdx = 35,
                                   .turbulence = (sd_vans_turbulence) turbulence,
                                   .kappa = 0.4,
                                   .phi_max = 0.61,
                                   .phi_bed = 0.08,
                                   .sublayer = variant == 5,
                                   .viscosity = (sd_vans_viscosity) (variant % 3),
                                   .driven = variant % 2,
                                   .u_top = 0.8,
                                   .width = variant >= 2 ? 0.01 : 0.0,
                                   .wall_coef = 1.1,
                                   .radius = 0.003,
                                   .rules = variant == 4 ? SD_VANS_YADE : SD_VANS_CONSISTENT};
      double source[64];
      for (int n = 0; n < N; n++) {
        c->phi[n] = 0.6 / (1.0 + exp(0.4 * (n - 20)));
        c->vx[n] = 0.002 * n;
        c->b[n] = 9.0 * c->phi[n];
        c->U[n + 1] = 0.5 * sqrt((n + 1.0) / N);
        source[n] = 0.05 * sin(n);
      }
      find_lengths(c, &fluid, NULL);
      const double before = sd_vans_momentum(&c->mesh, fluid.rho, c->phi, c->U), dt = 3e-4;
      const int steps = 37;
      const sd_vans_column column = {c->phi, c->vx, c->b, c->length, source};
      const sd_vans_flow flow = {c->U, c->nut, c->stress};
      sd_vans_books in = {c->moved, c->shear, 0, 0, 0, 0, 0};
      assert_int_equal(sd_vans_solve(c->solver, &fluid, &column, steps, dt, &flow, &in), SD_OK);
      double gain = in.driving + in.bottom + in.walls + in.surface;
      double size = fabs(in.driving) + fabs(in.bottom) + fabs(in.walls) + fabs(in.surface);
      for (int n = 0; n < N - 1; n++)
        gain += -c->moved[n] + fluid.rho * source[n] * (c->edge[n + 1] - c->edge[n]) * steps * dt;
      const double after = sd_vans_momentum(&c->mesh, fluid.rho, c->phi, c->U);
      assert_true(fabs(after - before - gain) < 1e-11 * (size + fabs(before)));
      column_free(c);
    }
}

/* Grains move: the water that they displace keeps its momentum and its order, so that no velocity leaves the range
   there was. */
static void displaced_water_keeps_its_momentum(void **state)
{
  (void) state;
  column *c = column_create(61, 0.06, 0.0);
  double old[61], scratch[130];
  for (int n = 0; n < 61; n++) {
    old[n] = 0.6 / (1.0 + exp(0.5 * (n - 25)));
    c->phi[n] = 0.55 / (1.0 + exp(0.3 * (n - 28)));
    c->U[n + 1] = 0.3 + 0.01 * n + 0.1 * sin(n);
  }
  double low = 1e9, high = -1e9;
  for (int n = 1; n <= 61; n++) low = fmin(low, c->U[n]), high = fmax(high, c->U[n]);
  const double before = sd_vans_momentum(&c->mesh, 1000, old, c->U);
  const double through = sd_vans_displace(&c->mesh, &c->mesh, 1000, old, c->phi, c->U, scratch);
  assert_true(fabs(sd_vans_momentum(&c->mesh, 1000, c->phi, c->U) - before - through) <
              1e-13 * before);
  assert_true(through != 0.0);
  for (int n = 1; n <= 60; n++) assert_true(c->U[n] >= low - 1e-14 && c->U[n] <= high + 1e-14);
  /* nothing moved: nothing changes */
  double U[62];
  memcpy(U, c->U, sizeof U);
  assert_true(fabs(sd_vans_displace(&c->mesh, &c->mesh, 1000, c->phi, c->phi, c->U, scratch)) < 1e-13);
  for (int n = 0; n < 62; n++) assert_true(fabs(U[n] - c->U[n]) < 1e-13);
  column_free(c);
}

/* Each step finds the drive that passes the discharge: against walls, drag and a turbulent bottom. In
 * the end the books say the same: what drives is what bottom, walls and grains take. */
static void discharge_is_held_step_by_step(void **state)
{
  (void) state;
  column *c = column_create(61, 0.06, 0.0);
  sd_vans_fluid fluid = {.rho = 1000, .eta = 1e-3, .turbulence = SD_VANS_LI_SAWAMOTO, .kappa = 0.41,
                         .phi_max = 0.61, .width = 0.05, .wall_coef = 1, .held = 1};
  for (int n = 0; n < 61; n++) {
    c->phi[n] = 0.55 / (1.0 + exp(0.7 * (n - 20)));
    c->b[n] = 30 * c->phi[n];
  }
  find_lengths(c, &fluid, NULL);
  const sd_vans_column column = {c->phi, c->vx, c->b, c->length, NULL};
  const sd_vans_flow flow = {c->U, c->nut, c->stress};
  sd_vans_books in = {c->moved, c->shear, 0, 0, 0, 0, 0};
  for (int k = 1; k <= 3; k++) {
    fluid.discharge = 0.01 * k;
    assert_int_equal(sd_vans_solve(c->solver, &fluid, &column, 5000, 1e-3, &flow, &in), SD_OK);
    assert_true(fabs(sd_vans_momentum(&c->mesh, 1.0, c->phi, c->U) / fluid.discharge - 1.0) < 1e-12);
  }
  fluid.discharge = 0.03;
  assert_int_equal(sd_vans_solve(c->solver, &fluid, &column, 1000, 1e-3, &flow, &in), SD_OK);
  double taken = -in.bottom - in.walls;
  for (int n = 0; n < 61; n++) taken += in.moved[n];
  assert_true(in.drive > 0.0 && fabs(taken / in.driving - 1.0) < 1e-10);
  column_free(c);
}

/* Over a bed of any area the ledger of two solves, one of which nobody accounts for, adds up to what the water has
 * won or lost. */
static void ledger_of_a_stream_balances(void **state)
{
  (void) state;
  const double area = 0.37;
  column *c = column_create(41, 0.06, 0.0);
  const sd_vans_fluid fluid = {.rho = 1000, .eta = 1e-3, .gx = 0.4, .turbulence = SD_VANS_LI_SAWAMOTO, .kappa = 0.41,
                               .phi_max = 0.61, .width = 0.05, .wall_coef = 1, .driven = 1, .u_top = 0.3};
  for (int n = 0; n < 41; n++) {
    c->phi[n] = 0.55 / (1.0 + exp(0.7 * (n - 15)));
    c->b[n] = 30 * c->phi[n];
  }
  find_lengths(c, &fluid, NULL);
  const sd_vans_column column = {c->phi, c->vx, c->b, c->length, NULL};
  const sd_vans_flow flow = {c->U, c->nut, c->stress};
  sd_vans_ledger ledger = {.transit = 0.5};
  for (int accounted = 0; accounted < 2; accounted++) {
    sd_vans_books in = {c->moved, c->shear, 0, 0, 0, 0, 0};
    assert_int_equal(sd_vans_solve(c->solver, &fluid, &column, 300, 1e-3, &flow, &in), SD_OK);
    sd_vans_ledger_solve(&ledger, area, 41, &in, accounted);
    assert_true(ledger.others > 0.01 && (ledger.transit > 0.51) == accounted);
  }
  const double got = ledger.driving + ledger.bottom + ledger.walls + ledger.surface;
  const double has = area * sd_vans_momentum(&c->mesh, 1000, c->phi, c->U);
  CHECK_NEAR(has, got - (ledger.transit - 0.5) - ledger.others, 1e-11 * ledger.driving);
  column_free(c);
}

/* A surface between two edges: the water below it has the volume that is asked for, wherever the
 * surface falls, and what is displaced from one surface to another keeps all its momentum. */
static void water_fills_the_mesh_up_to_its_surface(void **state)
{
  (void) state;
  column *c = column_create(61, 0.06, 0.0);
  double edge[62], before[62], old[61], scratch[130];
  for (int n = 0; n < 61; n++) {
    c->phi[n] = 0.6 / (1.0 + exp(0.5 * (n - 25)));
    old[n] = 0.5 / (1.0 + exp(0.3 * (n - 28)));
    c->U[n + 1] = 0.3 + 0.01 * n + 0.1 * sin(n);
  }
  for (double W = 1e-3; W < 0.044; W *= 1.01) {
    const sd_vans_mesh wet = {sd_vans_fill(&c->mesh, c->phi, W, edge), 0.0, 0.0, edge};
    assert_in_range(wet.ncell, 2, 61);
    assert_true(fabs(sd_vans_volume(&wet, c->phi) / W - 1.0) < 1e-14);
    const int top = wet.ncell - 2;
    assert_true(sd_vans_height(&wet, top) < 1.0101e-3 && (top == 0 || sd_vans_height(&wet, top) > 0.0099e-3));
  }
  assert_int_equal(sd_vans_fill(&c->mesh, c->phi, 0.07, edge), 0);
  const double W = 0.03;
  const sd_vans_mesh from = {sd_vans_fill(&c->mesh, old, W, before), 0.0, 0.0, before},
                     to = {sd_vans_fill(&c->mesh, c->phi, W, edge), 0.0, 0.0, edge};
  assert_true(from.ncell != to.ncell);
  const double start = sd_vans_momentum(&from, 1000, old, c->U),
               through = sd_vans_displace(&from, &to, 1000, old, c->phi, c->U, scratch);
  assert_true(fabs(through) < 1e-13 * start);
  assert_true(fabs(sd_vans_momentum(&to, 1000, c->phi, c->U) / start - 1.0) < 1e-13);
  column_free(c);
}

/* Yade adds dt up: the counts measured there. Consistent: the right number, and dt is made to fit. */
static void number_of_steps(void **state)
{
  (void) state;
  static const struct {
    double T, dt;
    int yade, right;
  } cases[] = {{1e-2, 1e-5, 1001, 1000}, {1e-2, 1e-4, 101, 100}, {1, 1e-5, 100001, 100000},
               {1, 0.1, 11, 10},         {1, 1e-3, 1000, 1000},  {1e-2, 1e-3, 10, 10},
               {1e3, 0.2, 5000, 5000}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    double dt = cases[k].dt;
    assert_int_equal(sd_vans_steps(SD_VANS_YADE, cases[k].T, &dt), cases[k].yade);
    assert_int_equal(sd_vans_steps(SD_VANS_CONSISTENT, cases[k].T, &dt), cases[k].right);
  }
  double dt = 0.3;
  assert_int_equal(sd_vans_steps(SD_VANS_CONSISTENT, 1.0, &dt), 4);
  assert_true(dt == 0.25);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(poiseuille),
      cmocka_unit_test(poiseuille_on_an_uneven_mesh),
      cmocka_unit_test(turbulent_layer_converges),
      cmocka_unit_test(momentum_is_balanced),
      cmocka_unit_test(displaced_water_keeps_its_momentum),
      cmocka_unit_test(discharge_is_held_step_by_step),
      cmocka_unit_test(ledger_of_a_stream_balances),
      cmocka_unit_test(water_fills_the_mesh_up_to_its_surface),
      cmocka_unit_test(number_of_steps),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
