/* Points in order of cells; places that have no cell of their own. */
#include "check.h"

#include "sd_cells.h"

#include <string.h>

enum { N = 4096 };

/* How far apart points are that stand side by side, in the mean */
static double mean_step(const double *x, const int *order)
{
  double sum = 0.0;
  for (int k = 1; k < N; k++) {
    double square = 0.0;
    for (int d = 0; d < 3; d++) square += pow(x[3 * order[k] + d] - x[3 * order[k - 1] + d], 2.0);
    sum += sqrt(square) / (N - 1);
  }
  return sum;
}

/* Every point once; in a unit cube a cell of eight has an edge of 1/8, and along a row of cells the next point is less
 * than two of these away in the mean (0.66 at random) */
static void near_points_stand_side_by_side(void **state)
{
  (void) state;
  static double x[3 * N];
  static int order[N], found[N];
  uint64_t seed = 5;
  for (int j = 0; j < 3 * N; j++) x[j] = uniform(&seed, 2.0, 3.0);
  assert_int_equal(sd_cells_sort(x, N, order), SD_OK);
  for (int k = 0; k < N; k++) found[order[k]]++;
  for (int i = 0; i < N; i++) assert_int_equal(found[i], 1);
  assert_true(mean_step(x, order) < 0.16);
  for (int k = 1; k < N; k++) assert_true(x[3 * order[k]] > x[3 * order[k - 1]] - 0.145);
}

/* On a line, at one point, with a place that is no number, and none at all */
static void any_points_are_sorted(void **state)
{
  (void) state;
  double x[3 * 5] = {0.0};
  int order[5];
  const double line[5] = {4.0, 0.5, 3.0, 0.5, 1e300};
  assert_int_equal(sd_cells_sort(x, 0, order), SD_OK);
  assert_int_equal(sd_cells_sort(x, 5, order), SD_OK);
  for (int k = 0; k < 5; k++) assert_int_equal(order[k], k);
  for (int k = 0; k < 5; k++) x[3 * k] = line[k];
  assert_int_equal(sd_cells_sort(x, 5, order), SD_OK);
  assert_int_equal(order[4], 4);
  x[0] = NAN, x[4] = INFINITY;
  assert_int_equal(sd_cells_sort(x, 5, order), SD_OK);
  int found = 0;
  for (int k = 0; k < 5; k++) found |= 1 << order[k];
  assert_int_equal(found, 31);
}

/* Places that are no numbers, or so far off that numbers do not tell cells: a walk around them is short, and passes
 * their cell. */
static void a_walk_ends_wherever_it_begins(void **state)
{
  (void) state;
  const double lo[3] = {0.0, 0.0, 0.0}, far[] = {-1e30, 1e30, -3e18, 3e18, 5e14, -INFINITY, INFINITY, NAN, 1.0};
  enum { PLACES = sizeof(far) / sizeof(far[0]) };
  double x[3 * PLACES];
  sd_cells c = {0};
  assert_int_equal(sd_cells_create(&c, PLACES), SD_OK);
  sd_cells_clear(&c, lo, 0.7);
  for (int i = 0; i < PLACES; i++) {
    for (int d = 0; d < 3; d++) x[3 * i + d] = d == i % 3 ? far[i] : 1.0;
    sd_cells_add(&c, x, i);
  }
  for (int i = 0; i < PLACES; i++) {
    int found = 0, steps = 0;
    sd_cells_walk w = sd_cells_near(&c, x + 3 * i, 0.5);
    for (int d = 0; d < 3; d++) assert_in_range(w.to[d] - w.from[d], 0, 15);
    for (; sd_cells_step(&c, &w) && steps < 100; steps++)
      for (int j = w.first; j >= 0; j = c.next[j]) found += j == i;
    assert_int_equal(found, 1);
    assert_in_range(steps, 1, 27);
  }
  sd_cells_free(&c);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(near_points_stand_side_by_side),
      cmocka_unit_test(any_points_are_sorted),
      cmocka_unit_test(a_walk_ends_wherever_it_begins),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
