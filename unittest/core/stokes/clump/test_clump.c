/* Resistance of rigid clumps: symmetry, dissipation, frames, degenerate and bad input. */
#include "clumps.h"

/* --- what every resistance obeys ---------------------------------------------------------------------------------- */

/* Random clump of touching or overlapping spheres of different radii */
static int random_clump(uint64_t *seed, int n, double *x, double *a)
{
  for (int k = 0; k < n; k++) {
    a[k] = uniform(seed, 0.5, 1.5);
    double e[3], norm = 0.0;
    const int j = (int) uniform(seed, 0.0, k);
    for (int d = 0; d < 3; d++) {
      e[d] = uniform(seed, -1.0, 1.0);
      norm += e[d] * e[d];
    }
    for (int d = 0; d < 3; d++)
      x[3 * k + d] =
          k == 0 ? 0.0 : x[3 * j + d] + uniform(seed, 0.7, 1.0) * (a[k] + a[j]) * e[d] / sqrt(norm);
  }
  return n;
}

static void resistance_is_symmetric_and_dissipates(void **state)
{
  (void) state;
  uint64_t seed = 41;
  for (int trial = 0; trial < 20; trial++) {
    double x[3 * MOST], a[MOST];
    const int n = random_clump(&seed, 2 + trial % 5, x, a),
              shell = trial % 3 == 0 ? 1
        : trial % 3 == 1             ? 12
                                     : 42;
    sd_clump clump = solve(n, x, a, shell, 1);
    double sum[36] = {0.0}, R[36], c[3] = {0.0};
    for (int k = 0; k < n; k++)
      for (int d = 0; d < 3; d++) c[d] += x[3 * k + d] / n;
    for (int k = 0; k < n;
         k++) /* from the table itself, so that symmetry is a fact and not made by averaging */
      for (int q = 0; q < 6; q++) {
        const double *t = clump.table + 6 * (12 * k + q),
                     arm[3] = {x[3 * k] - c[0], x[3 * k + 1] - c[1], x[3 * k + 2] - c[2]};
        double torque[3];
        sd_cross(arm, t, torque);
        for (int p = 0; p < 3; p++) {
          sum[6 * p + q] += t[p];
          sum[6 * (p + 3) + q] += t[p + 3] + torque[p];
        }
      }
    for (int p = 0; p < 6; p++)
      for (int q = 0; q < 6; q++) {
        CHECK_NEAR(sum[6 * p + q], sum[6 * q + p], 1e-10 * clump.R[0]);
        CHECK_NEAR(sum[6 * p + q], clump.R[6 * p + q], 1e-10 * clump.R[0]);
      }
    memcpy(R, clump.R, sizeof(R));
    assert_true(positive_definite(R, 6, 0.0));
    sd_clump_free(&clump);
  }
}

/* Force and torque on the spheres in the lab, for a pose, a viscosity and a linear slip, add up to R (s0, W) + strain
   E. */
