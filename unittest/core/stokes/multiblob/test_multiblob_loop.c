/* Suspensions of spheres and of rigid clumps as shells of points through the loop of
 * sd_bodies.h. */
#include "blob_flock.h"

#include "sd_bodies_alone.h"
#include "table.h"

static double off_by(const double *v, const double *w, int n)
{
  double off = 0.0, all = 0.0;
  for (int k = 0; k < n; k++) {
    off += pow(v[k] - w[k], 2);
    all += w[k] * w[k];
  }
  return sqrt(off / all);
}

/* A lone sphere, of any radius, falls and turns as Stokes says, after one product. */
static void lone_sphere(void **state)
{
  (void) state;
  const double x[3] = {1, 2, 3}, a = 0.7, F[6] = {0.3, -1, 2, 0.2, 0.4, -0.5};
  for (int points = 12; points <= 42; points += 30) {
    blob_flock *f = free_spheres(points, 1, x, &a);
    const sd_bodies A = place(f, 0.0, 0.0);
    assert_int_equal(move(f, &A, F, 0, 1e-10), SD_OK);
    for (int e = 0; e < 6; e++)
      CHECK_NEAR(f->V[e], F[e] / (e < 3 ? 6.0 * SD_PI * a : 8.0 * SD_PI * a * a * a), 1e-10);
    assert_true(f->report.products <= 2);
    blob_flock_free(f);
  }
}

/* Rows are gone over a few points at a time (sd_bodies_next), and shells of 42 points are cut by that. */
static void product_is_dense_where_parts_cut_shells(void **state)
{
  (void) state;
  enum { SPHERES = 5, ROWS = 3 * 42 * SPHERES };
  double x[3 * SPHERES], a[SPHERES], l[ROWS], w[ROWS], expected[ROWS] = {0.0};
  double bodies[12 * SPHERES], on_spheres[6 * SPHERES];
  const double still[6 * SPHERES] = {0.0};
  uint64_t seed = 5;
  for (int i = 0; i < SPHERES; i++) {
    a[i] = 0.6 + 0.1 * i;
    for (int d = 0; d < 3; d++) x[3 * i + d] = 2.3 * i * (d == i % 3) - 0.4 * d;
  }
  for (int j = 0; j < ROWS; j++) l[j] = uniform(&seed, -1, 1);
  blob_flock *f = free_spheres(42, SPHERES, x, a);
  blobs_open(f->s);
  const sd_bodies A = place(f, 0.0, 0.0);
  assert_int_not_equal(SD_BODIES_PART % 42, 0);
  assert_true(SD_BODIES_PART < A.points.n);
  for (int j = 0; j < ROWS; j++)
    for (int k = 0; k < ROWS; k++) expected[j] += f->s->M[ROWS * j + k] * l[k];
  assert_int_equal(sd_bodies_product(&A, 0, l, still, bodies, on_spheres, w), SD_OK);
  assert_true(off_by(w, expected, ROWS) < 1e-12);
  blob_flock_free(f);
}

static int positions_of(double *x, double *side)
{
  int n = 0;
  table t = table_open("multiblob/dense_positions.csv");
  while (table_next(&t)) {
    *side = table_number(&t, 3);
    for (int d = 0; d < 3; d++) x[3 * n + d] = table_number(&t, 5 + d);
    n++;
  }
  assert_int_equal(n, 32);
  return n;
}

/* Unequal spheres in open space, with films: as by dense algebra */
static void loop_is_dense_algebra(void **state)
{
  (void) state;
  uint64_t seed = 8;
  double x[24], a[8], F[48], V[48];
  for (int i = 0; i < 8; i++) {
    a[i] = i % 2 ? 1.0 : 0.6;
    for (int d = 0; d < 3; d++) x[3 * i + d] = 2.1 * (i >> d & 1);
    for (int e = 0; e < 6; e++) F[6 * i + e] = uniform(&seed, -1, 1);
  }
  blob_flock *f = free_spheres(12, 8, x, a);
  sd_bodies A = place(f, 0.0, 0.0);
  tie_with_films(f, &A);
  assert_int_equal(move(f, &A, F, 0, 1e-10), SD_OK);
  blobs *s = blobs_create(12, 1, 8, x, a);
  blobs_ready(s, NULL);
  blobs_move(s, F, NULL, V, NULL);
  CHECK_NEAR(off_by(f->V, V, 48), 0.0, 1e-8);
  for (int i = 0; i < 48; i++) CHECK_NEAR(f->exerted[i], F[i], 1e-8);
  blobs_free(s);
  blob_flock_free(f);
}

