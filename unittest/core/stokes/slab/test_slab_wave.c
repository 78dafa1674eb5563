/* One lateral wave between walls, and windows on planes that keep it. */
#include "slab.h"

#include "sd_slab_wave.h"
#include "sd_window.h"

/* Forces that stop a flow on two walls: the inverse of the flow that forces make there, (1) of sd_slab_wave.h */
static void walls_stop_the_flow_of_their_own_forces(void **state)
{
  (void) state;
  for (double K = 0.02; K < 30.0; K *= 1.7) {
    const double H = 1.7, E = exp(-K);
    const sd_slab_stops q = sd_slab_stops_at(K / H, H);
    const double own[4][4] = {{1, 0, E * (1 - K), E * K}, {0, 1, -E * K, E * (1 + K)},
                              {E * (1 - K), -E * K, 1, 0}, {E * K, E * (1 + K), 0, 1}};
    for (int j = 0; j < 4; j++) {
      const double u[4] = {own[0][j], own[1][j], own[2][j], own[3][j]};
      const double ve[2] = {u[0] + u[2], u[1] - u[3]}, vo[2] = {u[0] - u[2], u[1] + u[3]};
      const double e[2] = {q.even[0] * ve[0] + q.even[1] * ve[1], q.even[1] * ve[0] + q.even[2] * ve[1]};
      const double o[2] = {q.odd[0] * vo[0] + q.odd[1] * vo[1], q.odd[1] * vo[0] + q.odd[2] * vo[1]};
      const double f[4] = {0.5 * (e[0] + o[0]), 0.5 * (e[1] + o[1]), 0.5 * (e[0] - o[0]), 0.5 * (o[1] - e[1])};
      for (int i = 0; i < 4; i++) CHECK_NEAR(f[i], i == j, 1e-14 * (1.0 + pow(K, -3)));
    }
    CHECK_NEAR(q.t * (1.0 - q.E * q.E), 1.0, 1e-14 * (1.0 + 1.0 / K));
  }
}

/* Windows that fall off like a wave do, summed over the planes: exp(-kz) of their middle */
static void a_window_keeps_a_falling_wave(void **state)
{
  (void) state;
  sd_slab s = {.spacing = 0.7, .ewald = {.points = 9, .beta = 2.25 * 9, .a_ref = 0.0}};
  sd_window w;
  sd_window_fit(s.ewald.points, s.ewald.beta, 0, 0.0, 1e-9, &w);
  for (double k = 0.1; k < 2.2; k += 0.4)
    for (double v = -0.9; v < 1.0; v += 0.3) {
      double sum = 0.0;
      for (int p = 0; p < w.points; p++) {
        double phi = 0.0;
        for (int m = w.degree; m >= 0; m--) phi = phi * v + w.coefficient[m][p];
        sum += phi * exp(-k * s.spacing * (p + 1 - 0.5 * (v + 1.0) - 0.5 * w.points));
      }
      const sd_slab_window at = sd_slab_window_at(&s, k), more = sd_slab_window_at(&s, k + 1e-5);
      CHECK_NEAR(sum / at.W, 1.0, 1e-5);
      CHECK_NEAR(at.shift, k * log(more.W / at.W) / 1e-5, 1e-3);
    }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(walls_stop_the_flow_of_their_own_forces),
      cmocka_unit_test(a_window_keeps_a_falling_wave),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
