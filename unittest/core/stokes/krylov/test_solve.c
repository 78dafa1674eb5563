#include "scene.h"

static const double A = 0.7, ETA = 1.3, U = 0.9;
#define UNIT (6.0 * SD_PI * ETA * A * U)

/* What came of a solve */
typedef struct {
  sd_status status;
  sd_solve_report report;
  double drag; /* of total_drag */
} outcome;

/* Total force along axis d for uniform motion along it, in 6 pi eta a U. */
static outcome total_drag(scene *s, int d, solver *solve, double tolerance, int max_iter)
{
  outcome o = {.drag = 0.0};
  double *slip = scene_uniform_slip(s, d == 0 ? U : 0, d == 1 ? U : 0, d == 2 ? U : 0);
  double *F = scene_solve(s, solve, slip, tolerance, max_iter, &o.status, &o.report);
  for (int i = 0; i < s->n; i++) o.drag += F[3 * i + d] / UNIT;
  free(slip);
  free(F);
  return o;
}

/* The same of a scene that is made for it and nothing else. */
static outcome drag_of(scene s, int d, solver *solve, double tolerance, int max_iter)
{
  const outcome o = total_drag(&s, d, solve, tolerance, max_iter);
  scene_free(&s);
  return o;
}

/* Joung's iteration on the touching pair along its axis is a geometric series: F^k = (1 - (-5/8)^(k+1))/1.625. */
static void substitution_follows_the_geometric_series(void **state)
{
  (void) state;
  for (int k = 1; k <= 20; k++) {
    const outcome o =
        drag_of(scene_lattice(1, 1, 2, 2.0, A, ETA), 2, sd_solve_substitution, 1e-30, k);
    CHECK_NEAR(o.drag / 2.0, (1.0 - pow(-0.625, k + 1)) / 1.625, 1e-14);
    assert_int_equal(o.status, SD_EMAXITER);
    assert_int_equal(o.report.iterations, k);
    /* residual of F^k: |F^(k+1) - F^k| / |D s| */
    CHECK_NEAR(o.report.residual, pow(0.625, k + 1), 1e-13);
    CHECK_NEAR(o.report.growth, 0.625, 1e-9);
  }
}

static void substitution_stops_by_its_residual(void **state)
{
  (void) state;
  const outcome o = drag_of(scene_lattice(1, 1, 2, 2.0, A, ETA), 2, sd_solve_substitution, 1e-6, 100);
  assert_int_equal(o.status, SD_OK);
  /* 0.625^(k+1) <= 1e-6 first at k = 29 */
  assert_int_equal(o.report.iterations, 29);
}

/* Spectral radius 1.0817 (hydrodynamic literature has none for this; dense eigenvalues give 2.081651 - 1). */
static void substitution_diverges_for_three_in_a_row(void **state)
{
  (void) state;
  const outcome o = drag_of(scene_lattice(1, 1, 3, 2.0, A, ETA), 2, sd_solve_substitution, 1e-6, 100);
  assert_int_equal(o.status, SD_EDIVERGED);
  assert_true(o.report.growth > 1.0 && o.report.growth < 1.0817);
  assert_true(o.report.iterations < 30);
}

/* Total drag of chains and cubes; reference: dense LU of the same model. And iterations to 1e-6. */
static void gradients_give_the_model_drag(void **state)
{
  (void) state;
  const struct {
    int nx, nz, axis;
    double drag;
    int at_most;
  } cases[] = {{1, 2, 2, 1.2307692308, 1},     {1, 2, 0, 1.3913043478, 1},
               {1, 3, 2, 1.4864864865, 2},     {1, 10, 2, 2.8644863357, 5},
               {1, 10, 0, 3.9660679076, 5},    {1, 100, 0, 23.5646185172, 14},
               {1, 100, 2, 14.5812717437, 24}, {2, 2, 0, 2.163179, 2},
               {3, 3, 1, 3.487916, 9},         {8, 8, 2, 0.0, 35}};
  for (size_t k = 0; k < sizeof(cases) / sizeof(cases[0]); k++) {
    scene s = scene_lattice(cases[k].nx, cases[k].nx, cases[k].nz, 2.0, A, ETA);
    outcome o = total_drag(&s, cases[k].axis, sd_solve_gradients, 1e-6, 100);
    assert_int_equal(o.status, SD_OK);
    if (o.report.iterations > cases[k].at_most)
      fail_msg("case %zu: %d iterations, at most %d", k, o.report.iterations, cases[k].at_most);
    if (cases[k].drag > 0.0) {
      o = total_drag(&s, cases[k].axis, sd_solve_gradients, 1e-12, 300);
      assert_int_equal(o.status, SD_OK);
      CHECK_NEAR(o.drag / cases[k].drag, 1.0,
                 cases[k].nx > 1 ? 2e-7 : 1e-10); /* digits of the reference */
    }
    scene_free(&s);
  }
}