/* Random spheres at a volume fraction of 0.45 to 1e-3: products under weight and unlike forces,
 * with films and without */
static void products_in_a_suspension(void **state)
{
  (void) state;
  static const int most[2][2] = {{12, 12}, {13, 13}};
  double x[3 * MOST], side = 0.0, F[2][6 * MOST] = {{0.0}}, V[6 * MOST];
  uint64_t seed = 2;
  const int n = positions_of(x, &side);
  for (int i = 0; i < n; i++) {
    F[0][6 * i + 2] = -1.0;
    for (int d = 0; d < 3; d++)
      F[1][6 * i + d] =
          sqrt(-2.0 * log(uniform(&seed, 0, 1))) * cos(2.0 * SD_PI * uniform(&seed, 0, 1));
  }
  for (int films = 0; films < 2; films++) {
    blob_flock *f = free_spheres(12, n, x, NULL);
    sd_bodies A = place(f, side, 1e-6);
    if (films) tie_with_films(f, &A);
    for (int load = 0; load < 2; load++) {
      assert_int_equal(move(f, &A, F[load], 0, 1e-8), SD_OK);
      memcpy(V, f->V, sizeof V);
      assert_int_equal(move(f, &A, F[load], 0, 1e-3), SD_OK);
      const double off = off_by(f->V, V, 6 * n);
      print_message("%s films, %s: %d products to 1e-3, velocities off by %.1g\n",
                    films ? "with" : "no", load ? "unlike forces" : "weight", f->report.products,
                    off);
      assert_true(f->report.products <= most[films][load]);
      assert_true(off < 1e-3);
    }
    blob_flock_free(f);
  }
}

/* After a step along the velocities in which no sphere moves further than 1 % of its radius against
 * the others, from the last forces of the points: 3 to 5 products to 1e-3, where a cold start has 12. */
static void warm_start_in_a_suspension(void **state)
{
  (void) state;
  static const double steps[3] = {0.002, 0.01, 0.03};
  static const int most[3] = {3, 5, 7};
  double x[3 * MOST], y[3 * MOST], side = 0.0, F[6 * MOST] = {0.0}, mean = 0.0, fastest = 0.0;
  const int n = positions_of(x, &side);
  for (int i = 0; i < n; i++) F[6 * i + 2] = -6.0 * SD_PI;
  blob_flock *f = free_spheres(12, n, x, NULL);
  sd_bodies A = place(f, side, 1e-5);
  tie_with_films(f, &A);
  assert_int_equal(move(f, &A, F, 0, 1e-3), SD_OK);
  for (int i = 0; i < n; i++) mean += f->V[6 * i + 2] / n;
  for (int i = 0; i < n; i++) {
    const double v[3] = {f->V[6 * i], f->V[6 * i + 1], f->V[6 * i + 2] - mean};
    fastest = fmax(fastest, sqrt(sd_dot(v, v)));
  }
  for (int k = 0; k < 3; k++) {
    for (int i = 0; i < n; i++)
      for (int d = 0; d < 3; d++)
        y[3 * i + d] = x[3 * i + d] + steps[k] / fastest * f->V[6 * i + d];
    blob_flock *g = free_spheres(12, n, y, NULL);
    sd_bodies B = place(g, side, 1e-5);
    tie_with_films(g, &B);
    memcpy(g->l, f->l, sizeof f->l);
    memcpy(g->before, f->before, sizeof f->before);
    assert_int_equal(move(g, &B, F, 1, 1e-3), SD_OK);
    print_message("a step of %g radii: %d products\n", steps[k], g->report.products);
    assert_true(g->report.products <= most[k]);
    blob_flock_free(g);
  }
  blob_flock_free(f);
}

/* Doublets whose spheres overlap, with films between them: points that are hidden within spheres have no part in the
 * loop, though the films' system uses their rows. Whatever two loads do, F_1.V_2 is F_2.V_1, and each pair of spheres
 * bears its load. */
