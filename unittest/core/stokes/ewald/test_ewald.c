/* The engine ewald against dense Ewald sums (data/ewald), and what every sum over periodic images must have. */
#include "periodic.h"

#include "table.h"

#include "sd_solve.h"

#include <string.h>

enum { MOST = 64 };

typedef struct {
  int n, width;
  sd_ewald_box box;
  double x[3 * MOST], a[MOST], F[6 * MOST], U[6 * MOST], v[6 * MOST], R[6 * MOST], S[6 * MOST];
} reference;

static const char *const names[] = {"p01", "p02", "p04", "p05", "p07", "p10", "p12", "p14"};
enum { SCENES = sizeof(names) / sizeof(names[0]) };

static reference reference_scene(const char *name)
{
  reference s = {0};
  char file[64];
  table t = table_open("ewald/scenes.csv");
  while (table_next(&t)) {
    if (strcmp(t.column[0], name)) continue;
    s.width = strcmp(t.column[2], "yes") ? 3 : 6;
    s.box.periodic = 1;
    for (int d = 0; d < 3; d++) {
      s.box.edge[d] = table_number(&t, 4 + d);
      s.box.tilt[d] = table_number(&t, 7 + d);
    }
  }
  assert_true(s.width > 0);
  snprintf(file, sizeof(file), "ewald/%s.csv", name);
  t = table_open(file);
  while (table_next(&t)) {
    for (int d = 0; d < 3; d++) s.x[3 * s.n + d] = table_number(&t, 1 + d);
    s.a[s.n] = table_number(&t, 4);
    double *const rows[] = {s.F, s.U, s.v, s.R, s.S};
    for (int r = 0; r < 5; r++)
      for (int d = 0; d < s.width; d++) rows[r][s.width * s.n + d] = table_number(&t, 5 + 6 * r + d);
    s.n++;
  }
  return s;
}

/* rms over the spheres of rows from ... from + 2 of u less those of v (NULL: 0), each times unit a^power */
static double rms(const reference *s, const double *u, const double *v, int from, int power)
{
  double sum = 0.0;
  for (int i = 0; i < s->n; i++)
    for (int d = from; d < from + 3; d++) {
      const double difference = (u[s->width * i + d] - (v ? v[s->width * i + d] : 0.0)) * pow(s->a[i], power);
      sum += difference * difference;
    }
  return sqrt(sum / s->n);
}

/* Errors of U relative to F/(6 pi a), of W relative to T/(8 pi a^3), as the tolerance is meant. */
static double error_of(const reference *s, const double *u)
{
  double worst = 6.0 * SD_PI * rms(s, u, s->U, 0, 0) / rms(s, s->F, NULL, 0, -1);
  if (s->width == 6) worst = fmax(worst, 8.0 * SD_PI * rms(s, u, s->U, 3, 0) / rms(s, s->F, NULL, 3, -3));
  return worst;
}

static void velocities_are_those_of_dense_sums(void **state)
{
  (void) state;
  for (int k = 0; k < SCENES; k++) {
    const reference s = reference_scene(names[k]);
    for (int digits = 3; digits <= 9; digits += 3) {
      const double tolerance = pow(10.0, -digits);
      const sd_ewald how = periodic_choose(&s.box, s.a, s.n, s.width, tolerance);
      periodic p;
      double u[6 * MOST];
      periodic_place(&p, s.x, s.a, NULL, s.n, s.width, &how);
      periodic_apply(&p, s.F, u);
      const double error = error_of(&s, u);
      assert_true(error < tolerance);
      periodic_free(&p);
    }
  }
}

/* The drag of given velocities, R, and that of all moving together, S; forces that add up coherently need the mean of
 * what lies beyond the range. */
static void forces_of_given_velocities_are_those_of_dense_sums(void **state)
{
  (void) state;
  for (int k = 0; k < SCENES; k++) {
    const reference s = reference_scene(names[k]);
    for (int digits = 3; digits <= 9; digits += 3) {
      const double tolerance = pow(10.0, -digits);
      const sd_ewald how = periodic_choose(&s.box, s.a, s.n, s.width, tolerance);
      periodic p;
      double drag[MOST], spin[MOST], slip[6 * MOST], F[6 * MOST], *work = malloc(sizeof(double) *
                                                                                 SD_SOLVE_WORK(MOST, 6));
      periodic_place(&p, s.x, s.a, NULL, s.n, s.width, &how);
      for (int i = 0; i < s.n; i++) {
        drag[i] = 6.0 * SD_PI * s.a[i];
        spin[i] = 8.0 * SD_PI * pow(s.a[i], 3);
      }
      const sd_system A = {.n = s.n, .drag = drag, .spin = s.width == 6 ? spin : NULL, .apply = sd_mobility_apply,
                           .apply_ctx = &p.omega};
      for (int uniform_flow = 0; uniform_flow < 2; uniform_flow++) {
        const double all[6] = {0.48, -0.6, 0.64, 0, 0, 0};
        sd_solve_report report;
        for (int i = 0; i < s.width * s.n; i++) slip[i] = uniform_flow ? all[i % s.width] : s.v[i];
        assert_int_equal(sd_solve_gradients(&A, slip, 0.01 * tolerance, 500, F, work, &report), SD_OK);
        for (int i = 0; i < s.width * s.n; i++) F[i] = -F[i];
        const double *expected = uniform_flow ? s.S : s.R;
        assert_true(rms(&s, F, expected, 0, 0) < 10.0 * tolerance * rms(&s, expected, NULL, 0, 0));
        if (s.width == 6) /* torques may be small beside what forces at a distance a would make */
          assert_true(rms(&s, F, expected, 3, 0) <
                      10.0 * tolerance * (rms(&s, expected, NULL, 3, 0) + rms(&s, expected, NULL, 0, 1)));
      }
      free(work);
      periodic_free(&p);
    }
  }
}

