/* Two rigid clumps near each other against exact velocities: spheres in the loop, shells of 42
 * points beside it, lubrication between the spheres of the two. */
#include "tied_flock.h"

#include "table.h"

#define T 0.70710678118654752440
static const double doublet[6] = {0, 0, -1, 0, 0, 1};
static const double tetrahedron[12] = {T, T, T, T, -T, -T, -T, T, -T, -T, -T, T};
static const double chain5[15] = {0, 0, -4, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 0, 4};
static const double ones[5] = {1, 1, 1, 1, 1};

static const struct {
  const char *name;
  int m;
  const double *x;
} shapes[3] = {{"doublet", 2, doublet}, {"tetrahedron", 4, tetrahedron}, {"chain5", 5, chain5}};

/* The poses of both clumps, the load on each sphere (their share of the clump's) and the exact
 * velocities V [12], from the row at which t stands and the next */
static flock *read_pair(table *t, int shape, int shell, double V[12])
{
  const int m = shapes[shape].m;
  flock *f = flock_create(m, shapes[shape].x, ones, shell, 2, 0, 1.0);
  for (int b = 0; b < 2; b++) {
    assert_int_equal((int) table_number(t, 3), b + 1);
    double *pose = f->pose + 12 * b;
    for (int k = 0; k < 9; k++) pose[k] = table_number(t, 7 + k);
    for (int d = 0; d < 3; d++) {
      pose[9 + d] = table_number(t, 4 + d);
      for (int i = 0; i < m; i++) f->F[6 * (m * b + i) + d] = table_number(t, 16 + d) / m;
    }
    for (int k = 0; k < 6; k++) V[6 * b + k] = table_number(t, 19 + k);
    if (b == 0) assert_true(table_next(t));
  }
  return f;
}

/* Relative error of the translations */
static double error_of(const flock *f, const double V[12])
{
  double off = 0.0, all = 0.0;
  for (int b = 0; b < 2; b++)
    for (int d = 0; d < 3; d++) {
      off += pow(f->V[6 * b + d] - V[6 * b + d], 2);
      all += pow(V[6 * b + d], 2);
    }
  return sqrt(off / all);
}

/* Settling within 0.8 %, gaps 0.01 to 0.5, whatever the clump; without lubrication up to 2.7 %.
 * Pushed apart, where the films decide, within 5 %; without it up to 2.5 times as fast. */
static void settling_and_apart(void **state)
{
  (void) state;
  table t = table_open("motion/near_clumps.csv");
  int rows = 0;
  for (; table_next(&t); rows++) {
    int shape = 0;
    while (strcmp(shapes[shape].name, t.column[0])) assert_true(++shape < 3);
    const int weight = !strcmp(t.column[2], "weight");
    const double gap = table_number(&t, 1);
    double V[12];
    flock *f = read_pair(&t, shape, 42, V);
    assert_int_equal(flock_move(f, 6, 0, 1e-9, 100), SD_OK);
    const double without = error_of(f, V);
    tied_flock *tied = tie_flock(f, 1e-4);
    assert_int_equal(tied_move(tied, 0, 1e-9, 200), SD_OK);
    const double error = error_of(f, V);
    print_message("%s, gap %g, %s: %.2f %%, without lubrication %.2f %%\n", t.column[0], gap,
                  weight ? "weight" : "apart", 100 * error, 100 * without);
    assert_true(error < (weight ? 0.008 : 0.05));
    if (!weight && gap < 0.05) assert_true(without > 0.3);
    untie(tied);
  }
  assert_int_equal(rows, 18);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(settling_and_apart),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
