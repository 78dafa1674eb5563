/* Suspensions in periodic boxes as shells of points: arrays with known drag and viscosity,
 * random spheres, where the matrix is positive definite. */
#include "blobs.h"

#include "table.h"

/* of the engine */
static const double tolerance = 1e-5;

/* sum of S:E over -2 E:E V: what the spheres add to the viscosity, in a strain G (symmetric) */
static double increment(const blobs *s, const double *S, const double G[9])
{
  static const double twice[6] = {1, 1, 1, 2, 2, 2};
  static const int at[6] = {0, 4, 8, 1, 2, 5};
  double SE = 0.0, EE = 0.0;
  for (int c = 0; c < 6; c++) {
    EE += twice[c] * G[at[c]] * G[at[c]];
    for (int i = 0; i < s->n; i++) SE += twice[c] * S[6 * i + c] * G[at[c]];
  }
  return -SE / (2.0 * EE * pow(s->side, 3));
}

/* The five strains of an orthonormal basis: axial ones first */
static void strain(int k, double G[9])
{
  const double h = sqrt(0.5), t = sqrt(1.0 / 6.0);
  const double axial[2][3] = {{h, -h, 0}, {t, t, -2.0 * t}};
  static const int p[3] = {1, 2, 5}, q[3] = {3, 6, 7};
  memset(G, 0, 9 * sizeof *G);
  for (int d = 0; d < 3 && k < 2; d++) G[4 * d] = axial[k][d];
  if (k >= 2) G[p[k - 2]] = G[q[k - 2]] = h;
}

/* Shells of all spheres turned at random */
static void turn_all(blobs *s, uint64_t *seed)
{
  double R[9];
  random_rotation(seed, R);
  for (int i = 0; i < s->n; i++) memcpy(s->turn + 9 * i, R, sizeof R);
}

enum { ORIENTATIONS = 20 };

/* Speed of a simple cubic array against Zick & Homsy (1982), mean of many orientations: 12
 * points differ from it by as much again among them, as in the orientation of the laboratory. */
static void simple_cubic_speed(void **state)
{
  (void) state;
  const double phi[4] = {0.125, 0.216, 0.343, 0.45}, drag[4] = {4.292, 7.442, 15.4, 28.1};
  const double most[2][4] = {{0.003, 0.014, 0.10, 0.24}, {0.003, 0.012, 0.05, 0.10}};
  const double x[3] = {0.1, 0.2, 0.3};
  uint64_t seed = 3;
  for (int points = 12; points <= 42; points += 30)
    for (int k = 0; k < 4; k++) {
      const int orientations = points == 12 ? ORIENTATIONS : 6;
      double speed = 0.0;
      for (int o = 0; o < orientations; o++) {
        blobs *s = blobs_create(points, 1, 1, x, NULL);
        turn_all(s, &seed);
        blobs_periodic(s, cbrt(4.0 / 3.0 * SD_PI / phi[k]), tolerance);
        blobs_factor(s);
        blobs_resistance(s);
        assert_int_equal(sd_cholesky(6, s->R), SD_OK);
        for (int d = 0; d < 3; d++) {
          double F[6] = {0.0}, V[6];
          F[d] = 6.0 * SD_PI;
          blobs_move(s, F, NULL, V, NULL);
          speed += V[d] / (3.0 * orientations);
        }
        blobs_free(s);
      }
      print_message("%d points, phi %g: speed %+.2f %%\n", points, phi[k],
                    100.0 * (speed * drag[k] - 1.0));
      assert_true(fabs(speed * drag[k] - 1.0) < most[points == 42][k]);
    }
}

/* What a simple cubic array adds to the viscosity in axial strain and in shear: 0.3600, 0.2414
 * at a volume fraction of 0.1, 1.0656, 0.4972 at 0.2 (multipoles); the model has 0.3591, 0.2412
 * and 1.0475, 0.4950, shells of 12 thin points 0.323, 0.226. */