/* The residual that both solvers report is |D(s - MF)|/|Ds| of the F that they return. Unequal radii, overlaps, random
   velocities. */
static void reported_residual_is_the_definition(void **state)
{
  (void) state;
  uint64_t seed = 3;
  enum { N = 20 };
  solver *solvers[2] = {sd_solve_substitution, sd_solve_gradients};
  for (int k = 0; k < 2; k++) {
    /* substitution converges only for spheres far apart */
    const double side = k == 0 ? 200.0 : 6.0;
    scene s = scene_create(N);
    double slip[3 * N], u[3 * N];
    for (int i = 0; i < N; i++) {
      scene_set(&s, i, uniform(&seed, 0, side), uniform(&seed, 0, side), uniform(&seed, 0, side),
                uniform(&seed, 0.3, 1.5), ETA);
      for (int d = 0; d < 3; d++) slip[3 * i + d] = uniform(&seed, -1, 1);
    }
    sd_status status;
    sd_solve_report report;
    double *F = scene_solve(&s, solvers[k], slip, 1e-5, 200, &status, &report), rr = 0.0, bb = 0.0;
    assert_int_equal(status, SD_OK);
    scene_apply(&s, F, u);
    for (int i = 0; i < 3 * N; i++) {
      const double D = s.drag[i / 3];
      rr += pow(D * (slip[i] - u[i]) - F[i], 2);
      bb += pow(D * slip[i], 2);
    }
    CHECK_NEAR(report.residual, sqrt(rr / bb), 1e-12);
    assert_true(report.residual <= 1e-5 && report.residual > 0.0);
    free(F);
    scene_free(&s);
  }
}

/* Chain of 4, nearest neighbours only, along its axis: eigenvalue 1 - 1.25 cos(pi/5) < 0 (analytic). */
static void gradients_stop_at_negative_curvature(void **state)
{
  (void) state;
  scene s = scene_lattice(1, 1, 4, 2.0, A, ETA);
  s.cutoff = 2.5 * A;
  /* the offending mode alternates along the chain */
  double slip[12] = {0};
  for (int i = 0; i < 4; i++) slip[3 * i + 2] = i % 2 ? -U : U;
  sd_status status;
  sd_solve_report report;
  free(scene_solve(&s, sd_solve_gradients, slip, 1e-6, 100, &status, &report));
  assert_int_equal(status, SD_EINDEFINITE);
  assert_true(report.curvature < 0.0);
  scene_free(&s);
}

/* A cloud with a short cut-off: the answer would be noise, and the solver says so. */
static void gradients_refuse_a_cloud_with_a_cut_off(void **state)
{
  (void) state;
  scene s = scene_lattice(5, 5, 5, 2.0, A, ETA);
  s.cutoff = 6.1 * A;
  assert_int_equal(drag_of(s, 0, sd_solve_gradients, 1e-6, 200).status, SD_EINDEFINITE);
}

/* Two equal spheres at one point: one velocity gives the drag of one sphere, two velocities have no answer. */
static void coincident_spheres(void **state)
{
  (void) state;
  scene s = scene_lattice(1, 1, 2, 0.0, A, ETA);
  sd_status status;
  sd_solve_report report;
  const outcome o = total_drag(&s, 0, sd_solve_gradients, 1e-12, 100);
  CHECK_NEAR(o.drag, 1.0, 1e-12);
  assert_int_equal(o.status, SD_OK);
  double slip[6] = {U, 0, 0, -U, 0, 0};
  free(scene_solve(&s, sd_solve_gradients, slip, 1e-6, 100, &status, &report));
  assert_int_equal(status, SD_ESINGULAR);
  scene_free(&s);
}