/* u = M F with a splitting; largest difference from expected over the largest of these */
static double difference(const reference *s, const double *x, const sd_ewald *how, const double *expected)
{
  periodic p;
  double u[6 * MOST], off = 0.0, scale = 0.0;
  periodic_place(&p, x, s->a, NULL, s->n, s->width, how);
  periodic_apply(&p, s->F, u);
  periodic_free(&p);
  for (int i = 0; i < s->width * s->n; i++) {
    off = fmax(off, fabs(u[i] - expected[i]));
    scale = fmax(scale, fabs(expected[i]));
  }
  return off / scale;
}

static const char *const varied[] = {"p02", "p05", "p07", "p12", "p14"};
enum { VARIED = sizeof(varied) / sizeof(varied[0]) };

/* The rule for a tighter tolerance has another xi, range, radius a_ref, window and grid: nothing of these is in the
   answer. */
static void another_splitting_has_the_same_answer(void **state)
{
  (void) state;
  for (int k = 0; k < VARIED; k++) {
    const reference s = reference_scene(varied[k]);
    const sd_ewald how = periodic_choose(&s.box, s.a, s.n, s.width, 1e-13);
    sd_ewald other = how; /* wave part over a finer grid, near part over a shorter range */
    other.xi *= 1.15, other.band *= 1.15;
    other.range /= 1.15;
    if (s.a[0] != s.a[1]) other.a_ref *= 0.7; /* of equal ones it would be the windows' derivatives that limit */
    for (int d = 0; d < 3; d++) other.grid[d] = (int) (other.grid[d] * 0.75) * 2;
    assert_true(difference(&s, s.x, &how, s.U) < 1e-12);
    assert_true(difference(&s, s.x, &other, s.U) < 1e-12);
  }
}

/* By a fraction of the grid's spacing, and out of the box on all sides: also spheres outside of the box have their
   images. */
static void a_translation_changes_nothing(void **state)
{
  (void) state;
  uint64_t seed = 3;
  for (int k = 0; k < VARIED; k++) {
    const reference s = reference_scene(varied[k]);
    const sd_ewald how = periodic_choose(&s.box, s.a, s.n, s.width, 1e-13);
    for (int turn = 0; turn < 3; turn++) {
      double x[3 * MOST], edge[3][3], shift[3];
      periodic_edges(&s.box, edge);
      for (int d = 0; d < 3; d++) shift[d] = uniform(&seed, -1.0, 1.0) * s.box.edge[d];
      for (int i = 0; i < s.n; i++) {
        const int image = i % 4 - 1; /* some spheres are given by another of their images */
        for (int d = 0; d < 3; d++)
          x[3 * i + d] = s.x[3 * i + d] + shift[d] + (turn == 2 && image < 2 ? image * edge[2][d] : 0.0);
      }
      assert_true(difference(&s, x, &how, s.U) < 1e-12);
    }
  }
}

/* Other edges span the same lattice: what LAMMPS does when a tilt has become too large. */
static void a_flip_of_the_box_changes_nothing(void **state)
{
  (void) state;
  reference s = reference_scene("p14");
  const double lx = s.box.edge[0], ly = s.box.edge[1], xy = s.box.tilt[0];
  for (int flip = 0; flip < 3; flip++) {
    sd_ewald_box box = s.box;
    if (flip == 0) box.tilt[0] -= lx;
    if (flip == 1) box.tilt[1] += lx;
    if (flip == 2) {
      box.tilt[2] -= ly;
      box.tilt[1] -= xy;
    }
    const sd_ewald how = periodic_choose(&box, s.a, s.n, s.width, 1e-13);
    assert_true(difference(&s, s.x, &how, s.U) < 1e-12);
  }
}

/* F.M G = G.M F, at any tolerance, to the rounding of doubles and of floats: spreading and interpolation are each
 * other's transpose. F.M F > 0. */