static void simple_cubic_viscosity(void **state)
{
  (void) state;
  const double known[2][2] = {{0.3591, 0.2412}, {1.0475, 0.4950}}, x[3] = {0.1, 0.2, 0.3};
  uint64_t seed = 3;
  for (int k = 0; k < 2; k++) {
    double G[9], V[6], S[6], added[2] = {0.0, 0.0};
    for (int o = 0; o < ORIENTATIONS; o++) {
      blobs *s = blobs_create(12, 1, 1, x, NULL);
      turn_all(s, &seed);
      blobs_periodic(s, cbrt(4.0 / 3.0 * SD_PI / (0.1 * (k + 1))), tolerance);
      blobs_factor(s);
      blobs_resistance(s);
      assert_int_equal(sd_cholesky(6, s->R), SD_OK);
      for (int e = 0; e < 5; e++) {
        strain(e, G);
        blobs_move(s, NULL, G, V, S);
        added[e >= 2] += increment(s, S, G) / ((e < 2 ? 2.0 : 3.0) * ORIENTATIONS);
      }
      blobs_free(s);
    }
    print_message("adds %.4f %.4f\n", added[0], added[1]);
    for (int e = 0; e < 2; e++) CHECK_NEAR(added[e] / known[k][e], 1.0, 5e-3);
  }
}

/* High-frequency viscosity, mean velocity under equal forces, mean self mobility and that of
 * rotation; M is factored */
static void properties(blobs *s, double range, double of[4])
{
  const int n = s->n;
  double *V = malloc(sizeof(double) * 6 * (size_t) n), *S = malloc(sizeof(double) * 6 * (size_t) n),
         *F = calloc(6 * (size_t) n, sizeof(double));
  memset(of, 0, 4 * sizeof *of);
  of[0] = 1.0;
  for (int e = 0; e < 5; e++) {
    double G[9];
    strain(e, G);
    if (e == 0 || range > 0.0) {
      free(s->forces), free(s->R);
      blobs_resistance(s);
      if (range > 0.0) blobs_add_films(s, range, G);
      assert_int_equal(sd_cholesky(s->size, s->R), SD_OK);
    }
    blobs_move(s, NULL, G, V, S);
    of[0] += increment(s, S, G) / 5.0;
  }
  if (range > 0.0) sd_lubrication_free(&s->L); /* R has it; the fluid rests from here on */
  for (int d = 0; d < 3; d++) {
    for (int i = 0; i < n; i++) F[6 * i + d] = 6.0 * SD_PI;
    blobs_move(s, F, NULL, V, NULL);
    for (int i = 0; i < n; i++) F[6 * i + d] = 0.0, of[1] += V[6 * i + d] / (3.0 * n);
  }
  assert_int_equal(sd_cholesky_inverse(s->size, s->R), SD_OK);
  for (int j = 0; j < s->size; j++)
    of[j % 6 < 3 ? 2 : 3] +=
        (j % 6 < 3 ? 6.0 : 8.0) * SD_PI * s->R[(size_t) j * (size_t) (s->size + 1)] / (3.0 * n);
  free(V), free(S), free(F);
}

static int positions_of(const char *phi, double *x, double *side)
{
  int n = 0;
  table t = table_open("multiblob/dense_positions.csv");
  while (table_next(&t)) {
    if (strcmp(t.column[1], phi) || (int) table_number(&t, 2) != 1) continue;
    *side = table_number(&t, 3);
    for (int d = 0; d < 3; d++) x[3 * n + d] = table_number(&t, 5 + d);
    n++;
  }
  assert_true(n == 32);
  return n;
}

/* Random hard spheres, the same model in another code: without films 5e-4, with films, whose
 * means are of other orientations, 3e-3. */
static void dense_boxes(void **state)
{
  (void) state;
  static const char *const phi[] = {"0.45"};
  for (int k = 0; k < 1; k++) {
    double x[3 * BLOBS_MOST], side = 0.0, of[2][4];
    const int n = positions_of(phi[k], x, &side);
    blobs *s = blobs_create(12, 1, n, x, NULL);
    blobs_periodic(s, side, tolerance);
    blobs_factor(s);
    properties(s, 0.0, of[0]);
    properties(s, 1.0, of[1]);
    blobs_free(s);
    int rows = 0;
    table t = table_open("multiblob/dense_multiblob.csv");
    while (table_next(&t)) {
      if (strcmp(t.column[1], phi[k]) || strcmp(t.column[3], "12 with one-body")) continue;
      const int films = strcmp(t.column[4], "none") != 0;
      rows++;
      print_message("phi %s, %s films:", phi[k], films ? "with" : "no");
      for (int e = 0; e < 4; e++)
        print_message(" %.5f (%.5f)", of[films][e], table_number(&t, 5 + e));
      print_message("\n");
      for (int e = 0; e < 4; e++)
        CHECK_NEAR(of[films][e] / table_number(&t, 5 + e), 1.0, films ? 3e-3 : 5e-4);
    }
    assert_int_equal(rows, 2);
  }
}