/* lambda_min = 3r/16a */
static void nearly_coincident_spheres_carry_the_drag_of_one(void **state)
{
  (void) state;
  for (double r = 0.1; r > 1e-9; r *= 0.1) {
    const outcome o = drag_of(scene_lattice(1, 1, 2, r, A, ETA), 0, sd_solve_gradients, 1e-10, 100);
    assert_int_equal(o.status, SD_OK);
    assert_true(o.drag >= 1.0 - 1e-9 && o.drag <= 1.0 + r);
  }
}

/* A sphere wholly inside another carries nothing, the outer one exactly its Stokes drag. */
static void hidden_sphere_carries_nothing(void **state)
{
  (void) state;
  scene s = scene_create(2);
  scene_set(&s, 0, 0, 0, 0, 1.9, ETA);
  scene_set(&s, 1, 0.3, -0.5, 0.4, 0.7, ETA);
  double *slip = scene_uniform_slip(&s, U, 0, 0);
  sd_status status;
  sd_solve_report report;
  double *F = scene_solve(&s, sd_solve_gradients, slip, 1e-13, 100, &status, &report);
  CHECK_NEAR(F[0] / (6 * SD_PI * ETA * 1.9 * U), 1.0, 1e-12);
  CHECK_NEAR(F[3] / F[0], 0.0, 1e-12);
  free(F);
  free(slip);
  scene_free(&s);
}

static void no_slip_no_force(void **state)
{
  (void) state;
  solver *solvers[2] = {sd_solve_substitution, sd_solve_gradients};
  for (int k = 0; k < 2; k++) {
    scene s = scene_lattice(2, 2, 2, 2.0, A, ETA);
    double *slip = scene_uniform_slip(&s, 0, 0, 0);
    sd_status status;
    sd_solve_report report;
    double *F = scene_solve(&s, solvers[k], slip, 1e-6, 100, &status, &report);
    assert_int_equal(status, SD_OK);
    assert_int_equal(report.iterations, 0);
    for (int i = 0; i < 3 * s.n; i++) CHECK_NEAR(F[i], 0.0, 0.0);
    free(F);
    free(slip);
    scene_free(&s);
  }
}

static void not_a_number_is_reported(void **state)
{
  (void) state;
  solver *solvers[2] = {sd_solve_substitution, sd_solve_gradients};
  for (int k = 0; k < 2; k++) {
    scene s = scene_lattice(1, 1, 2, 3.0, A, ETA);
    double *slip = scene_uniform_slip(&s, U, 0, 0);
    sd_status status;
    sd_solve_report report;
    slip[4] = NAN;
    free(scene_solve(&s, solvers[k], slip, 1e-6, 100, &status, &report));
    assert_int_equal(status, SD_ENOTFINITE);
    slip[4] = 0.0;
    s.x[5] = NAN; /* the slip is sound, the product is not */
    free(scene_solve(&s, solvers[k], slip, 1e-6, 100, &status, &report));
    assert_int_equal(status, SD_ENOTFINITE);
    free(slip);
    scene_free(&s);
  }
}

/* A tolerance below what double precision can give ends as such, it does not use up the iterations. */
static void impossible_tolerance_stagnates(void **state)
{
  (void) state;
  const outcome o =
      drag_of(scene_lattice(1, 1, 30, 0.2, A, ETA), 0, sd_solve_gradients, 1e-25, 100000);
  assert_int_equal(o.status, SD_ESTAGNATED);
  assert_true(o.report.residual < 1e-11 && o.report.iterations < 1000);
}

static void out_of_iterations_says_how_far_it_came(void **state)
{
  (void) state;
  const outcome o = drag_of(scene_lattice(5, 5, 5, 2.0, A, ETA), 0, sd_solve_gradients, 1e-10, 5);
  assert_int_equal(o.status, SD_EMAXITER);
  assert_int_equal(o.report.iterations, 5);
  assert_true(o.report.residual > 1e-10 && o.report.residual < 1.0);
}

/* Smoothing: more iterations never give a larger residual. Plain conjugate gradients would fail this at iteration 10 of
   8^3 spheres. */
static void residual_only_falls(void **state)
{
  (void) state;
  scene s = scene_lattice(8, 8, 8, 2.0, A, ETA);
  double last = 1.0;
  for (int k = 1; k <= 20; k++) {
    const double residual = total_drag(&s, 0, sd_solve_gradients, 1e-12, k).report.residual;
    assert_true(residual < last);
    last = residual;
  }
  scene_free(&s);
}