static void forces_add_up_to_the_matrix(void **state)
{
  (void) state;
  uint64_t seed = 43;
  const double eta = 0.3;
  double x[3 * MOST], a[MOST], F[3 * MOST], T[3 * MOST], F2[3 * MOST], T2[3 * MOST];
  const int n = random_clump(&seed, 6, x, a);
  sd_clump clump = solve(n, x, a, 42, 0);
  double c[3] = {0.0};
  for (int k = 0; k < n; k++)
    for (int d = 0; d < 3; d++) c[d] += x[3 * k + d] / n;
  for (int trial = 0; trial < 20; trial++) {
    double Q[9], s0[3], A[9], E[9], in[12], total[6] = {0.0};
    const sd_clump_placed placed = {.clump = &clump, .pose = Q, .eta = eta};
    const sd_clump_rows rows = {3, NULL, F, T}, rows_rigid = {3, NULL, F2, T2};
    random_rotation(&seed, Q);
    for (int d = 0; d < 3; d++) s0[d] = uniform(&seed, -1.0, 1.0);
    for (int d = 0; d < 9; d++) A[d] = uniform(&seed, -1.0, 1.0);
    sd_clump_forces(&placed, s0, A, &rows);
    for (int k = 0; k < n; k++) {
      double arm[3], lab[3], torque[3];
      for (int d = 0; d < 3; d++) arm[d] = x[3 * k + d] - c[d];
      sd_multiply3(Q, arm, lab);
      sd_cross(lab, F + 3 * k, torque);
      for (int d = 0; d < 3; d++) {
        total[d] += F[3 * k + d];
        total[d + 3] += T[3 * k + d] + torque[d];
      }
    }
    /* slip in the frame of the shape */
    const double W[3] = {0.5 * (A[7] - A[5]), 0.5 * (A[2] - A[6]), 0.5 * (A[3] - A[1])};
    sd_multiply3t(Q, s0, in);
    sd_multiply3t(Q, W, in + 3);
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++) {
        E[3 * p + q] = 0.0;
        for (int u = 0; u < 3; u++)
          for (int v = 0; v < 3; v++)
            E[3 * p + q] += Q[3 * u + p] * 0.5 * (A[3 * u + v] + A[3 * v + u]) * Q[3 * v + q];
      }
    const double e[6] = {E[0], E[4], E[8], E[5], E[2], E[1]};
    memcpy(in + 6, e, sizeof(e));
    double own[6], lab[6];
    for (int p = 0; p < 6; p++) {
      own[p] = 0.0;
      for (int q = 0; q < 6; q++)
        own[p] += eta * (clump.R[6 * p + q] * in[q] + clump.strain[6 * p + q] * in[q + 6]);
    }
    sd_multiply3(Q, own, lab);
    sd_multiply3(Q, own + 3, lab + 3);
    for (int p = 0; p < 6; p++) CHECK_NEAR(total[p], lab[p], 1e-11 * clump.R[0]);

    /* slip of a rigid motion alone: the short way gives the same */
    const double spin[9] = {0, -W[2], W[1], W[2], 0, -W[0], -W[1], W[0], 0};
    sd_clump_forces(&placed, s0, spin, &rows);
    sd_clump_forces_rigid(&placed, s0, W, &rows_rigid);
    for (int k = 0; k < 3 * n; k++) {
      CHECK_NEAR(F2[k], F[k], 1e-12 * clump.R[0]);
      CHECK_NEAR(T2[k], T[k], 1e-12 * clump.R[0]);
    }
  }
  sd_clump_free(&clump);
}

/* 6x6 in other axes; for the mirror z -> -z, torques and angular velocities change sign. */
static void turned(const double R[36], const double Q[9], double hand, double out[36])
{
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 6; q++) {
      double s = 0.0;
      for (int u = 0; u < 3; u++)
        for (int v = 0; v < 3; v++)
          s += Q[3 * (p % 3) + u] * R[6 * (p / 3 * 3 + u) + q / 3 * 3 + v] * Q[3 * (q % 3) + v];
      out[6 * p + q] = (p < 3) == (q < 3) ? s : hand * s;
    }
}

/* The same clump turned, moved, reflected and its spheres in another order has the same resistance, turned and
 * reflected: for all clusters and for random clumps, whatever the shell. */
static void answer_does_not_depend_on_orientation_or_order(void **state)
{
  (void) state;
  uint64_t seed = 47;
  for (int m = 0; m < N_CLUSTERS + 8; m++)
    for (int trial = 0; trial < 4; trial++) {
      double x[3 * MOST], a[MOST], y[3 * MOST], b[MOST], Q[9], expected[36];
      int order[MOST];
      const int n = m < N_CLUSTERS ? table_cluster(clusters[m], x, a)
                                   : random_clump(&seed, 3 + m % 3, x, a);
      const double hand = trial % 2 ? -1.0 : 1.0;
      sd_clump one = solve(n, x, a, m == 10 ? 12 : trial < 2 ? 12 : 42, 0);
      random_rotation(&seed, Q);
      random_order(&seed, n, order);
      for (int p = 0; p < 3; p++) Q[3 * p + 2] *= hand;
      for (int k = 0; k < n; k++) {
        b[k] = a[order[k]];
        sd_multiply3(Q, x + 3 * order[k], y + 3 * k);
        for (int d = 0; d < 3; d++) y[3 * k + d] += 7.0 - d;
      }
      sd_clump other = solve(n, y, b, m == 10 ? 12 : trial < 2 ? 12 : 42, 0);
      turned(one.R, Q, hand, expected);
      for (int p = 0; p < 36; p++) CHECK_NEAR(other.R[p], expected[p], 1e-9 * one.R[21]);
      for (int k = 0; k < n; k++) { /* sphere by sphere: force from translation */
        const double *t = other.table + 72 * k, *u = one.table + 72 * order[k];
        for (int p = 0; p < 3; p++)
          for (int q = 0; q < 3; q++) {
            double s = 0.0;
            for (int v = 0; v < 3; v++)
              for (int w = 0; w < 3; w++) s += Q[3 * p + v] * u[6 * w + v] * Q[3 * q + w];
            CHECK_NEAR(t[6 * q + p], s, 1e-9 * one.R[0]);
          }
      }
      sd_clump_free(&one);
      sd_clump_free(&other);
    }
}