static void clumps_that_overlap(void **state)
{
  (void) state;
  enum { CLUMPS = 8, SPHERES = 2 * CLUMPS };
  static const double fused[6] = {0, 0, -0.5, 0, 0, 0.5};
  uint64_t seed = 31;
  double R[9 * CLUMPS], centre[3 * CLUMPS], F[2][6 * SPHERES], power[2] = {0.0};
  for (int b = 0; b < CLUMPS; b++) {
    random_rotation(&seed, R + 9 * b);
    for (int d = 0; d < 3; d++) centre[3 * b + d] = 3.2 * (b >> d & 1);
  }
  blob_flock *f = clumps_at(12, CLUMPS, 2, fused, R, centre);
  sd_bodies A = place(f, 0.0, 0.0);
  tie_with_films(f, &A);
  assert_true(f->s->L.count > 0 && !f->whole_shell[0]);
  for (int load = 0; load < 2; load++) {
    for (int i = 0; i < 6 * SPHERES; i++) F[load][i] = i % 6 < 3 ? uniform(&seed, -1, 1) : 0.0;
    assert_int_equal(move(f, &A, F[load], 0, 1e-9), SD_OK);
    assert_true(f->report.products < 25);
    for (int b = 0; b < CLUMPS; b++)
      for (int d = 0; d < 3; d++)
        CHECK_NEAR(f->exerted[12 * b + d] + f->exerted[12 * b + 6 + d], F[load][12 * b + d] + F[load][12 * b + 6 + d],
                   1e-12);
    for (int i = 0; i < 6 * SPHERES && load == 1; i++) power[0] += F[0][i] * f->v[i];
  }
  assert_int_equal(move(f, &A, F[0], 0, 1e-9), SD_OK);
  for (int i = 0; i < 6 * SPHERES; i++) power[1] += F[1][i] * f->v[i];
  CHECK_NEAR(power[0], power[1], 1e-8 * fabs(power[0]));
  blob_flock_free(f);
}

#define T 0.70710678118654752440
static const double doublet[6] = {0, 0, -1, 0, 0, 1};
static const double tetrahedron[12] = {T, T, T, T, -T, -T, -T, T, -T, -T, -T, T};
static const double chain5[15] = {0, 0, -4, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 0, 4};

static const struct {
  const char *name;
  int m;
  const double *x;
} shapes[3] = {{"doublet", 2, doublet}, {"tetrahedron", 4, tetrahedron}, {"chain5", 5, chain5}};

/* Of all rows of a table: the worst error of the translations with 12 and 42 points, of clumps that
 * settle and that are pushed apart, and the mean of the latter */
static void errors_of_two_clumps(const char *name, double worst[2][2], double mean[2])
{
  int pushed[2] = {0, 0};
  table t = table_open(name);
  while (table_next(&t)) {
    int shape = 0;
    while (strcmp(shapes[shape].name, t.column[0])) assert_true(++shape < 3);
    const int weight = !strcmp(t.column[2], "weight"), m = shapes[shape].m;
    double R[18], centre[6], V[12], F[6 * MOST] = {0.0};
    for (int b = 0; b < 2; b++) {
      for (int k = 0; k < 9; k++) R[9 * b + k] = table_number(&t, 7 + k);
      for (int d = 0; d < 3; d++) centre[3 * b + d] = table_number(&t, 4 + d);
      for (int i = 0; i < m; i++)
        for (int d = 0; d < 3; d++) F[6 * (m * b + i) + d] = table_number(&t, 16 + d) / m;
      for (int k = 0; k < 6; k++) V[6 * b + k] = table_number(&t, 19 + k);
      if (b == 0) assert_true(table_next(&t));
    }
    for (int points = 12; points <= 42; points += 30) {
      blob_flock *f = clumps_at(points, 2, m, shapes[shape].x, R, centre);
      sd_bodies A = place(f, 0.0, 0.0);
      tie_with_films(f, &A);
      assert_int_equal(move(f, &A, F, 0, 1e-7), SD_OK);
      double off = 0.0, all = 0.0;
      for (int k = 0; k < 12; k++) {
        off += k % 6 < 3 ? pow(f->V[k] - V[k], 2) : 0.0;
        all += k % 6 < 3 ? V[k] * V[k] : 0.0;
      }
      const int p = points == 42;
      worst[p][!weight] = fmax(worst[p][!weight], sqrt(off / all));
      if (!weight) mean[p] += (sqrt(off / all) - mean[p]) / ++pushed[p];
      blob_flock_free(f);
    }
  }
  print_message("%s, worst per cent: 12 points %.2f, apart %.2f, on average %.2f; 42 points %.2f, "
                "%.2f, %.2f\n",
                name, 100 * worst[0][0], 100 * worst[0][1], 100 * mean[0], 100 * worst[1][0],
                100 * worst[1][1], 100 * mean[1]);
}

