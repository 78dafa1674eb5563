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

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(velocities_are_those_of_dense_sums),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
