/* The pair sums against an evaluation of the printed equations, one pair after the other. */
#include "sd_sph_density.h"
#include "sd_sph_pair.h"
#include "sd_sph_wall.h"

#include "check.h"

#include <string.h>

enum { N = 23, ALL = N * (N - 1) / 2 };

static uint64_t seed = 4711;

static double random_number(void)
{
  return uniform(&seed, 0.0, 1.0);
}

/* Two classes of particles in a box of a few h, velocities and both signs of pressure, all pairs in a half
 * list. */
typedef struct {
  double x[3 * N], v[3 * N], rho[N + 1], P[N], A[N], m[N + 1];
  double x4[4 * (N + 1)], v4[4 * (N + 1)];
  int cls[N + 1], first[N], count[N], flat[ALL + 1], *neighbor[N];
  sd_sph_list list;
  sd_sph_particles p;
  sd_sph_parameters types[4];
  sd_sph_coefficients pair[4];
  sd_sph_model model;
} scene;

static void build(scene *s, sd_sph_kernel kernel, int dimension, int classes, int artvisc,
                  int tenscorr, int viscous)
{
  memset(s, 0, sizeof(*s));
  const sd_sph_parameters one = {0.3, 20.0, 0.07, 0.4, 0.25}, two = {0.36, 25.0, 0.05, 0.3, 0.27};
  const sd_sph_parameters mean = {0.33, 22.5, 0.06, 0.35, 0.26}, table[4] = {one, mean, mean, two};
  const double mu = 0.7;
  s->model =
      (sd_sph_model){kernel, dimension, artvisc, tenscorr, viscous, 1.3e-3, 0.21, classes, s->pair};
  for (int k = 0; k < 4; k++) {
    s->types[k] = table[k];
    s->pair[k] = sd_sph_coefficients_of(kernel, dimension, &table[k], mu);
  }
  int *next = s->flat;
  for (int i = 0; i < N; i++) {
    for (int d = 0; d < 3; d++) {
      s->x[3 * i + d] = d < dimension ? random_number() : 0.0;
      s->v[3 * i + d] = d < dimension ? random_number() - 0.5 : 0.0;
    }
    s->cls[i] = classes > 1 ? i % 2 : 0;
    s->m[i] = s->cls[i] ? 1.3 : 0.9;
    s->rho[i] = 900.0 + 200.0 * random_number();
    s->P[i] = 5e4 * (s->rho[i] - 1000.0);
    s->A[i] = s->P[i] / (s->rho[i] * s->rho[i]);
    s->first[i] = i;
    s->neighbor[i] = next;
    for (int j = i + 1; j < N; j++)
      *next++ = j | 1 << 30;    // marked as LAMMPS marks neighbours; the mask removes it
    s->count[i] = N - 1 - i;
  }
  s->rho[N] = 1.0;
  s->list = (sd_sph_list){N, (1 << 30) - 1, s->first, s->count, s->neighbor};
  s->p = (sd_sph_particles){N, s->x4, s->v4, s->m, s->cls, 0.9};
  sd_sph_pack_x(N, s->x, NULL, 0.0, s->x4);
  for (int i = 0; i < N; i++) s->x4[4 * i + 3] = s->A[i];
  sd_sph_pack_v(N, s->v, s->rho, s->v4);
}

