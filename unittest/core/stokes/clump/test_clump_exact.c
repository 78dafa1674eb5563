/* Resistance of rigid clumps: published values of the model (shell 1), exact values (shells). */
#include "clumps.h"
#include "plain.h"

#include "sd_product.h"
#include "sd_solve.h"

/* --- shell 1: the model's own values --------------------------------------------------------------------------- */

typedef struct {
  const double *x, *a;
  double ones[MOST];
  int n;
} pairs;

static sd_status apply(void *ctx, const double *F, double *u)
{
  const pairs *p = ctx;
  const sd_spheres s = {p->x, p->a, p->ones};
  plain_all(&(sd_law){.tensor = SD_TENSOR_RPY}, &s, p->n, 3, F, u);
  return SD_OK;
}

/* Without rotation and with shell 1 each force is that of the ordinary solve, in rigid motion and strain. */
static void shell_one_is_the_ordinary_solve(void **state)
{
  (void) state;
  static const double R[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const double eta = 1.7, s0[3] = {0.3, -0.7, 1.1},
               A[9] = {0.2, 0.5, -0.3, 0.7, -0.4, 0.1, 0.9, -0.8, 0.15};
  uint64_t seed = 31;
  pairs p = {.n = 20};
  double x[3 * MOST], a[MOST], slip[3 * MOST], F[3 * MOST], G[3 * MOST], T[3 * MOST], drag[MOST],
      work[SD_SOLVE_WORK(MOST, 3)], c[3] = {0};
  for (int k = 0; k < p.n; k++) {
    a[k] = uniform(&seed, 0.5, 1.2);
    drag[k] = 6.0 * SD_PI * eta * a[k];
    p.ones[k] = 1.0 / sqrt(eta);
    for (int d = 0; d < 3; d++) c[d] += (x[3 * k + d] = uniform(&seed, -2.0, 2.0)) / p.n;
  }
  p.x = x;
  p.a = a;
  for (int k = 0; k < p.n; k++)
    for (int d = 0; d < 3; d++) {
      slip[3 * k + d] = s0[d];
      for (int q = 0; q < 3; q++) slip[3 * k + d] += A[3 * d + q] * (x[3 * k + q] - c[q]);
    }
  const sd_system S = {.n = p.n, .drag = drag, .apply = apply, .apply_ctx = &p};
  sd_solve_report report;
  assert_int_equal(sd_solve_gradients(&S, slip, 1e-12, 1000, F, work, &report), SD_OK);
  sd_clump clump = solve(p.n, x, a, 1, 0);
  const sd_clump_placed placed = {.clump = &clump, .pose = R, .eta = eta};
  sd_clump_forces(&placed, s0, A, &(sd_clump_rows){3, NULL, G, T});
  double largest = 0.0;
  for (int k = 0; k < 3 * p.n; k++) largest = fmax(largest, fabs(F[k]));
  for (int k = 0; k < 3 * p.n; k++) {
    CHECK_NEAR(G[k], F[k],
               1e-9 * largest); /* tolerance of the iterative solve times its condition */
    CHECK_NEAR(T[k], 0.0, 0.0);
  }
  sd_clump_free(&clump);
}

/* All 36 entries with and without rotation: columns of the table from kind on. */
static void models_have_the_published_matrices(void **state)
{
  (void) state;
  int rows = 0;
  table t = table_open("clusters_full.csv");
  while (table_next(&t)) {
    const int rotation = !strcmp(t.column[2], "rpy_tt_rt_rr");
    if (!rotation && strcmp(t.column[2], "joung_rpy_tt")) continue;
    sd_clump clump = solve_cluster(t.column[0], 1, rotation);
    double largest = 0.0;
    for (int k = 0; k < 36; k++) largest = fmax(largest, fabs(clump.R[k]));
    for (int k = 0; k < 36; k++) CHECK_NEAR(clump.R[k], table_number(&t, 3 + k), 1e-8 * largest);
    sd_clump_free(&clump);
    rows++;
  }
  assert_int_equal(rows, 2 * N_CLUSTERS);
}

/* Eigenvalues of clusters.csv and rows of fused.csv, to their last digit */
static void models_have_the_published_eigenvalues(void **state)
{
  (void) state;
  for (int rotation = 0; rotation < 2; rotation++) {
    table t = table_open("clusters.csv");
    while (table_next(&t)) {
      sd_clump clump = solve_cluster(t.column[0], 1, rotation);
      for (int block = 0; block < 2; block++) {
        double w[3];
        eigenvalues(clump.R, block, block ? 8.0 * SD_PI : 6.0 * SD_PI, w);
        for (int k = 0; k < 3; k++)
          CHECK_NEAR(w[k], table_number(&t, (rotation ? 17 : 11) + 3 * block + k),
                     fmax(0.51e-8, 1e-8 * w[2]));
      }
      sd_clump_free(&clump);
    }
    t = table_open("fused.csv");
    while (table_next(&t)) {
      sd_clump clump = solve_row((int) table_number(&t, 0), table_number(&t, 1), 1, rotation);
      const int first = rotation ? 11 : 8;
      CHECK_NEAR(clump.R[14] / (6.0 * SD_PI), table_number(&t, first), 1e-8);
      CHECK_NEAR(clump.R[0] / (6.0 * SD_PI), table_number(&t, first + 1), 1e-8);
      CHECK_NEAR(clump.R[21] / (8.0 * SD_PI), table_number(&t, first + 2),
                 1e-8 * fmax(1.0, table_number(&t, first + 2)));
      sd_clump_free(&clump);
    }
  }
}

/* Four unit spheres in a row at s = 1: values of the test-suite of PyGRPY (R. Waszkiewicz, github.com/RadostW/PyGRPY,
   tests). */
static void row_of_four_has_the_values_of_pygrpy(void **state)
{
  (void) state;
  sd_clump clump = solve_row(4, 1.0, 1, 1);
  CHECK_NEAR(clump.mobility[0], 0.03225999460266797, 1e-15);
  CHECK_NEAR(clump.mobility[14], 0.03876335168633891, 1e-15);
  CHECK_NEAR(clump.mobility[21], 0.006590020934028927, 1e-15);
  CHECK_NEAR(clump.mobility[35], 0.017665748920274064, 1e-15);
  CHECK_NEAR(clump.radius, 1.5409546371938094, 1e-13);
  sd_clump_free(&clump);
}

/* --- shells: the exact values ------------------------------------------------------------------------------------- */

static const struct {
  int n;
  double translation, rotation;
  /* spheres of a clump at the most: time grows with the cube of the points */
  int spheres;
} ladder[] = {{12, 0.6e-2, 1.5e-2, MOST}, {42, 0.35e-2, 0.4e-2, MOST}, {162, 0.15e-2, 0.2e-2, 4}};
enum { RUNGS = CHECK_SIZE(3, 2) };

static void worse(double *worst, double value, double exact)
{
  const double error = value / exact - 1.0;
  if (fabs(error) > fabs(*worst)) *worst = error;
}

static void report(int rung, const char *what, double translation, double rotation)
{
  printf("             shell %3d, %-18s worst translation %+.3f %%, rotation %+.3f %%\n",
         ladder[rung].n, what, 100 * translation, 100 * rotation);
  CHECK_NEAR(translation, 0.0, ladder[rung].translation);
  CHECK_NEAR(rotation, 0.0, ladder[rung].rotation);
}

static void clusters_are_near_exact(void **state)
{
  (void) state;
  for (int rung = 0; rung < RUNGS; rung++) {
    double worst[2] = {0.0, 0.0};
    table t = table_open("clusters.csv");
    while (table_next(&t)) {
      if (table_number(&t, 1) > ladder[rung].spheres) continue;
      sd_clump clump = solve_cluster(t.column[0], ladder[rung].n, 0);
      for (int block = 0; block < 2; block++) {
        double w[3];
        eigenvalues(clump.R, block, block ? 8.0 * SD_PI : 6.0 * SD_PI, w);
        for (int k = 0; k < 3; k++) worse(worst + block, w[k], table_number(&t, 2 + 3 * block + k));
      }
      worse(worst, clump.radius, table_number(&t, 8));
      sd_clump_free(&clump);
    }
    report(rung, "open clusters", worst[0], worst[1]);
  }
}

/* The coupling of the chiral cluster, and every other entry, beside the exact matrix: 0.6, 0.3, 0.15 % of the largest
   entry */
static void whole_matrices_are_near_exact(void **state)
{
  (void) state;
  static const double limit[3] = {0.6e-2, 0.3e-2, 0.15e-2};
  for (int rung = 0; rung < 2; rung++) {
    table t = table_open("clusters_full.csv");
    while (table_next(&t)) {
      if (strncmp(t.column[2], "exact", 5)) continue;
      sd_clump clump = solve_cluster(t.column[0], ladder[rung].n, 0);
      double largest = 0.0;
      for (int k = 0; k < 36; k++) largest = fmax(largest, fabs(clump.R[k]));
      for (int k = 0; k < 36; k++)
        CHECK_NEAR(clump.R[k] / largest, table_number(&t, 3 + k) / largest, limit[rung]);
      sd_clump_free(&clump);
    }
  }
}

static void fused_rows_are_near_exact(void **state)
{
  (void) state;
  for (int rung = 0; rung < RUNGS; rung++) {
    double worst[2] = {0.0, 0.0};
    table t = table_open("fused.csv");
    while (table_next(&t)) {
      const int n = (int) table_number(&t, 0);
      if (n > ladder[rung].spheres) continue;
      sd_clump clump = solve_row(n, table_number(&t, 1), ladder[rung].n, 0);
      worse(worst, clump.R[14] / (6.0 * SD_PI), table_number(&t, 2));
      worse(worst, clump.R[0] / (6.0 * SD_PI), table_number(&t, 3));
      worse(worst + 1, clump.R[21] / (8.0 * SD_PI), table_number(&t, 4));
      sd_clump_free(&clump);
    }
    report(rung, "fused rows", worst[0], worst[1]);
  }
}

/* Drag, and the period of Jeffery's orbit, 2 pi/rate (re + 1/re): re = sqrt((1+B)/(1-B)), B = torque from strain over
 * torque from rotation. Chain along z in a shear u_y = rate z. */
static void chains_are_near_exact_and_tumble_in_time(void **state)
{
  (void) state;
  static const double limit[3] = {1e-2, 0.5e-2, 0.25e-2};
  for (int rung = 0; rung < RUNGS; rung++) {
    double worst[2] = {0.0, 0.0}, period = 0.0;
    table t = table_open("chains_exact.csv");
    while (table_next(&t)) {
      const int n = (int) table_number(&t, 0);
      if (n > 10 || n > ladder[rung].spheres) continue;
      sd_clump clump = solve_row(n, 2.0, ladder[rung].n, 0);
      worse(worst, clump.R[14] / (6.0 * SD_PI), table_number(&t, 2));
      worse(worst, clump.R[0] / (6.0 * SD_PI), table_number(&t, 3));
      worse(worst + 1, clump.R[21] / (8.0 * SD_PI), table_number(&t, 7));
      const double B = fabs(clump.strain[6 * 3 + 3] / clump.R[21]), re = sqrt((1 + B) / (1 - B));
      worse(&period, 2 * SD_PI * (re + 1 / re), table_number(&t, 10));
      sd_clump_free(&clump);
    }
    report(rung, "chains", worst[0], worst[1]);
    printf("             shell %3d, chains: worst period %+.3f %%\n", ladder[rung].n, 100 * period);
    CHECK_NEAR(period, 0.0, limit[rung]);
  }
}

/* Total drag of rigid pairs, gap 0.01 to 10 mean radii, radii 1:2 to 1:100; and touching (a2/a1, along, across, in 6 pi
 * eta a1 U: multipole collocation, computed independently of this project). */
static void unequal_dumbbells_are_near_exact(void **state)
{
  (void) state;
  static const double touching[5][3] = {{1.5, 1.6627786, 1.8390590},
                                        {2, 2.0972489, 2.2658285},
                                        {3, 3.0405340, 3.1765256},
                                        {5, 5.0106730, 5.0943358},
                                        {10, 10.0012436, 10.0338406}};
  for (int rung = 0; rung < RUNGS; rung++) {
    double worst = 0.0, x[6] = {0}, a[2] = {1.0, 0.0};
    for (int k = 0; k < 5; k++) {
      a[1] = touching[k][0];
      x[5] = 1.0 + a[1];
      sd_clump clump = solve(2, x, a, ladder[rung].n, 0);
      worse(&worst, clump.R[14] / (6.0 * SD_PI), touching[k][1]);
      worse(&worst, clump.R[0] / (6.0 * SD_PI), touching[k][2]);
      sd_clump_free(&clump);
    }
    table t = table_open("two_spheres_unequal.csv");
    while (table_next(&t)) {
      a[1] = table_number(&t, 0);
      x[5] = table_number(&t, 2);
      sd_clump clump = solve(2, x, a, ladder[rung].n, 0);
      worse(&worst, clump.R[14] / (6.0 * SD_PI), table_number(&t, 3) + a[1] * table_number(&t, 4));
      if (*t.column[5])
        worse(&worst, clump.R[0] / (6.0 * SD_PI), table_number(&t, 5) + table_number(&t, 6));
      sd_clump_free(&clump);
    }
    printf("             shell %3d, unequal dumbbells  worst translation %+.3f %%\n",
           ladder[rung].n, 100 * worst);
    CHECK_NEAR(worst, 0.0, ladder[rung].translation);
  }
}

static void lone_sphere_is_exact(void **state)
{
  (void) state;
  const double x[3] = {3, 4, 5}, a = 0.7;
  const int sizes[] = {1, 12, 17, 42, 100, 162};
  for (int m = 0; m < 6; m++) {
    sd_clump clump = solve(1, x, &a, sizes[m], 1);
    for (int p = 0; p < 36; p++) {
      const double exact = p % 7 ? 0.0 : p < 21 ? 6.0 * SD_PI * a : 8.0 * SD_PI * a * a * a;
      CHECK_NEAR(clump.R[p], exact, 1e-10);
      CHECK_NEAR(clump.strain[p], 0.0, 1e-10);
    }
    CHECK_NEAR(clump.radius, a, 1e-10);
    sd_clump_free(&clump);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(shell_one_is_the_ordinary_solve),
      cmocka_unit_test(models_have_the_published_matrices),
      cmocka_unit_test(models_have_the_published_eigenvalues),
      cmocka_unit_test(row_of_four_has_the_values_of_pygrpy),
      cmocka_unit_test(clusters_are_near_exact),
      cmocka_unit_test(whole_matrices_are_near_exact),
      cmocka_unit_test(fused_rows_are_near_exact),
      cmocka_unit_test(chains_are_near_exact_and_tumble_in_time),
      cmocka_unit_test(unequal_dumbbells_are_near_exact),
      cmocka_unit_test(lone_sphere_is_exact),
  };
  return cmocka_run_group_tests(tests, NULL, free_shells);
}
