#include "scene.h"

#include "sd_cells.h"

#include <string.h>

/* Every pair within the cut-off once, against the double loop: a cube, a needle, a sheet, all at one point; ghosts are
   sources only. */
static void cells_find_what_the_double_loop_finds(void **state)
{
  (void) state;
  enum { N = 300, TARGETS = 220 };
  static int seen[TARGETS][N];
  const double sides[][3] = {
      {10, 10, 10}, {4000, 0.1, 0.1}, {50, 50, 0}, {0, 0, 0}, {1e-5, 1e-5, 1e-5}};
  for (size_t k = 0; k < sizeof(sides) / sizeof(sides[0]); k++)
    for (double cutoff = 0.5; cutoff < 40.0; cutoff *= 4.0) {
      uint64_t seed = k + 1;
      double x[3 * N];
      for (int i = 0; i < 3 * N; i++) x[i] = uniform(&seed, -0.5, 0.5) * sides[k][i % 3];
      sd_neighbors list = {0};
      assert_int_equal(sd_neighbors_cutoff(&list, x, TARGETS, N, cutoff), SD_OK);
      memset(seen, 0, sizeof(seen));
      for (int i = 0; i < TARGETS; i++)
        for (long m = list.first[i]; m < list.first[i + 1]; m++) seen[i][list.neighbor[m]]++;
      for (int i = 0; i < TARGETS; i++)
        for (int j = 0; j < N; j++) {
          const double dx = x[3 * i] - x[3 * j], dy = x[3 * i + 1] - x[3 * j + 1],
                       dz = x[3 * i + 2] - x[3 * j + 2];
          assert_int_equal(seen[i][j], i != j && dx * dx + dy * dy + dz * dz <= cutoff * cutoff);
        }
      sd_neighbors_free(&list);
    }
}

/* Points come one by one, and a ball of any radius finds all that it holds, each once: also where cells are 2e7 sides
 * away from the corner that they are counted from, and where their numbers are negative. */
static void cells_give_all_of_a_ball(void **state)
{
  (void) state;
  enum { N = 400 };
  uint64_t seed = 8;
  double x[3 * N];
  for (int i = 0; i < 3 * N; i++) x[i] = uniform(&seed, -3, 3) + (i < 600 ? 0.0 : 1e7);
  sd_cells c = {0};
  assert_int_equal(sd_cells_create(&c, N), SD_OK);
  for (double radius = 0.2; radius < 4.0; radius *= 2.3) {
    sd_cells_clear(&c, (double[3]){0.3, -0.1, 0.2}, 0.43);
    for (int n = 0; n < N; n++) {
      int seen[N] = {0};
      for (sd_cells_walk w = sd_cells_near(&c, x + 3 * n, radius); sd_cells_step(&c, &w);)
        for (int j = w.first; j >= 0; j = c.next[j]) seen[j]++;
      for (int j = 0; j < N; j++) {
        const double d[3] = {x[3 * n] - x[3 * j], x[3 * n + 1] - x[3 * j + 1],
                             x[3 * n + 2] - x[3 * j + 2]};
        const int inside = d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <= radius * radius;
        assert_in_range(seen[j], j < n && inside, j < n);
      }
      sd_cells_add(&c, x, n);
    }
  }
  sd_cells_free(&c);
}

static void no_spheres_no_pairs(void **state)
{
  (void) state;
  const double x[3] = {0, 0, 0};
  int order[1];
  sd_neighbors list = {0};
  assert_int_equal(sd_neighbors_cutoff(&list, x, 0, 0, 1.0), SD_OK);
  assert_int_equal(list.first[0], 0);
  assert_int_equal(sd_neighbors_clump(&list, &(sd_named){x, NULL, NULL}, 0, 0, INFINITY, order), SD_OK);
  assert_int_equal(list.first[0], 0);
  sd_neighbors_free(&list);
}

/* Three molecules, one of them 0; sphere 12 has two images, of which each target takes the closer. */
static void clump_members_once_as_the_closest_image(void **state)
{
  (void) state;
  const double x[] = {0,        0, 0, /**/ 1,  0, 0, /**/ 9,  0, 0, /**/ 5,  0, 0,
                      /**/ 5.5, 0, 0, /**/ -1, 0, 0, /**/ 19, 0, 0, /**/ 10, 0, 0};
  const int64_t tag[] = {10, 11, 12, 20, 21, 12, 12, 10}, molecule[] = {7, 7, 7, 0, 0, 7, 7, 7};
  const sd_named s = {x, tag, molecule};
  const int n = 3 + 2, n_all = 8;
  int order[8];
  sd_neighbors list = {0};
  assert_int_equal(sd_neighbors_clump(&list, &s, n, n_all, INFINITY, order), SD_OK);
  const int rows[5][2] = {{1, 5}, {0, 5}, {7, 1}, {-1, -1}, {-1, -1}};
  for (int i = 0; i < 5; i++) {
    assert_int_equal(list.first[i + 1] - list.first[i], rows[i][0] < 0 ? 0 : 2);
    for (int k = 0; rows[i][0] >= 0 && k < 2; k++)
      assert_int_equal(list.neighbor[list.first[i] + k], rows[i][k]);
  }
  /* with a cut-off only the partners within it */
  assert_int_equal(sd_neighbors_clump(&list, &s, n, n_all, 1.5, order), SD_OK);
  assert_int_equal(list.first[1], 2);
  assert_int_equal(list.first[2] - list.first[1], 1);
  assert_int_equal(list.first[3] - list.first[2], 1);
  sd_neighbors_free(&list);
}

