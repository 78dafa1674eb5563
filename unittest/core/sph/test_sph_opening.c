/* Open ends: hydrographs, and the flow through a section. */
#include "sd_sph_opening.h"

#include "check.h"

static void a_hydrograph_is_linear_between_its_rows_and_constant_beyond(void **state)
{
  (void) state;
  const double t[4] = {1.0, 2.5, 3.0, 7.0}, q[4] = {0.2, 0.8, 0.3, 0.1};
  CHECK_NEAR(sd_sph_hydrograph(4, t, q, -5.0), 0.2, 0.0);
  CHECK_NEAR(sd_sph_hydrograph(4, t, q, 9.0), 0.1, 0.0);
  for (int k = 0; k < 4; k++) CHECK_NEAR(sd_sph_hydrograph(4, t, q, t[k]), q[k], 1e-15);
  for (int k = 0; k < 3; k++)
    CHECK_NEAR(sd_sph_hydrograph(4, t, q, 0.3 * t[k] + 0.7 * t[k + 1]), 0.3 * q[k] + 0.7 * q[k + 1], 1e-15);
  CHECK_NEAR(sd_sph_hydrograph(1, t, q, 4.0), 0.2, 0.0);
}

static const sd_sph_section THREE_D = {{5, 4}, {-0.3, 0.2}, {0.1, 0.15}}, FLAT = {{5, 1}, {-0.3, 0.0}, {0.1, 1.0}};

/* With a particle at every node, of any mass. */
static void a_linear_profile_comes_back(void **state)
{
  (void) state;
  uint64_t seed = 12;
  const sd_sph_section *both[] = {&THREE_D, &FLAT};
  for (int s = 0; s < 2; s++) {
    double sums[2 * 20] = {0};
    for (int k = 0; k < both[s]->n[0]; k++)
      for (int l = 0; l < both[s]->n[1]; l++) {
        const double at[2] = {both[s]->lo[0] + 0.1 * k, both[s]->lo[1] + 0.15 * l};
        sd_sph_section_add(both[s], at, uniform(&seed, 0.5, 2.0), 0.7 + 2.0 * at[0] - (s ? 0.0 : 3.0 * at[1]), sums);
      }
    for (int k = 0; k < 50; k++) {
      const double at[2] = {uniform(&seed, -0.3, 0.1), uniform(&seed, 0.2, 0.65)};
      CHECK_NEAR(sd_sph_section_speed(both[s], at, sums, 99.0), 0.7 + 2.0 * at[0] - (s ? 0.0 : 3.0 * at[1]), 1e-13);
    }
  }
}

/* Mass and momentum of all nodes are those of the particles, inside and outside. */
static void nodes_share_all_of_a_particle(void **state)
{
  (void) state;
  uint64_t seed = 5;
  double sums[2 * 20] = {0}, mass = 0.0, momentum = 0.0;
  for (int k = 0; k < 30; k++) {
    const double at[2] = {uniform(&seed, -0.6, 0.5), uniform(&seed, 0.0, 1.0)}, m = uniform(&seed, 0.5, 2.0),
                 v = uniform(&seed, -1.0, 1.0);
    sd_sph_section_add(&THREE_D, at, m, v, sums);
    mass += m;
    momentum += m * v;
  }
  for (int k = 0; k < 20; k++) {
    mass -= sums[2 * k];
    momentum -= sums[2 * k + 1];
  }
  CHECK_NEAR(mass, 0.0, 1e-12);
  CHECK_NEAR(momentum, 0.0, 1e-12);
}

/* Of a particle at a node: all of it there, a quarter in the middle of the cell, nothing a step away. */
static void mass_is_linear_between_nodes(void **state)
{
  (void) state;
  double sums[2 * 20] = {0};
  const double node[2] = {-0.2, 0.35}, middle[2] = {-0.15, 0.425}, away[2] = {-0.1, 0.35};
  sd_sph_section_add(&THREE_D, node, 0.8, 0.4, sums);
  CHECK_NEAR(sd_sph_section_mass(&THREE_D, node, sums), 0.8, 1e-14);
  CHECK_NEAR(sd_sph_section_mass(&THREE_D, middle, sums), 0.2, 1e-14);
  CHECK_NEAR(sd_sph_section_mass(&THREE_D, away, sums), 0.0, 1e-14);
}

static void where_nothing_flows_the_speed_is_the_one_asked_for(void **state)
{
  (void) state;
  double sums[2 * 20] = {0};
  const double here[2] = {-0.3, 0.2}, there[2] = {0.1, 0.65};
  sd_sph_section_add(&THREE_D, here, 1.0, 0.4, sums);
  CHECK_NEAR(sd_sph_section_speed(&THREE_D, here, sums, 99.0), 0.4, 1e-15);
  CHECK_NEAR(sd_sph_section_speed(&THREE_D, there, sums, 99.0), 99.0, 0.0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_hydrograph_is_linear_between_its_rows_and_constant_beyond),
      cmocka_unit_test(a_linear_profile_comes_back),
      cmocka_unit_test(nodes_share_all_of_a_particle),
      cmocka_unit_test(mass_is_linear_between_nodes),
      cmocka_unit_test(where_nothing_flows_the_speed_is_the_one_asked_for),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
