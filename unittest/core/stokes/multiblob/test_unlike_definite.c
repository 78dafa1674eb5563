/* Is the matrix of all points with the one-body addition positive definite where spheres of three radii,
 * whose points go with them, are pressed into each other? No theorem says so (sd_multiblob.h). */
#include "check.h"

#include <stdlib.h>
#include <string.h>

#include "sd_body_shape.h"
#include "sd_linear.h"
#include "sd_multiblob.h"

enum { CLASSES = 4, MOST = 20 };

/* Radii over the smallest, points, and how many spheres of each class a group has; every tenth has one of 642
 * points instead of those of 162 */
static const double radius[CLASSES] = {1.0, 2.0, 4.0, 8.0};
static const int points[CLASSES] = {12, 42, 162, 642}, least[CLASSES] = {4, 1, 1, 1}, spread[CLASSES] = {9, 4, 2, 1};

typedef struct {
  int n;
  double x[3 * MOST], a[MOST];
  int kind[MOST];
} group;

static group some_spheres(int large, uint64_t *seed)
{
  group g = {.n = 0};
  for (int c = 0; c < CLASSES; c++) {
    if (c == (large ? 2 : 3)) continue;
    const int count = least[c] + (int) uniform(seed, 0.0, spread[c]);
    for (int k = 0; k < count; k++) {
      g.kind[g.n] = c;
      g.a[g.n++] = radius[c] * uniform(seed, 1.0, c == 0 ? 1.5 : 1.25);
    }
  }
  return g;
}

/* Pulled together from all sides, and apart where a pair overlaps by more than `pressed` of the smaller radius */
static void press(group *g, double pressed, uint64_t *seed)
{
  for (int k = 0; k < 3 * g->n; k++) g->x[k] = uniform(seed, -6.0, 6.0);
  for (int sweep = 0; sweep < 3000; sweep++) {
    for (int k = 0; k < 3 * g->n && sweep < 2000; k++) g->x[k] *= 0.998;
    for (int i = 0; i < g->n; i++)
      for (int j = 0; j < i; j++) {
        double *xi = g->x + 3 * i, *xj = g->x + 3 * j, r[3];
        const double small = fmin(g->a[i], g->a[j]), apart = g->a[i] + g->a[j] - pressed * small;
        sd_minus(xi, xj, r);
        const double d = sqrt(sd_dot(r, r)), over = 0.5 * (apart - d);
        if (over <= 0.0) continue;
        for (int e = 0; e < 3; e++) {
          xi[e] += over * r[e] / d;
          xj[e] -= over * r[e] / d;
        }
      }
  }
}

/* SD_OK: it is; SD_ESINGULAR: a pivot is not positive */
static sd_status factor(const group *g, const sd_multiblob *models)
{
  size_t N = 0, at = 0;
  for (int i = 0; i < g->n; i++) N += 3 * (size_t) points[g->kind[i]];
  double *M = malloc(sizeof(double) * (N * N + 3 * N)), *x = M + N * N, *r = x + N, *b = r + N;
  assert_non_null(M);
  for (int i = 0; i < g->n; i++) {
    const sd_multiblob *m = models + g->kind[i];
    for (int k = 0; k < 3 * m->n; k++, at++) {
      r[at] = g->a[i] * m->r[k];
      x[at] = g->x[3 * i + k % 3] + r[at];
      b[at / 3] = g->a[i] * m->point;
    }
  }
  sd_wall_matrix(NULL, (int) N / 3, 3, x, b, M);
  at = 0;
  for (int i = 0; i < g->n; i++) {
    const sd_multiblob *m = models + g->kind[i];
    sd_multiblob_one_body_matrix(m, g->a[i], r + at, N, M + at * (N + 1));
    at += 3 * (size_t) m->n;
  }
  const sd_status status = sd_cholesky((int) N, M);
  free(M);
  return status;
}

static double overlap_of(const group *g)
{
  double most = 0.0;
  for (int i = 0; i < g->n; i++)
    for (int j = 0; j < i; j++) {
      const double d = sqrt(sd_distance_squared(g->x + 3 * i, g->x + 3 * j));
      most = fmax(most, (g->a[i] + g->a[j] - d) / fmin(g->a[i], g->a[j]));
    }
  return most;
}

/* Groups pressed by 10 % of the smaller radius; SD_DEFINITE_SCENES=1000 in the environment: so many. */
static void pressed_groups(void **state)
{
  (void) state;
  const char *many = getenv("SD_DEFINITE_SCENES");
  const int scenes = many ? atoi(many) : 25;
  sd_multiblob *models = malloc(sizeof(sd_multiblob) * CLASSES);
  assert_int_equal(sd_multiblob_create(points[0], 1, models), SD_OK);
  for (int c = 1; c < CLASSES; c++)
    assert_int_equal(sd_multiblob_create_half(points[c], 1, models + c), SD_OK);
  uint64_t seed = 20;
  double overlap = 0.0;
  for (int k = 0; k < scenes; k++) {
    group g = some_spheres(k % 10 == 9, &seed);
    press(&g, 0.1, &seed);
    overlap = fmax(overlap, overlap_of(&g));
    assert_int_equal(factor(&g, models), SD_OK);
  }
  print_message("%d groups, largest overlap %.2f of the smaller radius\n", scenes, overlap);
  assert_true(overlap > 0.09);
  free(models);
}

/* What would fail does: with a third constant three times as large most of these groups are not definite. */
static void too_strong_an_addition_is_found(void **state)
{
  (void) state;
  sd_multiblob *models = malloc(sizeof(sd_multiblob) * CLASSES);
  assert_int_equal(sd_multiblob_create(points[0], 1, models), SD_OK);
  for (int c = 1; c < CLASSES; c++)
    assert_int_equal(sd_multiblob_create_half(points[c], 1, models + c), SD_OK);
  for (int c = 0; c < CLASSES; c++) models[c].delta *= 3.0;
  uint64_t seed = 20;
  int found = 0;
  for (int k = 0; k < 8; k++) {
    group g = some_spheres(k % 10 == 9, &seed);
    press(&g, 0.1, &seed);
    found += factor(&g, models) == SD_ESINGULAR;
  }
  assert_true(found > 4);
  free(models);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pressed_groups),
      cmocka_unit_test(too_strong_an_addition_is_found),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
