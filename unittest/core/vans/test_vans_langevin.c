/* The Langevin walk of grains in turbulent water: how far it spreads them, and where it leaves them. */
#include "check.h"

#include "sd_vans_random.h"

/* Even turbulence: <z^2> = 2 sigma^2 T (t - T (1 - exp(-t/T))), Taylor's formula, from the start to 2 sigma^2 T t; and
 * <u'x u'z> = -sigma^2 all the time. 6 % is four sampling errors of 10 000 grains. */
static void grains_spread_by_taylors_formula(void **state)
{
  (void) state;
  enum { GRAINS = 10000, STEPS = 100 };
  const double edge[3] = {0, 1e3, 2e3}, u_star[2] = {0.3, 0.3}, T = 2.5, dt = 0.1;
  const double life[2] = {T, T};
  const sd_vans_mesh mesh = {2, 0.0, 1e3, edge};
  double squares[2] = {0, 0}, stress = 0;
  for (int i = 0; i < GRAINS; i++) {
    sd_vans_wander wander = {{0, 0, 0}, 0};
    double z = 900.0, u[3];
    for (int k = 0; k < STEPS; k++) {
      const sd_vans_langevin walk = {42, 0.0, u_star, life, k ? dt : HUGE_VAL, 0};
      sd_vans_langevin_step(&mesh, &walk, z, i, &wander, u);
      z += u[2] * dt;
      if (k == 9) squares[0] += (z - 900.0) * (z - 900.0) / GRAINS;
    }
    squares[1] += (z - 900.0) * (z - 900.0) / GRAINS;
    stress += u[0] * u[2] / GRAINS;
    assert_true(wander.count == STEPS);
  }
  for (int k = 0; k < 2; k++) {
    const double t = k ? STEPS * dt : 10 * dt,
                 taylor = 2 * 0.09 * T * (t - T * (1 - exp(-t / T)));
    assert_true(fabs(squares[k] / taylor - 1.0) < 0.06);
  }
  assert_true(fabs(stress / -0.09 - 1.0) < 0.08);
}

/* Grains without weight, spread evenly between a bottom and a top that mirror them, stay so in turbulence that is three
 * times as strong at the top, with T that changes twentyfold. Without the slope of sigma in the walk the lowest tenth
 * gains 55 %. */
static void even_grains_stay_even_where_the_turbulence_is_not(void **state)
{
  (void) state;
  enum { N = 50, GRAINS = 5000, STEPS = 500, BINS = 10 };
  double edge[N + 1], u_star[N], life[N];
  int bins[BINS] = {0};
  for (int n = 0; n <= N; n++) edge[n] = (double) n / N;
  for (int n = 0; n < N; n++) {
    u_star[n] = 0.1 + 0.2 * (n + 0.5) / N;
    life[n] = 0.1 + 2.0 * (n + 0.5) / N;
  }
  const sd_vans_mesh mesh = {N, 0.0, 1.0 / N, edge};
  for (int i = 0; i < GRAINS; i++) {
    sd_vans_wander wander = {{0, 0, 0}, 0};
    double z = (i + 0.5) / GRAINS, u[3];
    for (int k = 0; k < STEPS; k++) {
      const sd_vans_langevin walk = {7, -1.0, u_star, life, k ? 0.02 : HUGE_VAL, 0};
      sd_vans_langevin_step(&mesh, &walk, z, i, &wander, u);
      z += u[2] * 0.02;
      if (z < 0.0 || z > 1.0) {
        z = z < 0.0 ? -z : 2.0 - z;
        for (int d = 0; d < 3; d++) wander.normal[d] = -wander.normal[d];
      }
    }
    bins[(int) (z * BINS)]++;
  }
  for (int b = 0; b < BINS; b++)
    assert_true(fabs(bins[b] * (double) BINS / GRAINS - 1.0) < 5 * sqrt((double) BINS / GRAINS));
}

/* Even turbulence from a bottom that mirrors up to the surface, whose water turns back by itself: grains without weight
 * stay evenly spread up to it, and those that pass it return within a few steps. */
static void light_grains_do_not_gather_at_the_surface(void **state)
{
  (void) state;
  enum { N = 21, WATER = 20, GRAINS = 5000, STEPS = 400, BINS = 10 };
  const double dt = 0.02;
  double edge[N + 1], u_star[N], life[N];
  int bins[BINS] = {0}, above = 0;
  for (int n = 0; n <= N; n++) edge[n] = (double) n / WATER;
  for (int n = 0; n < N; n++) {
    u_star[n] = n < WATER ? 0.2 : 0.0;
    life[n] = n < WATER ? 0.5 : 0.0;
  }
  const sd_vans_mesh mesh = {N, 0.0, 1.0 / WATER, edge};
  for (int i = 0; i < GRAINS; i++) {
    sd_vans_wander wander = {{0, 0, 0}, 0};
    double z = (i + 0.5) / GRAINS, u[3];
    for (int k = 0; k < STEPS; k++) {
      const sd_vans_langevin walk = {7, -1.0, u_star, life, k ? dt : HUGE_VAL, WATER};
      sd_vans_langevin_step(&mesh, &walk, z, i, &wander, u);
      z += u[2] * dt;
      if (z < 0.0) {
        z = -z;
        for (int d = 0; d < 3; d++) wander.normal[d] = -wander.normal[d];
      }
    }
    if (z < 1.0)
      bins[(int) (z * BINS)]++;
    else
      above++;
  }
  assert_true(above < GRAINS * 4 * 0.2 * dt);    /* sigma dt is how far they get */
  const double even = (double) (GRAINS - above) / BINS;
  for (int b = 0; b < BINS; b++) assert_true(fabs(bins[b] / even - 1.0) < 5 / sqrt(even));
}