/* A function of the caller that fails at its k-th call ends the solve there: with its status, without another call of
 * any of them, and with forces that are finite. As many calls as the solve makes are tried, then it converges. */
typedef struct {
  scene *s;
  int calls, fails_at, after;
} failing;

static sd_status counted(failing *f)
{
  f->calls++;
  if (f->calls > f->fails_at) f->after++;
  return f->calls == f->fails_at ? SD_ECALLBACK : SD_OK;
}

static sd_status apply_or_fail(void *ctx, const double *F, double *u)
{
  failing *f = ctx;
  const sd_status status = counted(f);
  return status == SD_OK ? scene_apply(f->s, F, u) : status;
}

static sd_status sum_or_fail(void *ctx, double *values, int count)
{
  (void) values;
  (void) count;
  return counted(ctx);
}

static sd_status precondition_or_fail(void *ctx, const double *r, double *z)
{
  failing *f = ctx;
  for (int j = 0; j < 3 * f->s->n; j++) z[j] = f->s->drag[j / 3] * r[j];
  return counted(f);
}

static void failed_callback_ends_the_solve(void **state)
{
  (void) state;
  const struct {
    solver *solve;
    double spacing;
    sd_precondition *precondition;
    int warm;
  } ways[] = {{sd_solve_substitution, 30.0, NULL, 0},
              {sd_solve_gradients, 2.0, NULL, 0},
              {sd_solve_gradients, 2.0, precondition_or_fail, 0},
              {sd_solve_gradients, 2.0, precondition_or_fail, 1}};
  for (int k = 0; k < 4; k++) {
    int calls = 0;
    for (sd_status status = SD_ECALLBACK; status != SD_OK; calls++) {
      scene s = scene_lattice(2, 3, 2, ways[k].spacing, A, ETA);
      double *slip = scene_uniform_slip(&s, 0, U, 0.3 * U), F[36], work[SD_SOLVE_WORK(12, 3)];
      failing f = {.s = &s, .fails_at = calls + 1};
      const sd_system system = {.n = s.n,
                                .drag = s.drag,
                                .apply = apply_or_fail,
                                .apply_ctx = &f,
                                .world = {.ctx = &f, .sum = sum_or_fail},
                                .precondition = ways[k].precondition,
                                .precondition_ctx = &f,
                                .warm = ways[k].warm};
      sd_solve_report report;
      for (int j = 0; j < 36; j++) F[j] = ways[k].warm ? 0.9 * s.drag[j / 3] * slip[j] : NAN;
      status = ways[k].solve(&system, slip, 1e-6, 100, F, work, &report);
      assert_int_equal(status, f.calls < f.fails_at ? SD_OK : SD_ECALLBACK);
      assert_int_equal(f.after, 0);
      for (int j = 0; j < 36; j++) assert_true(isfinite(F[j]));
      free(slip);
      scene_free(&s);
    }
    assert_true(calls > 8);
  }
}

/* The smallest residual on the line through the first two of conjugate gradients, z0 = D s and z1 = z0 - alpha D M z0:
 * |y|^2 = (|z0|^2 |z1|^2 - (z0.z1)^2) / |z0 - z1|^2. Radii 1:2, or else z0.z1 would be 0. */
static void smoothing_finds_the_smallest_residual(void **state)
{
  (void) state;
  enum { N = 3 * 64 };
  scene s = scene_lattice(4, 4, 4, 2.0, A, ETA);
  uint64_t seed = 8;
  for (int i = 0; i < s.n; i++)
    scene_set(&s, i, s.x[3 * i], s.x[3 * i + 1], s.x[3 * i + 2], uniform(&seed, 0.5, 1.0) * A, ETA);
  double slip[N], F[N], q[N], power = 0.0, norm = 0.0, z00 = 0.0, z01 = 0.0, z11 = 0.0;
  for (int j = 0; j < N; j++) {
    slip[j] = uniform(&seed, -U, U);
    F[j] = s.drag[j / 3] * slip[j];
  }
  scene_apply(&s, F, q);
  for (int j = 0; j < N; j++) {
    q[j] += slip[j];
    power += slip[j] * F[j];
    norm += F[j] * q[j];
  }
  for (int j = 0; j < N; j++) {
    const double z1 = F[j] - power / norm * s.drag[j / 3] * q[j];
    z00 += F[j] * F[j];
    z01 += F[j] * z1;
    z11 += z1 * z1;
  }
  outcome o;
  free(scene_solve(&s, sd_solve_gradients, slip, 1e-12, 1, &o.status, &o.report));
  CHECK_NEAR(o.report.residual, sqrt((z00 * z11 - z01 * z01) / (z00 - 2 * z01 + z11) / z00), 1e-12);
  scene_free(&s);
}