/* The equations of the header of sd_sph_pair.h for one pair: force on i, and v.d W'/r. */
static void by_the_book(const scene *s, int i, int j, double F[3], double *rate)
{
  const sd_sph_parameters *t = &s->types[s->model.nclasses > 1 ? 2 * s->cls[i] + s->cls[j] : 0];
  double d[3], u[3], r2 = 0.0, vd = 0.0;
  for (int c = 0; c < 3; c++) {
    d[c] = s->x[3 * i + c] - s->x[3 * j + c];
    u[c] = s->v[3 * i + c] - s->v[3 * j + c];
    r2 += d[c] * d[c];
    vd += d[c] * u[c];
  }
  const double r = sqrt(r2), mi = s->m[i], mj = s->m[j], rho = 0.5 * (s->rho[i] + s->rho[j]);
  const double g = sd_sph_dW_over_r(s->model.kernel, s->model.dimension, r, t->h);
  double bracket = s->P[i] / (s->rho[i] * s->rho[i]) + s->P[j] / (s->rho[j] * s->rho[j]);
  if (s->model.tenscorr) {
    const double f = sd_sph_W(s->model.kernel, s->model.dimension, r, t->h) /
        sd_sph_W(s->model.kernel, s->model.dimension, t->deltap, t->h);
    double R = 0.0;
    if (s->P[i] > 0.0 && s->P[j] > 0.0)
      R = 0.01 * bracket;
    else {
      if (s->P[i] < 0.0) R += s->model.epsilon * fabs(s->P[i]) / (s->rho[i] * s->rho[i]);
      if (s->P[j] < 0.0) R += s->model.epsilon * fabs(s->P[j]) / (s->rho[j] * s->rho[j]);
    }
    bracket += R * pow(f, 4);
  }
  if (s->model.artvisc && vd < 0.0) {
    const double mu = t->h * vd / (r2 + s->model.eta);
    bracket += (-t->alpha * t->c * mu + t->beta * mu * mu) / rho;
  }
  for (int c = 0; c < 3; c++) {
    F[c] = -mi * mj * bracket * g * d[c];
    if (s->model.viscous) F[c] += mi * mj * 2.0 * 0.7 / (s->rho[i] * s->rho[j]) * g * u[c];
  }
  *rate = g * vd;
}

static void compare(const scene *s, const double *f4, int rates)
{
  double F[3 * N] = {0}, drho[N] = {0}, largest = 0.0, fastest = 0.0;
  for (int i = 0; i < N; i++)
    for (int j = i + 1; j < N; j++) {
      double f[3], w;
      by_the_book(s, i, j, f, &w);
      for (int c = 0; c < 3; c++) {
        F[3 * i + c] += f[c];
        F[3 * j + c] -= f[c];
      }
      drho[i] += s->m[j] * w;
      drho[j] += s->m[i] * w;
    }
  for (int k = 0; k < 3 * N; k++) largest = fmax(largest, fabs(F[k]));
  for (int k = 0; k < N; k++) fastest = fmax(fastest, fabs(drho[k]));
  for (int i = 0; i < N; i++) {
    for (int c = 0; c < 3; c++) CHECK_NEAR(f4[4 * i + c], F[3 * i + c], 1e-13 * largest);
    CHECK_NEAR(f4[4 * i + 3], rates ? drho[i] : 0.0, 1e-13 * fastest);
  }
}

static void every_combination(const sd_sph_loops *loops)
{
  for (int bits = 0; bits < 128; bits++) {
    scene s;
    build(&s, bits & 1 ? SD_SPH_WENDLAND : SD_SPH_CUBICSPLINE, bits & 2 ? 3 : 2, bits & 4 ? 2 : 1,
          !!(bits & 8), !!(bits & 16), !!(bits & 32));
    double f4[4 * (N + 1)] = {0}, each[3 * ALL];
    const double nearest =
        loops->forces(&s.model, &s.list, &s.p, !!(bits & 64), f4, bits & 64 ? each : NULL);
    assert_true(nearest > 0.0);
    compare(&s, f4, !!(bits & 64));
    if (bits & 64) {
      double f[3], w;
      by_the_book(&s, 0, 1, f, &w);
      for (int c = 0; c < 3; c++)
        CHECK_NEAR(each[c], f[c], 1e-12 * (fabs(f[0]) + fabs(f[1]) + fabs(f[2])));
    }

    double rate[N + 1] = {0};
    int pool[ALL + 3], count[N], *near[N];
    const sd_sph_near found = {0.0, pool, near, count};
    loops->rates(&s.model, &s.list, &s.p, rate, &found);
    double both[4 * (N + 1)] = {0};
    loops->forces(&s.model, &s.list, &s.p, 1, both, NULL);
    for (int i = 0; i < N; i++) CHECK_NEAR(rate[i], both[4 * i + 3], 1e-12 * (1.0 + fabs(rate[i])));

    /* The near pairs give the same forces as all pairs, and are fewer. */
    const sd_sph_list few = {N, ~0, s.first, count, near};
    double again[4 * (N + 1)] = {0};
    loops->forces(&s.model, &few, &s.p, !!(bits & 64), again, NULL);
    compare(&s, again, !!(bits & 64));
    int total = 0;
    for (int i = 0; i < N; i++) total += count[i];
    assert_true(total < ALL && total > 0);
  }
}

