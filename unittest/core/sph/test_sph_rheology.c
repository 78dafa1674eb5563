/* Viscosities that depend on the shear rate, the shear rate of particles, and friction with such viscosities. */
#include "sd_sph_internal.h"
#include "sd_sph_rheology.h"

#include "sph_scene.h"

static const sd_sph_rheology POWER = {SD_SPH_HERSCHEL_BULKLEY, 0.3, 0.0, 0.6, 40.0, 1.0},
                             THICK = {SD_SPH_HERSCHEL_BULKLEY, 0.3, 0.0, 1.7, 40.0, 1.0},
                             BINGHAM = {SD_SPH_HERSCHEL_BULKLEY, 0.3, 2.0, 1.0, 40.0, 1.0},
                             BOTH = {SD_SPH_HERSCHEL_BULKLEY, 0.3, 2.0, 0.4, 40.0, 1.0},
                             CARREAU = {SD_SPH_CARREAU, 0.3, 0.0, 0.4, 40.0, 5.0};

static double stress(const sd_sph_rheology *f, double G)
{
  return G * sd_sph_mu(f, G);
}

/* Where mu_max does not act, at a shear rate that is none of the units. */
static void stresses_are_those_of_the_laws(void **state)
{
  (void) state;
  const double G = 3.7;
  CHECK_NEAR(stress(&POWER, G), 0.3 * pow(G, 0.6), 1e-14);
  CHECK_NEAR(stress(&THICK, G), 0.3 * pow(G, 1.7), 1e-14);
  CHECK_NEAR(stress(&BINGHAM, G), 2.0 + 0.3 * G, 1e-14);
  CHECK_NEAR(stress(&BOTH, G), 2.0 + 0.3 * pow(G, 0.4), 1e-14);
  /* (1 + 1)^((n-1)/2) at G = 1/lambda */
  CHECK_NEAR(sd_sph_mu(&CARREAU, 1.0 / 5.0), 0.3 + 39.7 / pow(2.0, 0.3), 1e-13);
}

static void at_rest_and_in_fast_shear(void **state)
{
  (void) state;
  const sd_sph_rheology thinning[] = {POWER, BINGHAM, BOTH, CARREAU};
  for (int k = 0; k < 4; k++) {
    CHECK_NEAR(sd_sph_mu(&thinning[k], 0.0), 40.0, 0.0);
    CHECK_NEAR(sd_sph_mu(&thinning[k], 1e-200), 40.0, 1e-12);
    CHECK_NEAR(sd_sph_largest_mu(&thinning[k]), 40.0, 0.0);
  }
  CHECK_NEAR(sd_sph_mu(&THICK, 0.0), 0.0, 0.0);
  CHECK_NEAR(sd_sph_largest_mu(&THICK), 40.0, 0.0);
  CHECK_NEAR(sd_sph_mu(&THICK, 1e6), 40.0, 0.0);
  CHECK_NEAR(sd_sph_mu(&BINGHAM, 1e9), 0.3, 1e-8);
  CHECK_NEAR(sd_sph_mu(&CARREAU, 1e30), 0.3, 1e-12);
}

/* Without yield stress and with n = 1 all of them are Newton's fluid. */
static void newton_is_a_limit_of_each(void **state)
{
  (void) state;
  const sd_sph_rheology newton = {.law = SD_SPH_NEWTON, .mu = 0.3},
                        plain = {SD_SPH_HERSCHEL_BULKLEY, 0.3, 0.0, 1.0, 40.0, 1.0},
                        carreau = {SD_SPH_CARREAU, 0.3, 0.0, 0.4, 0.3, 5.0};
  for (double G = 0.0; G < 1e4; G = 3.0 * G + 1e-3) {
    CHECK_NEAR(sd_sph_mu(&plain, G), sd_sph_mu(&newton, G), 1e-16);
    CHECK_NEAR(sd_sph_mu(&carreau, G), sd_sph_mu(&newton, G), 1e-16);
  }
  CHECK_NEAR(sd_sph_largest_mu(&plain), 0.3, 0.0);
}

/* Were it to fall, two rates would have one stress, and the fluid would band. No jumps: in a step of 0.01 %
 * the stress grows by no more than max(n, 1) times that. */
static void stress_grows_with_the_rate_without_jumps(void **state)
{
  (void) state;
  const sd_sph_rheology all[] = {POWER, THICK, BINGHAM, BOTH, CARREAU};
  const double step = 1.0001;
  for (int k = 0; k < 5; k++) {
    double before = stress(&all[k], 1e-8);
    assert_true(before > 0.0);
    for (double G = 1e-8 * step; G < 1e6; G *= step) {
      const double now = stress(&all[k], G);
      assert_true(now > before && now < before * (1.0 + 2.0 * (step - 1.0)));
      before = now;
    }
  }
}

static void velocities_of(scene *s, double L[3][3])
{
  for (int i = 0; i < N; i++)
    for (int a = 0; a < 3; a++) {
      s->v[3 * i + a] = 0.4;
      for (int b = 0; b < 3; b++) s->v[3 * i + a] += L[a][b] * s->x[3 * i + b];
    }
  sd_sph_pack_v(N, s->v, s->rho, s->v4);
}

