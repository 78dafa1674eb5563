#include "scene.h"

#include "sd_linear.h"
#include "sd_neighbor.h"

#include <string.h>

enum { N = 500 };

typedef int table_of_pairs[N][N];

/* How often the row of each of the n targets names each sphere */
static void count(const sd_neighbors *list, int n, table_of_pairs seen)
{
  assert_int_equal(list->pairs.n, n);
  memset(seen, 0, sizeof(table_of_pairs));
  for (int t = 0; t < n; t++)
    for (long m = list->pairs.first[t]; m < list->pairs.first[t + 1]; m++)
      seen[t][list->pairs.neighbor[m]]++;
}

/* Against the double loop: radii 1:1 to 1:300, some take no part, some at one point; targets are all or a part. */
static void close_pairs_are_those_of_the_double_loop(void **state)
{
  (void) state;
  static table_of_pairs seen;
  const double spread[] = {1.0, 3.0, 300.0}, reach = 2.0 + 1.7;
  for (size_t k = 0; k < sizeof(spread) / sizeof(spread[0]); k++)
    for (int n = N; n > 0; n -= 370) {
      uint64_t seed = 5 + k;
      scene s = scene_create(N);
      for (int i = 0; i < N; i++)
        scene_set(&s, i, uniform(&seed, -9, 9), uniform(&seed, -9, 9), uniform(&seed, -9, 9),
                  i % 17 == 3 ? 0.0 : 0.9 * exp(uniform(&seed, -log(spread[k]), 0.0)), 1.3);
      for (int d = 0; d < 3; d++) s.x[3 * 200 + d] = s.x[3 * 30 + d];
      const sd_spheres spheres = {s.x, s.a, s.w};
      sd_neighbors list = {0};
      assert_int_equal(sd_near_once(&list, &spheres, n, N, reach), SD_OK);
      count(&list, n, seen);
      for (int i = 0; i < n; i++)
        for (int j = 0; j < N; j++) {
          double sq = 0.0;
          for (int d = 0; d < 3; d++) sq += pow(s.x[3 * i + d] - s.x[3 * j + d], 2);
          assert_int_equal(seen[i][j],
                           i < j && s.a[i] > 0.0 && s.a[j] > 0.0 &&
                               sq <= pow(0.5 * reach * (s.a[i] + s.a[j]), 2));
        }
      sd_neighbors_free(&list);
      scene_free(&s);
    }
}

/* The pairs of a list that are within reach, against the double loop */
static void check_kept(const sd_near *near, const scene *s, int n, double reach)
{
  static table_of_pairs seen;
  count(&near->list, n, seen);
  for (int i = 0; i < n; i++)
    for (int j = i + 1; j < N; j++) {
      const double limit = 0.5 * reach * (s->a[i] + s->a[j]);
      const double square = sd_distance_squared(s->x + 3 * i, s->x + 3 * j);
      if (s->a[i] > 0.0 && s->a[j] > 0.0 && square <= limit * limit) assert_int_equal(seen[i][j], 1);
    }
}

/* Over small steps a list holds, as where spheres stood at its making says; it is made anew when one goes far, grows,
 * or is nowhere, and when the reach grows: no close pair is missing, whatever its age. */
static void a_list_of_any_age_has_all_close_pairs(void **state)
{
  (void) state;
  const double reach = 4.0;
  uint64_t seed = 8;
  int made_anew = 0;
  scene s = scene_create(N);
  for (int i = 0; i < N; i++)
    scene_set(&s, i, uniform(&seed, -9, 9), uniform(&seed, -9, 9), uniform(&seed, -9, 9),
              i % 17 == 3 ? 0.0 : uniform(&seed, 0.6, 1.0), 1.3);
  const sd_spheres spheres = {s.x, s.a, s.w};
  sd_near near = {0};
  static double velocity[3 * N];
  for (int i = 0; i < 3 * N; i++) velocity[i] = uniform(&seed, -0.04, 0.04);
  for (int step = 0; step < 40; step++) {
    const double stood = near.stood ? near.stood[0] : 0.0;
    for (int i = 0; i < 3 * N && step != 30; i++) s.x[i] += velocity[i];
    if (step == 20) s.x[3 * 77] += 5.0;
    if (step == 30) s.a[200] *= 2.0; /* and nobody moves */
    const double wide = step < 35 ? reach : 1.3 * reach;
    assert_int_equal(sd_near_keep(&near, &spheres, N - 70, N, wide), SD_OK);
    check_kept(&near, &s, N - 70, wide);
    made_anew += near.stood[0] != stood;
  }
  assert_in_range(made_anew, 4, 20);
  s.x[5] = NAN;
  assert_int_equal(sd_near_keep(&near, &spheres, N - 70, N, reach), SD_OK);
  assert_true(isnan(near.stood[4 * 1 + 2]));
  sd_near_free(&near);
  scene_free(&s);
}

/* Two at the very reach, one by a hair on the other side of the origin, where a cell may begin: so
 * near 0 their distance is rounded to the reach. */
static void none_is_lost_between_cells(void **state)
{
  (void) state;
  for (double a = 0.3; a < 2.0; a += 0.1) {
    const double x[6] = {-1e-20, 0.0, 0.0, 2.0 * a, 0.0, 0.0}, radius[2] = {a, a}, w[2] = {1.3, 1.3};
    const sd_spheres s = {x, radius, w};
    sd_neighbors list = {0};
    assert_int_equal(sd_near_once(&list, &s, 2, 2, 2.0), SD_OK);
    assert_int_equal(list.pairs.first[2], 1);
    sd_neighbors_free(&list);
  }
}

static void nobody_is_close_to_nobody(void **state)
{
  (void) state;
  const double x[3] = {1, 2, 3}, a[1] = {0.0}, w[1] = {1.0};
  const sd_spheres s = {x, a, w};
  sd_neighbors list = {0};
  for (int n = 0; n < 2; n++) {
    assert_int_equal(sd_near_once(&list, &s, n, n, 4.0), SD_OK);
    assert_int_equal(list.pairs.first[n], 0);
  }
  sd_neighbors_free(&list);
}

/* A small one that has flown off, or is nowhere, is close to nobody, and the search among the large ones ends. */
static void one_that_is_far_off_is_close_to_nobody(void **state)
{
  (void) state;
  const double far[] = {-1e30, 1e30, -INFINITY, INFINITY, NAN}, a[4] = {0.1, 1.0, 1.0, 0.1}, w[4] = {1, 1, 1, 1};
  for (int k = 0; k < 15; k++) {
    double x[12] = {0.0, 0.0, 0.0, 0.1, 0.2, 0.3, 2.2, 0.2, 0.3, 1.2, 0.2, 0.3};
    const sd_spheres s = {x, a, w};
    sd_neighbors list = {0};
    x[k % 3] = far[k / 3];
    assert_int_equal(sd_near_once(&list, &s, 4, 4, 2.5), SD_OK);
    assert_int_equal(list.pairs.first[1], 0);
    assert_int_equal(list.pairs.first[4], 3);
    sd_neighbors_free(&list);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(close_pairs_are_those_of_the_double_loop),
      cmocka_unit_test(a_list_of_any_age_has_all_close_pairs),
      cmocka_unit_test(none_is_lost_between_cells),
      cmocka_unit_test(nobody_is_close_to_nobody),
      cmocka_unit_test(one_that_is_far_off_is_close_to_nobody),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