/* A sheet or an axis of symmetry leaves no coupling; the chiral cluster has some, and its mirror image the opposite. */
static void mirror_image_flips_the_coupling(void **state)
{
  (void) state;
  double x[3 * MOST], a[MOST];
  const int n = table_cluster("helix4_chiral", x, a);
  sd_clump one = solve(n, x, a, 42, 0);
  for (int k = 0; k < n; k++) x[3 * k] = -x[3 * k];
  sd_clump other = solve(n, x, a, 42, 0);
  const double trace = one.R_centre[18] + one.R_centre[25] + one.R_centre[32];
  const double opposite = other.R_centre[18] + other.R_centre[25] + other.R_centre[32];
  assert_true(fabs(trace) > 0.01);
  CHECK_NEAR(opposite, -trace, 1e-10);
  sd_clump_free(&one);
  sd_clump_free(&other);
  sd_clump tetrapod = solve_cluster("tetrapod5", 42, 0);
  for (int p = 3; p < 6; p++)
    for (int q = 0; q < 3; q++) CHECK_NEAR(tetrapod.R[6 * p + q], 0.0, 1e-8);
  sd_clump_free(&tetrapod);
}

static void coupling_is_symmetric_about_the_centre(void **state)
{
  (void) state;
  uint64_t seed = 53;
  for (int trial = 0; trial < 12; trial++) {
    double x[3 * MOST], a[MOST], one[36];
    const int n = random_clump(&seed, 3 + trial % 3, x, a);
    sd_clump clump = solve(n, x, a, trial % 2 ? 1 : 12, trial % 4 == 1);
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++)
        CHECK_NEAR(clump.R_centre[6 * (p + 3) + q], clump.R_centre[6 * (q + 3) + p],
                   1e-10 * clump.R[0]);
    for (int p = 0; p < 6; p++)
      for (int q = 0; q < 6; q++) {
        one[6 * p + q] = 0.0;
        for (int k = 0; k < 6; k++)
          one[6 * p + q] += clump.R_centre[6 * p + k] * clump.mobility[6 * k + q];
        if (n > 2) CHECK_NEAR(one[6 * p + q], p == q, 1e-9);
      }
    sd_clump_free(&clump);
  }
}

/* A big sphere that touches a small one has its centre near its own. */
static void centre_lies_where_the_drag_is(void **state)
{
  (void) state;
  const double x[6] = {0, 0, 0, 0, 0, 1.1}, a[2] = {1.0, 0.1};
  sd_clump clump = solve(2, x, a, 42, 0);
  CHECK_NEAR(clump.centre[0], 0.0, 1e-10);
  CHECK_NEAR(clump.centre[2], -0.55, 0.01); /* from the centroid of the centres */
  sd_clump_free(&clump);
}

/* --- degenerate and bad input ------------------------------------------------------------------------------------- */

/* Point forces in a row have no resistance to spin; that must not upset anything else. */
static void row_without_torques_has_no_spin_resistance(void **state)
{
  (void) state;
  sd_clump clump = solve_row(3, 2.0, 1, 0);
  CHECK_NEAR(clump.R[35], 0.0, 1e-12);
  CHECK_NEAR(clump.mobility[35], 0.0, 1e-12);
  CHECK_NEAR(clump.mobility[14] * clump.R[14], 1.0, 1e-12);
  CHECK_NEAR(clump.radius, 3.0 / (1 / 1.4864864865 + 2 / 1.7788461538), 1e-9);
  sd_clump_free(&clump);
  sd_clump one = solve(1, (double[3]){1, 2, 3}, (double[1]){0.8}, 1, 0);
  CHECK_NEAR(one.R[0], 6.0 * SD_PI * 0.8, 1e-13);
  CHECK_NEAR(one.radius, 0.8, 1e-13);
  sd_clump_free(&one);
}

/* A sphere inside another carries nothing in rigid motion, and the clump is its host. */
static void hidden_sphere_carries_nothing(void **state)
{
  (void) state;
  const double x[6] = {0, 0, 0, 0.2, 0.1, 0.3}, a[2] = {1.0, 0.4};
  for (int m = 0; m < 3; m++) {
    const int shell = m == 0 ? 1 : m == 1 ? 12 : 162;
    sd_clump clump = solve(2, x, a, shell, 1);
    double w[3];
    for (int k = 0; k < 36; k++)
      if (k % 6 < 3) CHECK_NEAR(clump.table[72 + k], 0.0, 1e-12);
    eigenvalues(clump.R, 0, 6.0 * SD_PI, w);
    for (int k = 0; k < 3; k++) CHECK_NEAR(w[k], 1.0, 1e-10);
    sd_clump_free(&clump);
  }
}