/* 3 sqrt(ai aj)/(2R) of the closest pair, of all pairs, of a share of the rows and by list; a taper takes its part;
 * radius 0: nobody. */
static void oseen_coupling_of_the_closest_pair(void **state)
{
  (void) state;
  const double x[] = {0, 0, 0, /**/ 0, 3, 4, /**/ 12, 3, 4, /**/ 0.1, 0, 0}, w[] = {1, 2, 3, 4};
  double a[] = {0.7, 2.8, 0.3, 0.0}, q;
  const sd_spheres s = {x, a, w};
  sd_law law = {.tensor = SD_TENSOR_OSEEN, .taper = SD_TAPER_NONE, .range = INFINITY};
  assert_int_equal(sd_oseen_coupling(&law, &s, NULL, 0, 0, 0, &q), SD_OK);
  assert_true(q == 0.0);
  sd_oseen_coupling(&law, &s, NULL, 4, 0, 4, &q);
  CHECK_NEAR(q, 1.5 * 1.4 / 5.0, 1e-15);
  law.range = 4.9;
  sd_oseen_coupling(&law, &s, NULL, 4, 0, 4, &q);
  assert_true(q < 0.3);
  sd_neighbors list = {0};
  law.range = 6.0;
  assert_int_equal(sd_neighbors_cutoff(&list, x, 4, 4, 6.0), SD_OK);
  sd_oseen_coupling(&law, &s, &list.pairs, 4, 0, 4, &q);
  CHECK_NEAR(q, 1.5 * 1.4 / 5.0, 1e-15);
  law.taper = SD_TAPER_SPHERICAL;
  law.range = 10.0;
  sd_oseen_coupling(&law, &s, &list.pairs, 4, 0, 4, &q);
  CHECK_NEAR(q, (1 - 0.75 + 0.0625) * 0.42, 1e-15);
  a[3] = 0.2;
  law.taper = SD_TAPER_NONE;
  law.range = INFINITY;
  double shares[2];
  for (int k = 0; k < 2; k++) sd_oseen_coupling(&law, &s, NULL, 4, 2 * k, 2, &shares[k]);
  CHECK_NEAR(fmax(shares[0], shares[1]), 1.5 * sqrt(0.14) / 0.1, 1e-14);
  sd_neighbors_free(&list);
}

/* Whatever is close enough to make the matrix indefinite is found, as by the double loop: radii 1:100, rows in three
   shares. */
static void oseen_coupling_finds_every_close_pair(void **state)
{
  (void) state;
  enum { N = 200 };
  const sd_law law = {.tensor = SD_TENSOR_OSEEN, .taper = SD_TAPER_NONE, .range = INFINITY};
  double x[3 * N], a[N], w[N];
  int close = 0;
  for (int scene = 0; scene < 100; scene++) {
    uint64_t seed = scene + 1;
    double expected = 0.0, found = 0.0;
    for (int i = 0; i < N; i++) {
      a[i] = pow(100.0, uniform(&seed, -0.5, 0.5));
      w[i] = 1.0;
      for (int d = 0; d < 3; d++) x[3 * i + d] = uniform(&seed, -100.0, 100.0);
      for (int j = 0; j < i; j++)
        expected = fmax(expected,
                        1.5 * sqrt(a[i] * a[j]) /
                            sqrt(pow(x[3 * i] - x[3 * j], 2) + pow(x[3 * i + 1] - x[3 * j + 1], 2) +
                                 pow(x[3 * i + 2] - x[3 * j + 2], 2)));
    }
    const sd_spheres s = {x, a, w};
    for (int k = 0; k < 3; k++) {
      double q;
      assert_int_equal(sd_oseen_coupling(&law, &s, NULL, N, 67 * k, k < 2 ? 67 : N - 134, &q),
                       SD_OK);
      found = fmax(found, q);
    }
    close += expected >= 1.0;
    if (expected >= 1.0)
      CHECK_NEAR(found, expected, 1e-13 * expected);
    else
      assert_true(found <= expected * (1 + 1e-13));
  }
  assert_in_range(close, 10, 90);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(cells_find_what_the_double_loop_finds),
      cmocka_unit_test(cells_give_all_of_a_ball),
      cmocka_unit_test(no_spheres_no_pairs),
      cmocka_unit_test(clump_members_once_as_the_closest_image),
      cmocka_unit_test(oseen_coupling_of_the_closest_pair),
      cmocka_unit_test(oseen_coupling_finds_every_close_pair),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