/* Two rigid clumps, gaps 0.01 to 0.5, with films between them, against multipoles. Pushed apart
 * they are off by 0.5 % on average in the scenes of one table and by 0.7 % in those of the other.
 * Over 15 and 30 random orientations of the shells, of each clump or of each sphere, that is 0.5
 * and 0.9, and single scenes are off by 0.2 to 1.7 and by 0.1 to 3.4. What no orientation takes away
 * are the doublets of the second table, 1.6 and 1.8 % at gaps of 0.01 and 0.1, with 42 points as
 * well: one sphere is pushed out of the crevice between two that touch, and films are those of
 * pairs. With films of the very shells that face each other, in place of mean ones, it would be 0.4
 * and 0.7. */
static void two_rigid_clumps(void **state)
{
  (void) state;
  double worst[2][2] = {{0.0}}, mean[2] = {0.0}, crevice[2][2] = {{0.0}}, mean_crevice[2] = {0.0};
  errors_of_two_clumps("multiblob/near_clumps.csv", worst, mean);
  assert_true(worst[0][0] < 0.0009 && worst[0][1] < 0.008 && mean[0] < 0.0051);
  assert_true(worst[1][0] < 0.0004 && worst[1][1] < 0.018 && mean[1] < 0.0069);
  errors_of_two_clumps("motion/near_clumps.csv", crevice, mean_crevice);
  assert_true(crevice[0][0] < 0.001 && crevice[0][1] < 0.0147 && mean_crevice[0] < 0.0073);
  assert_true(crevice[1][0] < 0.0004 && crevice[1][1] < 0.0158 && mean_crevice[1] < 0.0079);
}

/* Translation of lone clumps against multipoles: 0.22 % at worst with 12 points, 0.04 % with 42.
 * The worst is a row of three: 0.23 % on average over orientations of its shells, 0.29 at most. */
static void lone_clumps(void **state)
{
  (void) state;
  double worst[2] = {0.0, 0.0};
  table t = table_open("clusters.csv");
  while (table_next(&t)) {
    double x[3 * MOST], a[MOST], known[3];
    if ((int) table_number(&t, 1) > 8) continue;
    const int m = table_cluster(t.column[0], x, a);
    for (int k = 0; k < 3; k++) known[k] = table_number(&t, 2 + k);
    for (int points = 12; points <= 42; points += 30) {
      sd_multiblob model;
      sd_multiblob_shape shape;
      sd_shape clump;
      double A[9], w[3], axes[9];
      assert_int_equal(sd_multiblob_create(points, 1, &model), SD_OK);
      assert_int_equal(sd_shape_create(m, x, a, &clump), SD_OK);
      assert_int_equal(sd_multiblob_shape_create(&model, &clump, NULL, &shape), SD_OK);
      for (int p = 0; p < 9; p++)
        A[p] = shape.points.resistance[6 * (p / 3) + p % 3] / (6.0 * SD_PI);
      sd_eigen(3, A, w, axes);
      for (int k = 0; k < 3; k++)
        worst[points == 42] = fmax(worst[points == 42], fabs(w[2 - k] / known[k] - 1.0));
      sd_multiblob_shape_free(&shape);
      sd_shape_free(&clump);
    }
  }
  print_message("lone clumps, worst per cent: %.2f, %.2f\n", 100 * worst[0], 100 * worst[1]);
  assert_true(worst[0] < 0.0023 && worst[1] < 0.0005);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lone_sphere),
      cmocka_unit_test(product_is_dense_where_parts_cut_shells),
      cmocka_unit_test(loop_is_dense_algebra),
      cmocka_unit_test(clumps_that_overlap),
      cmocka_unit_test(lone_clumps),
      cmocka_unit_test(two_rigid_clumps),
      cmocka_unit_test(products_in_a_suspension),
      cmocka_unit_test(warm_start_in_a_suspension),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
