/* Free clusters near contact, as they settle and as unlike forces move them: the model with
 * sd_lubrication.h against exact velocities, beside it the same model without lubrication and with
 * the classical sum of D over all pairs. */
#include "near_scene.h"
#include "pair_blocks.h"

#include "table.h"

#include "sd_constants.h"
#include "sd_linear.h"

enum { MOST = 27 };
enum { NONE, CLASSICAL, SHARED, MODELS };

/* One cluster under one load: rows of the table that follow one another */
typedef struct {
  char name[64], load[32];
  int n;
  double x[3 * MOST], a[MOST], F[6 * MOST], U[3 * MOST];
} motion;

/* The next one from the row at which t stands; 0: no more */
static int next_motion(table *t, motion *m)
{
  if (!t->file) return 0;
  memset(m, 0, sizeof *m);
  snprintf(m->name, sizeof m->name, "%s", t->column[0]);
  snprintf(m->load, sizeof m->load, "%s", t->column[3]);
  const int n = (int) table_number(t, 1);
  for (m->n = 0; m->n < n; m->n++) {
    assert_string_equal(t->column[0], m->name);
    assert_string_equal(t->column[3], m->load);
    m->a[m->n] = table_number(t, 5);
    for (int d = 0; d < 3; d++) {
      m->x[3 * m->n + d] = table_number(t, 6 + d);
      m->F[6 * m->n + d] = table_number(t, 9 + d);
      m->U[3 * m->n + d] = table_number(t, 12 + d);
    }
    if (!table_next(t)) t->file = NULL;
  }
  return 1;
}

static near_scene scene_of(const motion *m)
{
  scene s = scene_create(m->n);
  for (int i = 0; i < m->n; i++)
    scene_set(&s, i, m->x[3 * i], m->x[3 * i + 1], m->x[3 * i + 2], m->a[i], 1.0);
  near_scene q = near_create(s, 3.0, 1e-4);
  near_place(&q);
  return q;
}

/* R [(6n)^2] += D of every pair up to a gap of one mean radius */
static void add_classical(const near_scene *q, double *R)
{
  const int N = 6 * q->s.n;
  for (int i = 0; i < q->s.n; i++)
    for (int j = 0; j < i; j++) {
      const double *xi = q->s.x + 3 * j, *xj = q->s.x + 3 * i, sum = q->s.a[i] + q->s.a[j];
      double d[3], B[3][36];
      sd_minus(xj, xi, d);
      const double gap = 2.0 * (sqrt(sd_dot(d, d)) / sum - 1.0);
      if (gap >= 1.0) continue;
      sd_normalize(d);
      sd_pair_resistance D;
      assert_int_equal(
          sd_two_sphere_correction(q->functions, q->s.a[j], q->s.a[i], gap, 1.0, 0.0, &D), SD_OK);
      pair_blocks(&D, d, B[0], B[1], B[2]);
      for (int p = 0; p < 6; p++)
        for (int e = 0; e < 6; e++) {
          R[(6 * j + p) * N + 6 * j + e] += B[0][6 * p + e];
          R[(6 * i + p) * N + 6 * i + e] += B[2][6 * p + e];
          R[(6 * j + p) * N + 6 * i + e] += B[1][6 * p + e];
          R[(6 * i + e) * N + 6 * j + p] += B[1][6 * p + e];
        }
    }
}

/* |U - U_exact|/|U_exact| of a model */
static double error_of(const motion *m, int model)
{
  near_scene q = scene_of(m);
  const int N = 6 * m->n;
  double *R = dense_mobility(&q.s), v[6 * MOST], off = 0.0, all = 0.0;
  assert_int_equal(sd_cholesky(N, R), SD_OK);
  assert_int_equal(sd_cholesky_inverse(N, R), SD_OK);
  if (model == CLASSICAL) add_classical(&q, R);
  if (model == SHARED) {
    double *L = near_dense(&q);
    for (int k = 0; k < N * N; k++) R[k] += L[k];
    free(L);
  }
  memcpy(v, m->F, sizeof v);
  assert_int_equal(sd_cholesky_solve(N, R, 1, v), SD_OK);
  for (int i = 0; i < m->n; i++)
    for (int d = 0; d < 3; d++) {
      off += pow(v[6 * i + d] - m->U[3 * i + d], 2);
      all += pow(m->U[3 * i + d], 2);
    }
  free(R);
  near_free(&q);
  return sqrt(off / all);
}