/* D = sigma^2 T is the eddy viscosity over the Schmidt number. */
static void the_schmidt_number_is_that_of_the_spread(void **state)
{
  (void) state;
  const double edge[4] = {0, 1, 2, 3}, nut[3] = {2e-3, 0.0, 5e-4}, u_star[3] = {0.05, 0.0, 0.02};
  const sd_vans_mesh mesh = {3, 0.0, 1.0, edge};
  double life[3];
  sd_vans_lagrangian_times(&mesh, 0.44, nut, u_star, life);
  for (int n = 0; n < 3; n++)
    assert_true(fabs(u_star[n] * u_star[n] * life[n] - nut[n] / 0.44) < 1e-18);
}

/* Where the stream all but stands still, squares of u_star underflow: no number that is none comes of it. */
static void next_to_no_turbulence_is_finite(void **state)
{
  (void) state;
  const double edge[4] = {0, 1, 2, 3}, nut[3] = {1e-100, 1e-100, 1e200}, u_star[3] = {1e-200, 1e-300, 1e-150};
  const sd_vans_mesh mesh = {3, 0.0, 1.0, edge};
  double life[3], u[3];
  sd_vans_lagrangian_times(&mesh, 1.0, nut, u_star, life);
  const sd_vans_langevin walk = {42, -1.0, u_star, life, 0.1, 0};
  for (int n = 0; n < 3; n++) {
    sd_vans_wander wander = {{1, 1, 1}, 3};
    sd_vans_langevin_step(&mesh, &walk, n + 0.5, 5, &wander, u);
    assert_true(isfinite(life[n]) && isfinite(wander.normal[0]) && isfinite(u[2]));
  }
}

/* Where the stress is negative: u'x with the other sign, all else as in the mirror. */
static void a_stream_that_flows_back_is_the_mirror_image(void **state)
{
  (void) state;
  const double edge[4] = {0, 1, 2, 3}, there[3] = {0.2, 0.3, 0.5}, back[3] = {-0.2, -0.3, -0.5}, life[3] = {1, 2, 1};
  const sd_vans_mesh mesh = {3, 0.0, 1.0, edge};
  const double stress[3] = {-30.0, -20.0, 0.1};
  assert_true(sd_vans_largest_stress(&mesh, stress) == -30.0);
  const sd_vans_langevin walk = {42, -1.0, there, life, 0.1, 0}, mirror = {42, -1.0, back, life, 0.1, 0};
  const sd_vans_walk eddies = {42, 1, -1.0, there, 9.0, 0.1}, mirrored = {42, 1, -1.0, back, 9.0, 0.1};
  for (int i = 0; i < 20; i++) {
    sd_vans_wander one = {{0.3, -1.1, 0.7}, 3}, other = one;
    sd_vans_eddy eddy = {0.0, 2.0}, eddy_back = eddy;
    double u[3], w[3];
    sd_vans_langevin_step(&mesh, &walk, 1.5, i, &one, u);
    sd_vans_langevin_step(&mesh, &mirror, 1.5, i, &other, w);
    assert_true(u[0] == -w[0] && u[1] == w[1] && u[2] == w[2] && fabs(u[2]) > 0.0);
    sd_vans_new_eddy(&mesh, 1e-6, &eddies, 1.5, i, &eddy, u);
    sd_vans_new_eddy(&mesh, 1e-6, &mirrored, 1.5, i, &eddy_back, w);
    assert_true(u[0] == -w[0] && u[1] == w[1] && u[2] == w[2] && fabs(u[2]) > 0.0);
    assert_true(eddy.life == eddy_back.life);
  }
}

/* None below the bed and outside the mesh, and what the grain remembers is then new. */
static void there_is_no_turbulence_in_the_bed(void **state)
{
  (void) state;
  const double edge[3] = {0, 1, 2}, u_star[2] = {0.3, 0.3}, life[2] = {1, 1}, z[4] = {-0.1, 0.3, 0.5, 2.1};
  const sd_vans_mesh mesh = {2, 0.0, 1.0, edge};
  const sd_vans_langevin walk = {42, 0.4, u_star, life, 0.1, 0};
  for (int k = 0; k < 4; k++) {
    sd_vans_wander wander = {{9, 9, 9}, 3};
    double u[3];
    sd_vans_langevin_step(&mesh, &walk, z[k], 5, &wander, u);
    const double size = fabs(u[0]) + fabs(u[1]) + fabs(u[2]);
    assert_true(k == 2 ? size > 1.0 : size == 0.0);
    if (k != 2) assert_true(fabs(wander.normal[0]) < 6.0);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(grains_spread_by_taylors_formula),
      cmocka_unit_test(even_grains_stay_even_where_the_turbulence_is_not),
      cmocka_unit_test(light_grains_do_not_gather_at_the_surface),
      cmocka_unit_test(the_schmidt_number_is_that_of_the_spread),
      cmocka_unit_test(next_to_no_turbulence_is_finite),
      cmocka_unit_test(a_stream_that_flows_back_is_the_mirror_image),
      cmocka_unit_test(there_is_no_turbulence_in_the_bed),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