static void loops_for_any_processor(void **state)
{
  (void) state;
  every_combination(&sd_sph_loops_any);
}

static void loops_for_avx2(void **state)
{
  (void) state;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    every_combination(&sd_sph_loops_avx2);
#endif
}

/* Two particles on the x axis, Wendland in 3-D: R read off the force, against the rule. */
static double R_of(double Pi, double Pj)
{
  scene s;
  build(&s, SD_SPH_WENDLAND, 3, 1, 0, 0, 0);
  const double r = 0.2,
               f4_weight = pow(sd_sph_W(SD_SPH_WENDLAND, 3, r, 0.3) /
                                   sd_sph_W(SD_SPH_WENDLAND, 3, 0.25, 0.3),
                               4);
  const double x[6] = {0, 0, 0, r, 0, 0}, A[2] = {Pi / (900.0 * 900.0), Pj / (1100.0 * 1100.0)};
  const int first[1] = {0}, count[1] = {1};
  int only[1] = {1}, *neighbor[1] = {only};
  s.list = (sd_sph_list){1, ~0, first, count, neighbor};
  s.p.n = 2;
  sd_sph_pack_x(2, x, NULL, 0.0, s.x4);
  for (int i = 0; i < 2; i++) s.x4[4 * i + 3] = A[i];
  double without[12] = {0}, with[12] = {0};
  sd_sph_forces(&s.model, &s.list, &s.p, 0, without, NULL);
  s.model.tenscorr = 1;
  sd_sph_forces(&s.model, &s.list, &s.p, 0, with, NULL);
  const double unit = -0.9 * 0.9 * sd_sph_dW_over_r(SD_SPH_WENDLAND, 3, r, 0.3) * -r;
  return (with[0] - without[0]) / unit / f4_weight;
}

static void tensile_rule(void **state)
{
  (void) state;
  const double a = 4e5 / (900.0 * 900.0), b = 3e5 / (1100.0 * 1100.0);
  CHECK_NEAR(R_of(4e5, 3e5), 0.01 * (a + b), 1e-14);
  CHECK_NEAR(R_of(-4e5, 3e5), 0.21 * a, 1e-14);
  CHECK_NEAR(R_of(4e5, -3e5), 0.21 * b, 1e-14);
  CHECK_NEAR(R_of(-4e5, -3e5), 0.21 * (a + b), 1e-14);
  CHECK_NEAR(R_of(0.0, 3e5), 0.0, 1e-14);
}

static void one_place_is_reported(void **state)
{
  (void) state;
  scene s;
  build(&s, SD_SPH_CUBICSPLINE, 3, 2, 1, 1, 1);
  memcpy(s.x4 + 4 * 7, s.x4 + 4 * 3, 3 * sizeof(double));
  double f4[4 * (N + 1)] = {0};
  assert_true(sd_sph_forces(&s.model, &s.list, &s.p, 1, f4, NULL) == 0.0);
}

