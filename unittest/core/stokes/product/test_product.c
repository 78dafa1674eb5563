#include "scene.h"

enum { N = 40 };

static scene random_scene(uint64_t seed, double side)
{
  scene s = scene_create(N);
  for (int i = 0; i < N; i++)
    scene_set(&s, i, uniform(&seed, 0, side), uniform(&seed, 0, side), uniform(&seed, 0, side),
              uniform(&seed, 0.2, 1.6), uniform(&seed, 0.5, 3.0));
  return s;
}

static void only_pairs_up_to_the_cutoff_are_kept(void **state)
{
  (void) state;
  scene s = random_scene(3, 6.0);
  s.a[4] = s.a[9] = 0.0; /* take no part */
  const sd_spheres spheres = {s.x, s.a, s.w};
  const double cutoff = 2.2;
  sd_neighbors wide = {0};
  assert_int_equal(sd_neighbors_cutoff(&wide, s.x, N, N, 3.0), SD_OK);
  long first[N + 1];
  int neighbor[N * N], seen[N][N] = {{0}};
  sd_pairs_within(&wide.pairs, &spheres, cutoff, first, neighbor);
  for (int i = 0; i < N; i++)
    for (long k = first[i]; k < first[i + 1]; k++) seen[i][neighbor[k]]++;
  for (int i = 0; i < N; i++)
    for (int j = 0; j < N; j++) {
      double rsq = 0.0;
      for (int d = 0; d < 3; d++) rsq += pow(s.x[3 * i + d] - s.x[3 * j + d], 2);
      const int expected = i != j && i != 4 && i != 9 && j != 4 && j != 9 && rsq <= cutoff * cutoff;
      assert_int_equal(seen[i][j], expected);
    }
  sd_neighbors_free(&wide);
  scene_free(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(only_pairs_up_to_the_cutoff_are_kept),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