/* Drag 0: the sphere takes no part; the others do not notice it. */
static void sphere_without_drag_takes_no_part(void **state)
{
  (void) state;
  solver *solvers[2] = {sd_solve_substitution, sd_solve_gradients};
  for (int k = 0; k < 2; k++) {
    scene s = scene_lattice(1, 1, 3, 2.0, A, ETA);
    s.a[1] = s.w[1] = s.drag[1] = 0.0;
    double *slip = scene_uniform_slip(&s, 0, 0, U);
    sd_status status;
    sd_solve_report report;
    double *F = scene_solve(&s, solvers[k], slip, 1e-13, 200, &status, &report);
    const double expected =
        1.0 / (1.0 + 1.5 / 4.0 - 1.0 / 64.0); /* two spheres, s = 4, along the axis */
    CHECK_NEAR(F[2] / UNIT, expected, 1e-12);
    CHECK_NEAR(F[8] / UNIT, expected, 1e-12);
    CHECK_NEAR(F[5], 0.0, 0.0);
    free(F);
    free(slip);
    scene_free(&s);
  }
}

/* Forces are reciprocal: for two velocity fields, F1.s2 = F2.s1; and dissipate: F.s > 0. Radii 1:30, two
   viscosities. */
static void resistance_is_symmetric_and_dissipates(void **state)
{
  (void) state;
  enum { N = 25 };
  uint64_t seed = 5;
  scene s = scene_create(N);
  double slip[2][3 * N], *F[2], cross[2] = {0, 0}, power = 0.0;
  for (int i = 0; i < N; i++)
    scene_set(&s, i, uniform(&seed, 0, 5), uniform(&seed, 0, 5), uniform(&seed, 0, 5),
              exp(uniform(&seed, log(0.05), log(1.5))), i % 2 ? 1.3 : 4.1);
  for (int k = 0; k < 2; k++) {
    sd_status status;
    sd_solve_report report;
    for (int i = 0; i < 3 * N; i++) slip[k][i] = uniform(&seed, -1, 1);
    F[k] = scene_solve(&s, sd_solve_gradients, slip[k], 1e-12, 1000, &status, &report);
    assert_int_equal(status, SD_OK);
  }
  for (int i = 0; i < 3 * N; i++) {
    cross[0] += F[0][i] * slip[1][i];
    cross[1] += F[1][i] * slip[0][i];
    power += F[0][i] * slip[0][i];
  }
  CHECK_NEAR(cross[0], cross[1], 1e-9 * power);
  assert_true(power > 0.0);
  free(F[0]);
  free(F[1]);
  scene_free(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(substitution_follows_the_geometric_series),
      cmocka_unit_test(substitution_stops_by_its_residual),
      cmocka_unit_test(substitution_diverges_for_three_in_a_row),
      cmocka_unit_test(gradients_give_the_model_drag),
      cmocka_unit_test(reported_residual_is_the_definition),
      cmocka_unit_test(gradients_stop_at_negative_curvature),
      cmocka_unit_test(gradients_refuse_a_cloud_with_a_cut_off),
      cmocka_unit_test(coincident_spheres),
      cmocka_unit_test(nearly_coincident_spheres_carry_the_drag_of_one),
      cmocka_unit_test(hidden_sphere_carries_nothing),
      cmocka_unit_test(no_slip_no_force),
      cmocka_unit_test(not_a_number_is_reported),
      cmocka_unit_test(impossible_tolerance_stagnates),
      cmocka_unit_test(out_of_iterations_says_how_far_it_came),
      cmocka_unit_test(residual_only_falls),
      cmocka_unit_test(smoothing_finds_the_smallest_residual),
      cmocka_unit_test(failed_callback_ends_the_solve),
      cmocka_unit_test(sphere_without_drag_takes_no_part),
      cmocka_unit_test(resistance_is_symmetric_and_dissipates),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
