/* What walls do to the fluid before them, and what they know of it. */
#include "sd_sph_wall.h"
#include "sd_sph_internal.h"

#include "sph_scene.h"

/* What wall particles see of the fluid of a scene, [8 (N + 1)]. */
static void look_from_walls(scene *s, const double *spins, double *sums)
{
  double weights[8 * (N + 1)];
  sd_sph_pack_fluid(&s->p, s->P, weights);
  sd_sph_before_walls(&s->model, &s->list, &s->p, weights, spins, sums);
}

static const sd_sph_state WATER = {SD_SPH_RELATIV, 400.0, 1000.0, 0.0, 0.0, 0};
static const sd_sph_wall WALL = {&WATER, 0, 1};

/* A wall before a fluid at rest with hydrostatic pressure continues that pressure exactly. */
static void wall_continues_the_hydrostatic_pressure(void **state)
{
  (void) state;
  scene s;
  build(&s, SD_SPH_WENDLAND, 2, 1, 0, 0, 0);
  const double g[3] = {0.0, -9.81, 0.0};
  for (int i = 0; i < N; i++) {
    s.rho[i] = 1000.0;
    s.P[i] = 1000.0 * 9.81 * (2.0 - s.x[3 * i + 1]);
    s.phase[i] = s.x[3 * i + 1] < 0.4 ? -1 : 0;
  }
  sd_sph_pack_v(N, s.v, s.rho, s.v4);
  s.p.phase = s.phase;
  double sums[8 * (N + 1)] = {0};
  look_from_walls(&s, NULL, sums);
  int tried = 0;
  for (int i = 0; i < N; i++) {
    if (s.phase[i] == 0 || sums[8 * i] < 0.01) continue;
    double row[4];
    const double P = sd_sph_wall_particle(&WALL, sums + 8 * i, s.v + 3 * i, g, row);
    CHECK_NEAR(P, s.P[i], 1e-9 * s.P[i]);
    tried++;
  }
  assert_true(tried > 2);
}

/* Fluid that turns with its wall does not slip on it, at any depth of the wall particle. */
static void fluid_that_turns_with_its_wall_does_not_slip(void **state)
{
  (void) state;
  scene s;
  seed = 8; /* of a scene where six wall particles see fluid that sees enough of the wall */
  build(&s, SD_SPH_WENDLAND, 2, 1, 0, 0, 0);
  const double w = 0.7, b[3] = {0.0, 0.0, 0.0};
  for (int i = 0; i < N; i++) {
    s.rho[i] = 1000.0;
    s.v[3 * i] = 0.3 - w * s.x[3 * i + 1];
    s.v[3 * i + 1] = w * s.x[3 * i];
    s.v[3 * i + 2] = 0.0;
    s.phase[i] = s.x[3 * i + 1] < 0.5 ? -1 : 0;
  }
  sd_sph_pack_v(N, s.v, s.rho, s.v4);
  s.p.phase = s.phase;
  double motion[SD_SPH_MOTION * (N + 1)] = {0}, spins[4 * (N + 1)] = {0};
  double sums[8 * (N + 1)] = {0};
  sd_sph_motion_of_walls(&s.model, &s.list, &s.p, motion);
  for (int i = 0; i < N; i++) {
    double shear;
    if (s.phase[i] == 0) sd_sph_spin(motion + SD_SPH_MOTION * i, spins + 4 * i, &shear);
  }
  look_from_walls(&s, spins, sums);
  int tried = 0;
  for (int i = 0; i < N; i++) {
    if (s.phase[i] == 0 || sums[8 * i] < 0.01) continue;
    double row[4];
    int all = 1;
    for (int j = 0; j < N; j++)
      if (s.phase[j] == 0 && motion[SD_SPH_MOTION * j] < 6.0 &&
          hypot(s.x[3 * i] - s.x[3 * j], s.x[3 * i + 1] - s.x[3 * j + 1]) < s.pair[0].support)
        all = 0;
    if (!all) continue; /* one of the fluid sees too little of the wall */
    sd_sph_wall_particle(&WALL, sums + 8 * i, s.v + 3 * i, b, row);
    for (int c = 1; c < 4; c++) CHECK_NEAR(row[c], 0.0, 1e-12);
    tried++;
  }
  assert_true(tried > 2);
}