static void sums_over_neighbours(void **state)
{
  (void) state;
  scene s;
  build(&s, SD_SPH_WENDLAND, 2, 2, 0, 0, 0);
  double sums[2 * (N + 1)] = {0};
  sd_sph_sums(&s.model, &s.list, &s.p, s.rho, sums);
  for (int i = 0; i < N; i++) {
    double mW = 0.0, VW = 0.0;
    for (int j = 0; j < N; j++) {
      if (j == i) continue;
      const double dx = s.x[3 * i] - s.x[3 * j], dy = s.x[3 * i + 1] - s.x[3 * j + 1];
      const double W =
          sd_sph_W(SD_SPH_WENDLAND, 2, sqrt(dx * dx + dy * dy), s.types[2 * s.cls[i] + s.cls[j]].h);
      mW += s.m[j] * W;
      VW += s.m[j] / s.rho[j] * W;
    }
    CHECK_NEAR(sums[2 * i], mW, 1e-13 * mW);
    CHECK_NEAR(sums[2 * i + 1], VW, 1e-13 * VW);
    /* With the particle itself: the density by summation, and filtered, for every other particle. */
    const double own = s.m[i] * sd_sph_W(SD_SPH_WENDLAND, 2, 0.0, s.types[3 * s.cls[i]].h);
    double summed[N], filtered[N];
    memcpy(summed, s.rho, sizeof(summed));
    memcpy(filtered, s.rho, sizeof(filtered));
    sd_sph_summation(&s.model, &s.p, sums, N, s.cls, 1, summed);
    sd_sph_shepard(&s.model, &s.p, sums, N, s.cls, 1, filtered);
    CHECK_NEAR(summed[i], s.cls[i] ? mW + own : s.rho[i], 1e-12 * summed[i]);
    CHECK_NEAR(filtered[i], s.cls[i] ? (mW + own) / (VW + own / s.rho[i]) : s.rho[i],
               1e-12 * filtered[i]);
  }
}

/* The corrected gradient of a linear density is exact, so psi vanishes and a linear density does not
 * diffuse, even at random places. */
static void linear_density_does_not_diffuse(void **state)
{
  (void) state;
  for (int dimension = 2; dimension <= 3; dimension++) {
    scene s;
    build(&s, SD_SPH_WENDLAND, dimension, 2, 0, 0, 0);
    for (int k = 0; k < 4; k++) {
      s.types[k].h *= 3.0;    // everybody sees everybody
      s.pair[k] = sd_sph_coefficients_of(SD_SPH_WENDLAND, dimension, &s.types[k], 0.0);
    }
    for (int i = 0; i < N; i++)
      s.m[i] *= 10000.0 / N;    // as if the box filled the support: L near 1
    const double slope[3] = {30.0, -70.0, dimension == 3 ? 50.0 : 0.0};
    for (int i = 0; i < N; i++) {
      s.rho[i] = 1000.0;
      for (int d = 0; d < 3; d++) s.rho[i] += slope[d] * s.x[3 * i + d];
    }
    double sums[9 * (N + 1)] = {0}, gradient[3 * (N + 1)] = {0}, rate[N + 1] = {0},
                         curved[N + 1] = {0}, total = 0.0, largest = 0.0;
    sd_sph_gradient_sums(&s.model, &s.list, &s.p, s.rho, sums);
    for (int i = 0; i < N; i++) {
      sd_sph_gradient(dimension, &sums[9 * i], &gradient[3 * i]);
      for (int d = 0; d < 3; d++) CHECK_NEAR(gradient[3 * i + d], slope[d], 1e-9);
    }
    sd_sph_diffusion(&s.model, &s.list, &s.p, s.rho, gradient, 0.1, rate);
    for (int i = 0; i < N; i++) CHECK_NEAR(rate[i], 0.0, 1e-9);
    /* A density with a bump spreads, and the volume integral of the rate is 0. */
    s.rho[4] += 20.0;
    sd_sph_diffusion(&s.model, &s.list, &s.p, s.rho, gradient, 0.1, curved);
    assert_true(curved[4] < 0.0);
    for (int i = 0; i < N; i++) {
      total += s.m[i] / s.rho[i] * curved[i];
      largest = fmax(largest, s.m[i] / s.rho[i] * fabs(curved[i]));
    }
    CHECK_NEAR(total, 0.0, 1e-13 * largest);
  }
}

