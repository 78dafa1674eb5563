/* Bodies of fluid: which particles are one drop, and the momentum that each keeps. */
#include "sd_sph_drops.h"

#include "surface_drop.h"

static int find_drops(drop *s, double reach, int *parent)
{
  sd_cells cells = {0};
  assert_int_equal(sd_cells_create(&cells, s->n), SD_OK);
  const int trees = sd_sph_find_drops(&s->film, reach, &cells, parent);
  sd_cells_free(&cells);
  return trees;
}

/* Two drops, one of which is held. What is on one rank here stands for two: the second one sees the names of the
 * first as those of ghosts. */
static void a_free_drop_keeps_its_momentum_and_a_held_one_is_left_alone(void **state)
{
  (void) state;
  uint64_t seed = 8;
  drop *s = begin(2, 0.2);
  disk(s, 0.6, 0.1, 0.0, 0.0);
  const int first = s->n;
  disk(s, 0.4, 0.1, 1.5, 0.0);
  find_neighbours(s, 0);
  int parent[MOST], of[MOST];
  char held[MOST];
  double name[MOST], F[3 * MOST], sum[3];
  sd_sph_drop mine[MOST], everywhere[2 * MOST];
  for (int i = 0; i < s->n; i++) {
    name[i] = (i * 37) % 1009 + 1.0;
    s->x4[4 * i + 3] = uniform(&seed, 1.0, 2.0) * (i % 3 ? 1.0 : -1.0);
    held[i] = i == first + 3;
    for (int d = 0; d < 3; d++) F[3 * i + d] = s->F[3 * i + d] = uniform(&seed, -1.0, 1.0);
  }
  assert_int_equal(find_drops(s, 0.4, parent), 2);
  assert_true(sd_sph_name_drops(s->n, parent, name));
  assert_false(sd_sph_name_drops(s->n, parent, name));
  const int count = sd_sph_list_drops(&s->film, parent, name, of, mine);
  assert_int_equal(count, 2);
  for (int k = 0; k < 2; k++) sd_sph_sum_drops(&s->film, of, held, F, count, mine);    // the second step anew
  memcpy(everywhere, mine, sizeof(sd_sph_drop) * 2);
  assert_int_equal(sd_sph_join_drops(2, everywhere, sum), 2);
  sd_sph_find_excess(2, everywhere, count, mine);
  sd_sph_keep_momentum(&s->film, of, mine, F);
  double free_sum[3] = {0.0}, held_sum[3] = {0.0};
  for (int i = 0; i < s->n; i++)
    for (int d = 0; d < 3; d++) {
      if (i < first) free_sum[d] += F[3 * i + d];
      else held_sum[d] += F[3 * i + d];
      if (i >= first) CHECK_NEAR(F[3 * i + d], s->F[3 * i + d], 0.0);
      /* the same acceleration for all */
      if (i < first)
        CHECK_NEAR((F[3 * i + d] - s->F[3 * i + d]) / fabs(s->x4[4 * i + 3]), (F[d] - s->F[d]) / fabs(s->x4[3]), 1e-13);
    }
  for (int d = 0; d < 3; d++) {
    CHECK_NEAR(free_sum[d], 0.0, 1e-12);
    CHECK_NEAR(sum[d], held_sum[d], 1e-12);
  }
}

/* Random points, where many gaps are near 2 h: as if every pair had been asked. */
static void drops_are_those_of_all_pairs(void **state)
{
  (void) state;
  for (int dimension = 2; dimension <= 3; dimension++) {
    uint64_t seed = 5;
    static int parent[MOST], name[MOST];
    drop *s = begin(dimension, 0.2);
    for (int i = 0; i < (dimension == 3 ? 350 : 150); i++)
      add(s, uniform(&seed, -3.0, 3.0), uniform(&seed, -3.0, 3.0), dimension == 3 ? uniform(&seed, -0.6, 0.6) : 0.0,
          0.01, i % 50 == 7);
    s->film = (sd_sph_film){&s->plane, NULL, s->n, s->x4, s->wall, NULL, 0};
    const int trees = find_drops(s, 0.4, parent);
    for (int i = 0; i < s->n; i++) name[i] = i;
    for (int changed = 1; changed;) {
      changed = 0;
      for (int i = 0; i < s->n; i++)
        for (int j = 0; j < i; j++)
          if (!s->wall[i] && !s->wall[j] && name[i] != name[j] && distance(s, i, j) < 0.4) {
            name[i] = name[j] = name[i] < name[j] ? name[i] : name[j];
            changed = 1;
          }
    }
    int drops = 0;
    for (int i = 0; i < s->n; i++) {
      while (parent[parent[i]] != parent[i]) parent[i] = parent[parent[i]];
      drops += !s->wall[i] && name[i] == i;
    }
    for (int i = 0; i < s->n; i++)
      for (int j = 0; j < i; j++) assert_int_equal(parent[i] == parent[j], name[i] == name[j]);
    assert_int_equal(drops, trees);
    assert_true(drops > 20 && drops < s->n / 2);
    assert_true(find_drops(s, 0.36, parent) > trees && find_drops(s, 0.44, parent) < trees);
  }
}

/* Two parts of one drop, of one name, are added before the force is given back. */
static void parts_of_a_drop_on_two_ranks_are_one(void **state)
{
  (void) state;
  drop *s = begin(2, 0.2);
  disk(s, 0.5, 0.1, 0.0, 0.0);
  find_neighbours(s, 0);
  int parent[MOST], of[MOST];
  double name[MOST], F[3 * MOST] = {0.0}, sum[3], total = 0.0, V = 0.0;
  sd_sph_drop mine[MOST], everywhere[2];
  for (int i = 0; i < s->n; i++) {
    name[i] = 5.0;
    V += s->x4[4 * i + 3];
    F[3 * i] = 1.0;
  }
  assert_int_equal(find_drops(s, 0.4, parent), 1);
  const int count = sd_sph_list_drops(&s->film, parent, name, of, mine);
  assert_int_equal(count, 1);
  CHECK_NEAR(mine[0].V, V, 1e-12);
  sd_sph_sum_drops(&s->film, of, NULL, F, count, mine);
  everywhere[0] = (sd_sph_drop){5.0, 3.0, {-1.0 * s->n, 0.0, 0.0}, 0.0};
  everywhere[1] = mine[0];
  assert_int_equal(sd_sph_join_drops(2, everywhere, sum), 1);
  sd_sph_find_excess(1, everywhere, count, mine);
  sd_sph_keep_momentum(&s->film, of, mine, F);
  for (int i = 0; i < s->n; i++) total += F[3 * i];
  CHECK_NEAR(total, 1.0 * s->n, 1e-12);    // the two parts balance: nothing is given back
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_free_drop_keeps_its_momentum_and_a_held_one_is_left_alone),
      cmocka_unit_test(drops_are_those_of_all_pairs),
      cmocka_unit_test(parts_of_a_drop_on_two_ranks_are_one),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