/* Friction sees the mirror image of the fluid's velocity without slip, that of the fluid with it;
 * the density is the one that has the pressure of the fluid. */
static void wall_particle_continues_the_fluid(void **state)
{
  (void) state;
  const sd_sph_state tait = {SD_SPH_TAIT, 5e4, 990.0, 7.0, 30.0, 0};
  const double sums[8] = {0.8, 0.8 * 2.1e3, 0.0, 0.8 * 100.0, 0.0, 0.8 * 0.3, 0.8 * -0.7, 0.0},
               v[3] = {0.1, 0.2, -0.3}, b[3] = {5.0, 3.0, 7.0};
  const sd_sph_wall sticks = {&tait, 0, 1}, slides = {&tait, 1, 1}, lets_go = {&tait, 0, 0};
  double row[4] = {1.0}, glides[4] = {1.0};
  sd_sph_wall_particle(&sticks, sums, v, b, row);
  sd_sph_wall_particle(&slides, sums, v, b, glides);
  CHECK_NEAR(sd_sph_pressure(&tait, row[0]), 2.4e3, 1e-8);
  for (int d = 0; d < 3; d++) {
    const double fluid = sums[5 + d] / sums[0];
    CHECK_NEAR(v[d] + glides[1 + d], fluid, 1e-15);
    CHECK_NEAR(v[d] + row[1 + d], 2 * v[d] - fluid, 1e-15);
  }
  const double none[8] = {0.0};
  sd_sph_wall_particle(&sticks, none, v, b, row);
  CHECK_NEAR(row[0], 990.0, 1e-9);
  assert_true(row[1] == 0.0 && row[2] == 0.0 && row[3] == 0.0);
  const double drawn[8] = {0.8, 0.8 * -2e3}, pressed[8] = {0.8, 0.8 * 2e3};
  CHECK_NEAR(sd_sph_wall_particle(&sticks, drawn, v, b, row), -2e3, 1e-9);
  CHECK_NEAR(sd_sph_wall_particle(&lets_go, drawn, v, b, row), 0.0, 1e-9);
  CHECK_NEAR(sd_sph_pressure(&tait, row[0]), 0.0, 1e-8);
  CHECK_NEAR(sd_sph_wall_particle(&lets_go, pressed, v, b, row), 2e3, 1e-9);
  const double torn[8] = {0.8, 0.8 * -5e4};
  sd_sph_wall_particle(&sticks, torn, v, b, row);
  assert_true(row[0] == 0.0);
  CHECK_NEAR(sd_sph_least_pressure(&tait), 30.0 - 5e4, 1e-9);
}

/* At rest, then uniformly accelerated: the mean follows within tau, and is exact then; dt only
 * resolves it. */
static void walls_know_their_acceleration(void **state)
{
  (void) state;
  const double g[3] = {0.3, -2.0, 0.0}, tau = 0.1;
  for (double dt = 0.02; dt > 0.004; dt /= 2) {
    double before[3] = {0.1, 0.0, 0.0}, a[3] = {0.0};
    double v[3] = {0.1, 0.0, 0.0};
    const int steps = (int) (tau / dt + 0.5);
    for (int k = 1; k <= 15 * steps; k++) {
      for (int d = 0; d < 3; d++) v[d] += dt * g[d];
      sd_sph_wall_acceleration(v, dt, tau, before, a);
      if (k == steps) CHECK_NEAR(a[1] / g[1], 1.0 - exp(-1.0), 2.0 * dt);
    }
    for (int d = 0; d < 3; d++) CHECK_NEAR(a[d], g[d], 1e-5);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(wall_continues_the_hydrostatic_pressure),
      cmocka_unit_test(fluid_that_turns_with_its_wall_does_not_slip),
      cmocka_unit_test(wall_particle_continues_the_fluid),
      cmocka_unit_test(walls_know_their_acceleration),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