/* Of a linear velocity, on any arrangement of particles of two classes: (2 S:S)^(1/2), and 0 for a rotation. */
static void shear_rates_of(const sd_sph_loops *loops)
{
  for (int bits = 0; bits < 8; bits++) {
    const int dimension = bits & 1 ? 3 : 2;
    scene s;
    build(&s, bits & 2 ? SD_SPH_WENDLAND : SD_SPH_CUBICSPLINE, dimension, bits & 4 ? 2 : 1, 0, 0,
          SD_SPH_CENTRAL);
    fill(&s);
    double L[3][3] = {{0}}, square = 0.0;
    for (int a = 0; a < dimension; a++)
      for (int b = 0; b < dimension; b++) L[a][b] = random_number() - 0.5;
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++) square += 0.5 * (L[a][b] + L[b][a]) * (L[a][b] + L[b][a]);
    double turning[3][3] = {{0, -0.7, 0}, {0.7, 0, 0}, {0, 0, 0}};
    for (int k = 0; k < 2; k++) {
      double sums[SD_SPH_GRADIENTS * (N + 1)] = {0};
      velocities_of(&s, k ? turning : L);
      loops->gradients(&s.model, &s.list, &s.p, sums);
      for (int i = 0; i < N; i++)
        CHECK_NEAR(sd_sph_shear_rate(dimension, sums + SD_SPH_GRADIENTS * i), k ? 0.0 : sqrt(square), 1e-10);
    }
  }
}

static void copy(scene *to, const scene *s)
{
  *to = *s;
  to->model.pair = to->pair;
  to->p.x4 = to->x4;
  to->p.v4 = to->v4;
  to->p.m = to->m;
  to->p.cls = to->cls;
}

/* Friction of particles of one class that have the viscosities mu is that of many pairs, each of which has
 * the harmonic mean as the mu of its class: what a run with one such pair alone shows, pair by pair. */
static void friction_of(const sd_sph_loops *loops)
{
  for (int bits = 0; bits < 4; bits++) {
    scene s, one;
    build(&s, SD_SPH_WENDLAND, bits & 1 ? 3 : 2, 1, 0, 0, bits & 2 ? SD_SPH_CENTRAL : SD_SPH_LAPLACIAN);
    for (int i = 0; i < N; i++) s.x4[4 * i + 3] = 0.0;    // friction alone
    double mu[N + 1], expected[4 * (N + 1)] = {0}, f4[4 * (N + 1)] = {0}, largest = 0.0;
    for (int i = 0; i <= N; i++) mu[i] = 0.1 + 3.0 * random_number() * random_number();
    copy(&one, &s);
    for (int i = 0; i < N; i++)
      for (int j = i + 1; j < N; j++) {
        int only[1] = {j}, *row[N], count[N] = {0};
        row[i] = only;
        count[i] = 1;
        one.types[0].mu = 2.0 * mu[i] * mu[j] / (mu[i] + mu[j]);
        coefficients(&one);
        const sd_sph_list list = {1, ~0, &i, count, row};
        loops->forces(&one.model, &list, &one.p, 0, expected, NULL);
      }
    s.types[0].mu = 1.0;
    coefficients(&s);
    s.p.mu = mu;
    loops->forces(&s.model, &s.list, &s.p, 0, f4, NULL);
    for (int k = 0; k < 4 * N; k++) largest = fmax(largest, fabs(expected[k]));
    assert_true(largest > 0.0);
    for (int k = 0; k < 4 * N; k++) CHECK_NEAR(f4[k], expected[k], 1e-13 * largest);
  }
}

/* With correction all particles that have the same viscosity are those of a pair_coeff. */
static void corrected_friction_of(const sd_sph_loops *loops)
{
  scene s;
  build(&s, SD_SPH_WENDLAND, 3, 1, 0, 0, SD_SPH_CENTRAL);
  s.model.scheme = SD_SPH_CORRECTION;
  double B[8 * (N + 1)] = {0}, mu[N + 1], known[4 * (N + 1)] = {0}, f4[4 * (N + 1)] = {0};
  for (int i = 0; i < N; i++)
    for (int c = 0; c < 6; c++) B[8 * i + c] = (c < 3) + 0.1 * random_number();
  for (int i = 0; i <= N; i++) mu[i] = s.types[0].mu;
  s.p.B = B;
  neighbours around;
  const sd_sph_both both = both_ways(&s, &around, N);
  loops->slopes(&s.model, &both, &s.p, known, NULL);
  s.types[0].mu = 1.0;
  coefficients(&s);
  s.p.mu = mu;
  loops->slopes(&s.model, &both, &s.p, f4, NULL);
  for (int k = 0; k < 4 * N; k++) CHECK_NEAR(f4[k], known[k], 1e-11 * (1.0 + fabs(known[k])));
}

static void every_loop(sd_isa isa)
{
  if (!sd_isa_supported(isa)) return;
  const sd_sph_loops *loops = SD_KERNELS_OF(sd_sph_loops, baseline, isa);
  shear_rates_of(loops);
  friction_of(loops);
  corrected_friction_of(loops);
}

static void loops_of_every_instruction_set(void **state)
{
  (void) state;
  every_loop(SD_ISA_BASELINE);
  every_loop(SD_ISA_AVX2);
  every_loop(SD_ISA_AVX512);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(stresses_are_those_of_the_laws),
      cmocka_unit_test(at_rest_and_in_fast_shear),
      cmocka_unit_test(newton_is_a_limit_of_each),
      cmocka_unit_test(stress_grows_with_the_rate_without_jumps),
      cmocka_unit_test(loops_of_every_instruction_set),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