/* A wall before a fluid at rest with hydrostatic pressure continues that pressure exactly. */
static void wall_continues_the_hydrostatic_pressure(void **state)
{
  (void) state;
  scene s;
  build(&s, SD_SPH_WENDLAND, 2, 1, 0, 0, 0);
  const double g[3] = {0.0, -9.81, 0.0};
  int is_wall[N + 1] = {0};
  for (int i = 0; i < N; i++) {
    s.rho[i] = 1000.0;
    s.P[i] = 1000.0 * 9.81 * (2.0 - s.x[3 * i + 1]);
    is_wall[i] = s.x[3 * i + 1] < 0.4;
  }
  sd_sph_pack_v(N, s.v, s.rho, s.v4);
  double sums[5 * (N + 1)] = {0};
  sd_sph_wall_sums(&s.model, &s.list, &s.p, is_wall, 1, s.P, g, sums);
  int tried = 0;
  for (int i = 0; i < N; i++) {
    if (!is_wall[i] || sums[5 * i] < 0.01) continue;
    CHECK_NEAR(sums[5 * i + 1] / sums[5 * i], s.P[i], 1e-9 * s.P[i]);
    tried++;
  }
  assert_true(tried > 2);
}

/* Friction sees the mirror image of the fluid's velocity without slip, that of the fluid with it;
 * the density is the one that has the pressure of the fluid. */
static void wall_particle_continues_the_fluid(void **state)
{
  (void) state;
  const sd_sph_state tait = {SD_SPH_TAIT, 5e4, 990.0, 7.0, 30.0};
  const double sums[5] = {0.8, 0.8 * 2.4e3, 0.8 * 0.3, 0.8 * -0.7, 0.0}, v[3] = {0.1, 0.2, -0.3};
  double row[4] = {1.0}, glides[4] = {1.0};
  sd_sph_wall_particle(&tait, sums, v, 0, row);
  sd_sph_wall_particle(&tait, sums, v, 1, glides);
  CHECK_NEAR(sd_sph_pressure(&tait, row[0]), 2.4e3, 1e-8);
  for (int d = 0; d < 3; d++) {
    const double fluid = sums[2 + d] / sums[0];
    CHECK_NEAR(v[d] + glides[1 + d], fluid, 1e-15);
    CHECK_NEAR(v[d] + row[1 + d], 2 * v[d] - fluid, 1e-15);
  }
  const double none[5] = {0.0};
  sd_sph_wall_particle(&tait, none, v, 0, row);
  CHECK_NEAR(row[0], 990.0, 1e-9);
  assert_true(row[1] == 0.0 && row[2] == 0.0 && row[3] == 0.0);
  const double torn[5] = {0.8, 0.8 * -5e4, 0.0, 0.0, 0.0};
  sd_sph_wall_particle(&tait, torn, v, 0, row);
  assert_true(row[0] == 0.0);
  CHECK_NEAR(sd_sph_least_pressure(&tait), 30.0 - 5e4, 1e-9);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(loops_for_any_processor),
                                     cmocka_unit_test(loops_for_avx2),
                                     cmocka_unit_test(tensile_rule),
                                     cmocka_unit_test(one_place_is_reported),
                                     cmocka_unit_test(sums_over_neighbours),
                                     cmocka_unit_test(linear_density_does_not_diffuse),
                                     cmocka_unit_test(wall_continues_the_hydrostatic_pressure),
                                     cmocka_unit_test(wall_particle_continues_the_fluid)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
