/* Implicit friction: what it solves, what it keeps, and its limits. */
#include "sd_sph_implicit.h"

#include "sph_scene.h"

static const sd_world ALONE = {0};

/* Random particles with viscosities from 1 to 1000; every fifth has a given velocity. */
typedef struct {
  scene s;
  double mu[N + 1], m[N], v[3 * N], u[3 * N], before[3 * N], F[3 * N];
  _Alignas(64) double work[5 * (N + 1) + 16 * N + 8], more[4 * (N + 1)];
  sd_sph_implicit A;
} mud;

static void make_mud(mud *q, sd_sph_friction friction, int classes, double tau)
{
  memset(q, 0, sizeof(*q));
  build(&q->s, SD_SPH_WENDLAND, 3, classes, 0, 0, friction);
  for (int k = 0; k < 4; k++) q->s.types[k].mu = 1.0;
  coefficients(&q->s);
  for (int i = 0; i < N; i++) {
    q->s.phase[i] = i % 5 == 4 ? ~0 : 0;
    q->mu[i] = pow(10.0, 3.0 * random_number());
    q->m[i] = classes > 1 ? q->s.m[i] : q->s.p.mass;
    q->s.x4[4 * i + 3] = 0.0;
  }
  q->mu[N] = 1.0;
  q->s.p.phase = q->s.phase;
  q->s.p.mu = q->mu;
  for (int k = 0; k < 3 * N; k++) {
    q->v[k] = random_number() - 0.5;
    q->u[k] = q->v[k] + 0.1 * (random_number() - 0.5);
    q->F[k] = q->before[k] = 10.0 * (random_number() - 0.5);
  }
  q->A = (sd_sph_implicit){&q->s.model, &q->s.list, &q->s.p, N, q->m, tau, &ALONE, NULL, NULL, NULL};
  assert_true(sd_sph_implicit_size(&q->A) <= 5 * (N + 1) + 16 * N);
  int steps;
  assert_int_equal(sd_sph_rub_implicitly(&q->A, q->v, q->u, q->F, q->more, q->work, &steps), SD_OK);
}

/* w = v + tau F/m of the forces that come out; then these are F(u) - K (w - u), of K as the plain force has it,
 * and twice that to particles with a given velocity, whose w is u. */
static void friction_is_that_of_the_velocities_at_the_end(void **state)
{
  (void) state;
  for (int round = 0; round < 4; round++) {
    mud q;
    const double tau = round < 2 ? 0.3 : 40.0;
    make_mud(&q, round % 2 ? SD_SPH_CENTRAL : SD_SPH_LAPLACIAN, 1 + round / 2, tau);
    double y[3 * N], F[3 * N] = {0.0}, largest = 0.0;
    for (int i = 0; i < N; i++)
      for (int d = 0; d < 3; d++)
        y[3 * i + d] = q.s.phase[i] < 0 ? 0.0 : q.v[3 * i + d] + tau * q.F[3 * i + d] / q.m[i] - q.u[3 * i + d];
    for (int i = 0; i < N; i++)
      for (int j = i + 1; j < N; j++) {
        double d[3], vd = 0.0, r2 = 0.0;
        for (int c = 0; c < 3; c++) {
          d[c] = q.s.x[3 * i + c] - q.s.x[3 * j + c];
          r2 += d[c] * d[c];
          vd += d[c] * (y[3 * i + c] - y[3 * j + c]);
        }
        const sd_sph_coefficients *pair = &q.s.pair[2 * q.s.cls[i] + q.s.cls[j]];
        const double h = 1.0 / pair->inv_h, g = sd_sph_dW_over_r(SD_SPH_WENDLAND, 3, sqrt(r2), h);
        const int wall_i = q.s.phase[i] < 0, wall_j = q.s.phase[j] < 0;
        if (wall_i && wall_j) continue;
        const double mean = 2.0 * q.mu[i] * q.mu[j] / (q.mu[i] + q.mu[j]);
        const double mu = wall_i ? 2.0 * q.mu[j] : wall_j ? 2.0 * q.mu[i] : mean;
        const double k = q.m[i] * q.m[j] * 2.0 * mu / (q.s.rho[i] * q.s.rho[j]) * g;
        for (int c = 0; c < 3; c++) {
          const double f = round % 2 ? 5.0 * k * vd / (r2 + 0.001 * h * h) * d[c]
                                     : k * (y[3 * i + c] - y[3 * j + c]);
          F[3 * i + c] += f;
          F[3 * j + c] -= f;
        }
      }
    for (int k = 0; k < 3 * N; k++) largest = fmax(largest, fabs(F[k]));
    for (int k = 0; k < 3 * N; k++) CHECK_NEAR(q.F[k] - q.before[k], F[k], 1e-5 * largest);
  }
}

static void momentum_is_kept_to_rounding(void **state)
{
  (void) state;
  mud q;
  make_mud(&q, SD_SPH_CENTRAL, 2, 40.0);
  for (int d = 0; d < 3; d++) {
    double sum = 0.0, size = 0.0;
    for (int i = 0; i < N; i++) {
      sum += q.more[4 * i + d];
      size += fabs(q.more[4 * i + d]);
    }
    assert_true(size > 1.0);
    CHECK_NEAR(sum, 0.0, 1e-13 * size);
  }
}

/* In a long step, with no wall and no other force, friction makes one velocity of all: that of the centre of
 * mass. */
static void a_long_step_makes_one_velocity_of_all(void **state)
{
  (void) state;
  mud q;
  make_mud(&q, SD_SPH_LAPLACIAN, 1, 0.3);
  memset(q.s.phase, 0, sizeof(q.s.phase));
  for (int k = 0; k < 4; k++) q.s.types[k].h *= 3.0;
  coefficients(&q.s);
  q.A.tau = 1e8;
  memset(q.F, 0, sizeof(q.F));
  memset(q.u, 0, sizeof(q.u));
  int steps;
  assert_int_equal(sd_sph_rub_implicitly(&q.A, q.v, q.u, q.F, q.more, q.work, &steps), SD_OK);
  double mean[3] = {0.0};
  for (int k = 0; k < 3 * N; k++) mean[k % 3] += q.v[k] / N;
  for (int k = 0; k < 3 * N; k++) CHECK_NEAR(q.v[k] + q.A.tau * q.F[k] / q.m[k / 3], mean[k % 3], 1e-3);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(friction_is_that_of_the_velocities_at_the_end),
      cmocka_unit_test(momentum_is_kept_to_rounding),
      cmocka_unit_test(a_long_step_makes_one_velocity_of_all),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