static void equal_spheres_at_one_point_are_refused(void **state)
{
  (void) state;
  double x[9] = {0, 0, 0, 0, 0, 2, 0, 0, 2}, a[3] = {1, 1, 1};
  sd_shape shape;
  sd_clump clump;
  sd_clump_options o = SD_CLUMP_OPTIONS;
  for (int shell = 1; shell < 20; shell += 11) {
    o.shell = shell;
    x[8] = 2.0 + 1e-7;
    assert_int_equal(sd_shape_create(3, x, a, &shape), SD_OK);
    assert_int_equal(sd_clump_create(&shape, &o, &shells, &clump, NULL), SD_ESINGULAR);
    sd_shape_free(&shape);
    x[8] = 2.01; /* close is no problem */
    assert_int_equal(sd_shape_create(3, x, a, &shape), SD_OK);
    assert_int_equal(sd_clump_create(&shape, &o, &shells, &clump, NULL), SD_OK);
    sd_shape_free(&shape);
    sd_clump_free(&clump);
  }
}

static int products;
static void count_products(void *ctx, int number, int solves, int product)
{
  assert_ptr_equal(ctx, &products);
  assert_true(number >= 0 && number < solves && solves % 12 == 0 && product >= 0);
  products++;
}

/* Too large for a dense matrix: gradients give the same answer; too large for anything: refused, with the bytes it
   would take. */
static void memory_decides_the_solver(void **state)
{
  (void) state;
  double x[3 * MOST], a[MOST];
  const int n = table_cluster("helix4_chiral", x, a);
  for (int rotation = 0; rotation < 2; rotation++) {
    sd_shape shape;
    sd_clump dense, iterative;
    sd_clump_need need;
    sd_clump_options o = SD_CLUMP_OPTIONS;
    o.shell = rotation ? 1 : 42;
    o.rotation = rotation;
    assert_int_equal(sd_shape_create(n, x, a, &shape), SD_OK);
    assert_int_equal(sd_clump_create(&shape, &o, &shells, &dense, &need), SD_OK);
    assert_int_equal(dense.iterations, 0);
    assert_int_equal(need.points, rotation ? n : 42 * n);

    o.memory = 0.9 * need.dense;
    o.tolerance = 1e-9;
    o.progress = count_products;
    o.progress_ctx = &products;
    if (need.iterative < o.memory) {
      products = 0;
      assert_int_equal(sd_clump_create(&shape, &o, &shells, &iterative, &need), SD_OK);
      assert_true(iterative.iterations > 1 && products > 12);
      for (int k = 0; k < 36; k++) CHECK_NEAR(iterative.R[k], dense.R[k], 1e-6 * dense.R[21]);
      sd_clump_free(&iterative);
    } else
      assert_true(rotation);

    o.memory = 0.5 * fmin(need.iterative, need.dense);
    assert_int_equal(sd_clump_create(&shape, &o, &shells, &iterative, &need), SD_ENOMEMORY);
    assert_null(iterative.table);
    assert_true(need.dense > o.memory && need.iterative > o.memory);
    sd_clump_free(&dense);
    sd_shape_free(&shape);
  }
}

/* More points than an int counts, of the larger of two spheres: refused, and not taken for a sphere of one point */
static void more_points_than_can_be_counted_are_refused(void **state)
{
  (void) state;
  const double x[6] = {0.0, 0.0, 0.0, 1.3, 0.0, 0.0}, a[2] = {1.0, 1e-5};
  sd_shape shape;
  sd_clump clump;
  sd_clump_need need;
  sd_clump_options o = SD_CLUMP_OPTIONS;
  o.shell = 2000000000;
  assert_int_equal(sd_shape_create(2, x, a, &shape), SD_OK);
  assert_int_equal(sd_clump_create(&shape, &o, &shells, &clump, &need), SD_ENOMEMORY);
  assert_true(need.points > 2000000000);
  sd_shape_free(&shape);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(resistance_is_symmetric_and_dissipates),
      cmocka_unit_test(forces_add_up_to_the_matrix),
      cmocka_unit_test(answer_does_not_depend_on_orientation_or_order),
      cmocka_unit_test(mirror_image_flips_the_coupling),
      cmocka_unit_test(coupling_is_symmetric_about_the_centre),
      cmocka_unit_test(centre_lies_where_the_drag_is),
      cmocka_unit_test(row_without_torques_has_no_spin_resistance),
      cmocka_unit_test(hidden_sphere_carries_nothing),
      cmocka_unit_test(equal_spheres_at_one_point_are_refused),
      cmocka_unit_test(memory_decides_the_solver),
      cmocka_unit_test(more_points_than_can_be_counted_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, free_shells);
}