static void the_matrix_is_symmetric_at_any_tolerance(void **state)
{
  (void) state;
  uint64_t seed = 8;
  for (int k = 0; k < SCENES; k++) {
    const reference s = reference_scene(names[k]);
    for (int digits = 2; digits <= 6; digits++) {
      sd_ewald how = periodic_choose(&s.box, s.a, s.n, s.width, pow(10.0, -digits));
      if (digits % 2 == 0) how.single = 0;
      periodic p;
      double F[6 * MOST], G[6 * MOST], u[6 * MOST], v[6 * MOST], FMG = 0.0, GMF = 0.0, scale = 0.0, FMF = 0.0;
      for (int i = 0; i < s.width * s.n; i++) F[i] = uniform(&seed, -1, 1), G[i] = uniform(&seed, -1, 1);
      periodic_place(&p, s.x, s.a, NULL, s.n, s.width, &how);
      periodic_apply(&p, F, u);
      periodic_apply(&p, G, v);
      for (int i = 0; i < s.width * s.n; i++) {
        FMG += F[i] * v[i];
        GMF += G[i] * u[i];
        FMF += F[i] * u[i];
        scale += fabs(F[i] * v[i]);
      }
      CHECK_NEAR(FMG, GMF, how.single ? 1e-6 * scale : 1e-14 * scale * s.n);
      assert_true(FMF > 0.0);
      periodic_free(&p);
    }
  }
}

/* Velocities from forces are as 1/length, spins as its square, whether that is measured in light years or in nuclei. */
static void any_unit_of_length_has_the_same_answer(void **state)
{
  (void) state;
  const double units[] = {1e-25, 1e-20, 1e-9, 1e9, 1e17, 1e25};
  for (int k = 0; k < SCENES; k++) {
    for (int j = 0; j < 6; j++) {
      reference s = reference_scene(names[k]);
      for (int d = 0; d < 3; d++) s.box.edge[d] *= units[j], s.box.tilt[d] *= units[j];
      for (int i = 0; i < 3 * s.n; i++) s.x[i] *= units[j];
      for (int i = 0; i < s.n; i++) s.a[i] *= units[j];
      for (int i = 0; i < s.width * s.n; i++) {
        const int turns = i % s.width > 2;
        s.F[i] *= turns ? units[j] : 1.0;
        s.U[i] /= turns ? units[j] * units[j] : units[j];
      }
      const sd_ewald how = periodic_choose(&s.box, s.a, s.n, s.width, 1e-3);
      periodic p;
      double u[6 * MOST];
      periodic_place(&p, s.x, s.a, NULL, s.n, s.width, &how);
      periodic_apply(&p, s.F, u);
      assert_true(error_of(&s, u) < 1e-3);
      periodic_free(&p);
    }
  }
}

/* Cubic arrays: settling velocity, drag, and the spin mobility, which is exactly (1 - phi)/(8 pi a^3) until the spheres
 * touch. The engine's self is what it does to a sphere beyond its own 1/(6 pi a); for one sphere a cell that is all. */
static void cubic_arrays_settle_as_they_should(void **state)
{
  (void) state;
  const double places[3][12] = {{0}, {0, 0, 0, .5, .5, .5}, {0, 0, 0, .5, .5, 0, .5, 0, .5, 0, .5, .5}};
  const char *const lattice[] = {"SC", "BCC", "FCC"};
  const int many[] = {1, 2, 4};
  table t = table_open("ewald/lattice_drag.csv");
  while (table_next(&t)) {
    int k = 0;
    while (strcmp(lattice[k], t.column[0])) k++;
    const int n = many[k];
    const double phi = table_number(&t, 1), radius = cbrt(3.0 * phi / (4.0 * SD_PI * n));
    const double touching[] = {SD_PI / 6.0, SD_PI * sqrt(3.0) / 8.0, SD_PI * sqrt(2.0) / 6.0};
    const sd_ewald_box box = {.periodic = 1, .edge = {1, 1, 1}};
    double a[4], F[24] = {0.0}, u[24];
    for (int i = 0; i < n; i++) {
      a[i] = radius;
      F[6 * i] = 6.0 * SD_PI * radius;
      F[6 * i + 4] = 8.0 * SD_PI * pow(radius, 3);
    }
    const sd_ewald how = periodic_choose(&box, a, n, 6, 1e-12);
    periodic p;
    periodic_place(&p, places[k], a, NULL, n, 6, &how);
    periodic_apply(&p, F, u);
    const double K = table_number(&t, 3);
    CHECK_NEAR(1.0 / u[0], K, 1e-9 * K);
    if (phi < touching[k]) CHECK_NEAR(u[4], 1.0 - phi, 1e-9);
    periodic_free(&p);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(velocities_are_those_of_dense_sums),
      cmocka_unit_test(forces_of_given_velocities_are_those_of_dense_sums),
      cmocka_unit_test(another_splitting_has_the_same_answer),
      cmocka_unit_test(a_translation_changes_nothing),
      cmocka_unit_test(a_flip_of_the_box_changes_nothing),
      cmocka_unit_test(the_matrix_is_symmetric_at_any_tolerance),
      cmocka_unit_test(any_unit_of_length_has_the_same_answer),
      cmocka_unit_test(cubic_arrays_settle_as_they_should),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