/* Radii 1 and 1/2: velocities and moments of each sphere, weight, unlike forces, strain */
static void two_radii(void **state)
{
  (void) state;
  enum { MOST = 40 };
  const double h = sqrt(0.5), G[9] = {0, h, 0, h, 0, 0, 0, 0, 0};
  static const int at[6] = {0, 3, 5, 1, 2, 4}; /* xx yy zz xy xz yz among xx xy xz yy yz zz */
  double x[3 * MOST], a[MOST], F[6 * MOST], V[6 * MOST], S[6 * MOST], side = 0.0;
  blobs *s = NULL;
  table t = table_open("multiblob/bidisperse.csv");
  assert_true(table_next(&t));
  for (int load = 0; load < 3; load++) {
    double known[12 * MOST];
    const int flows = t.column[2][0] == 'E';
    memset(F, 0, sizeof F);
    for (int i = 0; i < MOST; i++) {
      side = table_number(&t, 1);
      a[i] = table_number(&t, 4);
      for (int d = 0; d < 3; d++) {
        x[3 * i + d] = table_number(&t, 5 + d);
        F[6 * i + d] = table_number(&t, 8 + d);
      }
      for (int e = 0; e < 6; e++) known[12 * i + e] = table_number(&t, 11 + e);
      for (int e = 0; e < 6; e++) known[12 * i + 6 + e] = table_number(&t, 17 + at[e]);
      assert_true(table_next(&t) == (load < 2 || i < MOST - 1));
    }
    if (!s) {
      s = blobs_create(12, 1, MOST, x, a);
      blobs_periodic(s, side, tolerance);
      blobs_factor(s);
    }
    free(s->forces), free(s->R);
    blobs_resistance(s);
    blobs_add_films(s, 1.0, flows ? G : NULL);
    assert_int_equal(sd_cholesky(s->size, s->R), SD_OK);
    blobs_move(s, F, flows ? G : NULL, V, S);
    double off[2] = {0.0}, all[2] = {0.0};
    for (int i = 0; i < MOST; i++)
      for (int e = 0; e < 6; e++) {
        const double scale = e < 3 ? 1.0 : a[i];
        off[0] += pow(scale * (V[6 * i + e] - known[12 * i + e]), 2);
        all[0] += pow(scale * known[12 * i + e], 2);
        off[1] += pow(S[6 * i + e] - known[12 * i + 6 + e], 2);
        all[1] += pow(known[12 * i + 6 + e], 2);
      }
    print_message("two radii, load %d: velocities %.2g, moments %.2g of the norm\n", load,
                  sqrt(off[0] / all[0]), sqrt(off[1] / all[1]));
    for (int k = 0; k < 2; k++) assert_true(sqrt(off[k] / all[k]) < 3e-3);
  }
  blobs_free(s);
}

/* M' of the points with the addition has no negative eigenvalue: Cholesky's factor exists. 42 points
 * in a crystal at 0.7 have one if they stand as in the laboratory; shells at random have none. */
