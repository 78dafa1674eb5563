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

/* Block by block from sd_tensor_uf, with the viscosity of a pair sqrt(eta_i eta_j). */
static void products_are_sums_of_blocks(void **state)
{
  (void) state;
  for (int kind = SD_TENSOR_RPY; kind <= SD_TENSOR_OSEEN; kind++) {
    scene s = random_scene(1, 6.0);
    s.kind = kind;
    uint64_t seed = 2;
    double F[3 * N], expected[3 * N] = {0}, all[3 * N], list[3 * N], scale = 0.0;
    for (int i = 0; i < 3 * N; i++) F[i] = uniform(&seed, -1, 1);
    for (int i = 0; i < N; i++)
      for (int j = 0; j < N; j++) {
        double r[3], M[9];
        if (j == i) continue;
        for (int d = 0; d < 3; d++) r[d] = s.x[3 * i + d] - s.x[3 * j + d];
        sd_tensor_uf(kind, r, s.a[i], s.a[j], 1.0 / (s.w[i] * s.w[j]), M);
        for (int p = 0; p < 3; p++)
          for (int q = 0; q < 3; q++) expected[3 * i + p] += M[3 * p + q] * F[3 * j + q];
      }
    for (int i = 0; i < 3 * N; i++) scale = fmax(scale, fabs(expected[i]));

    scene_apply(&s, F, all);
    s.cutoff = 100.0;
    scene_apply(&s, F, list);
    for (int i = 0; i < 3 * N; i++) {
      CHECK_NEAR(all[i], expected[i], 1e-14 * scale);
      CHECK_NEAR(list[i], expected[i], 1e-14 * scale);
    }
    scene_free(&s);
  }
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
      cmocka_unit_test(products_are_sums_of_blocks),
      cmocka_unit_test(only_pairs_up_to_the_cutoff_are_kept),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