typedef struct {
  int rows;
  double mean[MODELS], worst[MODELS];
} errors;

/* Errors of clusters of low to high spheres under some loads; all but a row along itself */
static errors errors_of(const char *load, int low, int high)
{
  errors e = {0};
  motion m;
  table t = table_open("motion/near_contact_clusters.csv");
  assert_true(table_next(&t));
  while (next_motion(&t, &m)) {
    if (strncmp(m.load, load, strlen(load)) || m.n < low || m.n > high) continue;
    if (!strncmp(m.name, "late_row10", 10) && !strcmp(m.load, "weight_x")) continue;
    e.rows++;
    for (int k = 0; k < MODELS; k++) {
      const double off = error_of(&m, k);
      e.mean[k] += off;
      e.worst[k] = fmax(e.worst[k], off);
    }
  }
  for (int k = 0; k < MODELS; k++) e.mean[k] /= e.rows;
  print_message(
      "%s, %d to %d spheres, %d cases, mean/worst per cent: none %.1f/%.1f, classical %.1f/%.1f, "
      "shared %.2f/%.2f\n",
      load, low, high, e.rows, 100 * e.mean[NONE], 100 * e.worst[NONE], 100 * e.mean[CLASSICAL],
      100 * e.worst[CLASSICAL], 100 * e.mean[SHARED], 100 * e.worst[SHARED]);
  return e;
}

/* Settling: 1.3 % in the mean, 3 % at worst; the classical sum is the worse the more neighbours
 * there are, and from five spheres on worse than nothing. */
static void settling(void **state)
{
  (void) state;
  const errors all = errors_of("weight", 2, MOST), few = errors_of("weight", 2, 4),
               some = errors_of("weight", 5, 8), many = errors_of("weight", 12, MOST);
  assert_int_equal(all.rows, 65);
  assert_true(all.mean[SHARED] < 0.013 && all.worst[SHARED] < 0.03);
  assert_true(few.mean[SHARED] < 0.3 * few.mean[CLASSICAL]);
  assert_true(some.mean[CLASSICAL] > some.mean[NONE]);
  assert_true(many.mean[CLASSICAL] > 1.5 * many.mean[NONE] && many.mean[CLASSICAL] > 0.2);
}

/* Unlike forces: the films decide, 3 % in the mean */
static void unlike_forces(void **state)
{
  (void) state;
  const errors all = errors_of("random", 2, MOST), many = errors_of("random", 12, MOST);
  assert_int_equal(all.rows, 33);
  assert_true(all.mean[SHARED] < 0.03);
  assert_true(all.mean[NONE] > 0.3);
  assert_true(many.mean[CLASSICAL] > 0.15);
}

/* Ten in a row, settling along it: they share the common motion with two neighbours only, 6 %. */
static void row_along_itself(void **state)
{
  (void) state;
  motion m;
  int rows = 0;
  table t = table_open("motion/near_contact_clusters.csv");
  assert_true(table_next(&t));
  while (next_motion(&t, &m)) {
    if (strncmp(m.name, "late_row10", 10) || strcmp(m.load, "weight_x")) continue;
    const double error = error_of(&m, SHARED);
    print_message("ten in a row along themselves: %.1f %%\n", 100 * error);
    assert_true(error < 0.06);
    rows++;
  }
  assert_int_equal(rows, 1);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(settling),
      cmocka_unit_test(unlike_forces),
      cmocka_unit_test(row_along_itself),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