static void positive_in_crystals_and_groups(void **state)
{
  (void) state;
  const double fcc[12] = {0, 0, 0, 0.5, 0.5, 0, 0.5, 0, 0.5, 0, 0.5, 0.5};
  for (int points = 12; points <= 42; points += 30)
    for (int loose = 0; loose < 2; loose++) {
      const double phi = loose ? 0.66 : 0.7;
      uint64_t seed = 4;
      double x[12];
      const double side = cbrt(4.0 * 4.0 / 3.0 * SD_PI / phi);
      for (int e = 0; e < 12; e++) x[e] = side * fcc[e];
      blobs *s = blobs_create(points, 1, 4, x, NULL);
      for (int i = 0; i < 4 && points == 42 && !loose; i++) random_rotation(&seed, s->turn + 9 * i);
      blobs_periodic(s, side, tolerance);
      blobs_factor(s);
      blobs_free(s);
    }
  /* pressed together by 20 % of a radius: an octahedron, a cube of 27, and 26 small ones on one
   * of three times their radius */
  double x[3 * 27], a[27];
  const double octahedron[18] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
  for (int e = 0; e < 18; e++) x[e] = octahedron[e] * 1.8 * sqrt(0.5);
  blobs *s = blobs_create(12, 1, 6, x, NULL);
  blobs_open(s);
  blobs_factor(s);
  blobs_free(s);
  for (int small = 0; small < 2; small++) {
    for (int i = 0; i < 27; i++) {
      const double c[3] = {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1}, length = sqrt(sd_dot(c, c));
      a[i] = small && i != 13 ? 1.0 / 3.0 : 1.0;
      for (int d = 0; d < 3; d++)
        x[3 * i + d] = c[d] * (!small ? 1.8 : i != 13 ? 1.2 / length : 0.0);
    }
    s = blobs_create(12, 1, 27, x, a);
    blobs_open(s);
    blobs_factor(s);
    blobs_free(s);
  }
}

/* Mean velocities [3 n] of the points of each sphere, whose forces [3 n] are spread over them, by a sum to this
 * tolerance of points */
static void mean_velocities(const blobs *s, double side, double of_points, const double *F, double *U)
{
  const sd_ewald_box box = {.periodic = 1, .edge = {side, side, side}};
  const int points = s->m.n, own = 3 * points;
  const sd_ewald split = periodic_choose(&box, s->b, points * s->n, 3, of_points);
  double *f = malloc(sizeof(double) * (size_t) s->N), *u = malloc(sizeof(double) * (size_t) s->N);
  periodic p;
  periodic_place(&p, s->at, s->b, NULL, points * s->n, 3, &split);
  for (int k = 0; k < s->N; k++) f[k] = F[3 * (k / own) + k % 3] / points;
  periodic_apply(&p, f, u);
  memset(U, 0, sizeof(double) * 3 * (size_t) s->n);
  for (int k = 0; k < s->N; k++) U[3 * (k / own) + k % 3] += u[k] / points;
  periodic_free(&p);
  free(f), free(u);
}

/* Velocities of spheres keep the tolerance where the sum over their points is asked for sd_multiblob_looser times as
 * much. The errors of points average out, so that most of it is left. */
static void spheres_keep_the_tolerance(void **state)
{
  (void) state;
  double x[3 * BLOBS_MOST], F[3 * BLOBS_MOST], U[3 * BLOBS_MOST], exact[3 * BLOBS_MOST], side = 0.0;
  const int n = positions_of("0.45", x, &side);
  uint64_t seed = 5;
  for (int points = 12; points <= 42; points += 30) {
    blobs *s = blobs_create(points, 1, n, x, NULL);
    blobs_expand(s);
    for (int k = 0; k < 3 * n; k++) F[k] = uniform(&seed, -1, 1);
    mean_velocities(s, side, 1e-9, F, exact);
    for (double asked = 1e-2; asked > 1e-7; asked *= 0.2) {
      double off = 0.0, all = 0.0;
      mean_velocities(s, side, asked * sd_multiblob_looser(&s->m), F, U);
      for (int k = 0; k < 3 * n; k++) off += pow(U[k] - exact[k], 2), all += pow(F[k] / (6.0 * SD_PI), 2);
      print_message("%d points, asked for %.1e: %.2f of it\n", points, asked, sqrt(off / all) / asked);
      assert_true(sqrt(off / all) < 0.3 * asked);
    }
    blobs_free(s);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(simple_cubic_speed),
      cmocka_unit_test(simple_cubic_viscosity),
      cmocka_unit_test(dense_boxes),
      cmocka_unit_test(two_radii),
      cmocka_unit_test(positive_in_crystals_and_groups),
      cmocka_unit_test(spheres_keep_the_tolerance),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
