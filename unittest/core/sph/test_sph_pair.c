/* The pair sums against an evaluation of the printed equations, one pair after the other. */
#include "sd_sph_density.h"
#include "sd_sph_order.h"
#include "sd_sph_internal.h"

#include "sph_scene.h"

/* What a pair is made of */
typedef struct {
  const sd_sph_parameters *t;
  double d[3], u[3], r2, vd;
} couple;

static couple couple_of(const scene *s, int i, int j)
{
  couple p = {.t = &s->types[s->model.nclasses > 1 ? 2 * s->cls[i] + s->cls[j] : 0]};
  for (int c = 0; c < 3; c++) {
    p.d[c] = s->x[3 * i + c] - s->x[3 * j + c];
    p.u[c] = s->v[3 * i + c] - s->v[3 * j + c];
    p.r2 += p.d[c] * p.d[c];
    p.vd += p.d[c] * p.u[c];
  }
  return p;
}

/* The equations of the header of sd_sph_pair.h for one pair: force on i, and v.d W'/r. */
static void by_the_book(const scene *s, int i, int j, double F[3], double *rate)
{
  const couple p = couple_of(s, i, j);
  const sd_sph_parameters *t = p.t;
  const double *d = p.d, *u = p.u, r2 = p.r2, vd = p.vd;
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
    const double rub = mi * mj * 2.0 * t->mu / (s->rho[i] * s->rho[j]) * g;
    if (s->model.friction == SD_SPH_LAPLACIAN) F[c] += rub * u[c];
    if (s->model.friction == SD_SPH_CENTRAL)
      F[c] += rub * (s->model.dimension + 2) * vd / (r2 + 0.001 * t->h * t->h) * d[c];
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
  for (int bits = 0; bits < 192; bits++) {
    scene s;
    const sd_sph_friction friction = bits & 128 ? SD_SPH_CENTRAL
        : bits & 32                             ? SD_SPH_LAPLACIAN
                                                : SD_SPH_INVISCID;
    build(&s, bits & 1 ? SD_SPH_WENDLAND : SD_SPH_CUBICSPLINE, bits & 2 ? 3 : 2, bits & 4 ? 2 : 1,
          !!(bits & 8), !!(bits & 16), friction);
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
    neighbours close;
    const sd_sph_near found = near_in(&close);
    loops->rates(&s.model, &s.list, &s.p, rate, &found);
    double both[4 * (N + 1)] = {0};
    loops->forces(&s.model, &s.list, &s.p, 1, both, NULL);
    for (int i = 0; i < N; i++) CHECK_NEAR(rate[i], both[4 * i + 3], 1e-12 * (1.0 + fabs(rate[i])));

    /* The near pairs give the same forces as all pairs, and are fewer. */
    const sd_sph_list few = {N, ~0, s.first, close.own, close.neighbor};
    double again[4 * (N + 1)] = {0};
    loops->forces(&s.model, &few, &s.p, !!(bits & 64), again, NULL);
    compare(&s, again, !!(bits & 64));
    int total = 0;
    for (int i = 0; i < N; i++) total += close.own[i];
    assert_true(total < ALL && total > 0);
  }
}

/* The margin is the way of a step: in a run that blows up it may be longer than the filler is away. */
static void nobody_but_listed_neighbours_is_near(const sd_sph_loops *loops)
{
  const uint64_t before = seed;
  for (double margin = 0.0; margin < 1e210; margin = margin == 0.0 ? 1e90 : margin * 1e20) {
    scene s;
    build(&s, SD_SPH_WENDLAND, 3, 1, 1, 0, SD_SPH_INVISCID);
    double rate[N + 1] = {0};
    neighbours close;
    sd_sph_near found = near_in(&close);
    found.margin = margin;
    loops->rates(&s.model, &s.list, &s.p, rate, &found);
    for (int i = 0; i < N; i++) {
      assert_true(close.own[i] <= s.count[i]);
      for (int m = 0; m < close.own[i]; m++) assert_true(close.neighbor[i][m] < N);
      assert_true(margin == 0.0 || close.own[i] == s.count[i]);
    }
  }
  seed = before;    /* the other tests have their scenes */
}

/* The columns of sd_sph_sums.h, one pair after the other. */
static void columns_by_the_book(const scene *s, int i, int columns, double *sums)
{
  for (int j = 0; j < N; j++) {
    if (j == i) continue;
    const couple p = couple_of(s, i, j);
    const sd_sph_parameters *t = p.t;
    const double *d = p.d, *u = p.u, vd = p.vd;
    const double r = sqrt(p.r2), m = s->model.nclasses > 1 ? s->m[j] : s->p.mass, V = m / s->rho[j];
    const int kernel = s->model.kernel, dimension = s->model.dimension;
    const double g = sd_sph_dW_over_r(kernel, dimension, r, t->h);
    const int two = s->model.scheme == SD_SPH_VOLUME, other = two && s->phase[i] != s->phase[j];
    const double near = other ? 0.0 : g;
    const double f = sd_sph_W(kernel, dimension, r, t->h) /
        sd_sph_W(kernel, dimension, t->deltap, t->h);
    sums[0] += m * g * vd * (two ? 2.0 * s->rho[i] / (s->rho[i] + s->rho[j]) : 1.0);
    const int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    for (int c = 0; c < 3; c++) sums[1 + c] += V * (s->rho[j] - s->rho[i]) * near * d[c];
    for (int c = 0; c < 6; c++) sums[4 + c] -= V * near * d[pairs[c][0]] * d[pairs[c][1]];
    if (columns < 16) continue;
    for (int c = 0; c < 3; c++) sums[10 + c] += V * (1.0 + 0.2 * pow(f, 4)) * g * d[c];
    const int moves = !s->p.phase || s->phase[j] >= 0;
    if (g != 0.0 && moves) sums[13] = fmax(sums[13], fabs(vd) / r);
    if (columns < 24) continue;
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++) sums[14 + 3 * a + b] -= V * g * u[a] * d[b];
  }
}

/* The half list of i has those behind it; those before it come second, with the filler. */
static void first_are_those_of_the_half_list(int n, const neighbours *close)
{
  for (int i = 0; i < n; i++)
    for (int m = 0; m < close->count[i]; m++) {
      const int j = close->neighbor[i][m];
      assert_true(m < close->own[i] ? i < j && j < N : j < i || j == N);
    }
}

/* Nothing diffuses into fluid 0 from walls and from another fluid, whatever slopes these have. */
static void only_the_same_fluid_diffuses(const sd_sph_loops *loops, const scene *s, const sd_sph_both *list,
                                         double *slope, const double *known)
{
  double rate[N] = {0};
  for (int k = 0; s->p.phase && k < 4 * N; k++)
    if (s->phase[k / 4] != 0) slope[k] += 1.0;
  loops->diffusion(&s->model, list, &s->p, rate);
  for (int i = 0; i < list->n; i++)
    if (s->phase[i] == 0) CHECK_NEAR(rate[i], known[i], 1e-13 * (1.0 + fabs(known[i])));
}

/* All columns of the middle of a step, of owned particles among ghosts; and the near pairs that come
 * with it diffuse as all pairs do. */
static void every_column(const sd_sph_loops *loops)
{
  enum { OWNED = 15 };
  const sd_sph_scheme schemes[] = {SD_SPH_PLAIN, SD_SPH_VOLUME, SD_SPH_SHIFT, SD_SPH_CORRECTION};
  for (int bits = 0; bits < 64; bits++) {
    scene s;
    build(&s, bits & 1 ? SD_SPH_WENDLAND : SD_SPH_CUBICSPLINE, bits & 2 ? 3 : 2, bits & 4 ? 2 : 1, 0,
          0, SD_SPH_INVISCID);
    s.model.scheme = schemes[bits >> 3 & 3];
    s.model.delta = 0.1;
    coefficients(&s);
    for (int i = 0; i < N; i++)
      s.phase[i] = s.model.scheme == SD_SPH_VOLUME ? i % 2 : i % 5 ? 0 : -1;
    if (bits & 32 || s.model.scheme == SD_SPH_VOLUME) s.p.phase = s.phase;
    sd_sph_pack_volumes(&s.model, &s.p, s.rho, s.x4);

    const int columns = sd_sph_sum_columns(sd_sph_level_of(&s.model));
    double sums[24 * (N + 1)];
    neighbours around, close;
    const sd_sph_both both = both_ways(&s, &around, OWNED);
    const sd_sph_near found = near_in(&close);
    loops->middle(&s.model, &both, &s.p, sums, &found);
    for (int i = 0; i < OWNED; i++) {
      double book[24] = {0};
      columns_by_the_book(&s, i, columns, book);
      for (int c = 0; c < columns; c++)
        CHECK_NEAR(sums[columns * i + c], book[c], 1e-12 * (1e-3 + fabs(book[c])));
    }

    double slope[4 * (N + 1)] = {0}, all[N] = {0}, few[N] = {0};
    for (int k = 0; k < 4 * N; k++) slope[k] = random_number();
    s.p.slope = slope;
    const sd_sph_both picked = {OWNED, close.neighbor, close.own, close.count};
    loops->diffusion(&s.model, &both, &s.p, all);
    loops->diffusion(&s.model, &picked, &s.p, few);
    int total = 0;
    for (int i = 0; i < OWNED; i++) {
      CHECK_NEAR(few[i], all[i], 1e-13 * (1.0 + fabs(all[i])));
      total += around.count[i] - close.count[i];
    }
    assert_true(total > 0 && all[1] != 0.0);
    first_are_those_of_the_half_list(OWNED, &close);
    only_the_same_fluid_diffuses(loops, &s, &picked, slope, few);
  }
}

/* Those of a set that this processor has not: nothing to see */
static void every_loop(sd_isa isa)
{
  if (!sd_isa_supported(isa)) return;
  const sd_sph_loops *loops = SD_KERNELS_OF(sd_sph_loops, baseline, isa);
  every_combination(loops);
  every_column(loops);
  nobody_but_listed_neighbours_is_near(loops);
}

static void loops_for_any_processor(void **state)
{
  (void) state;
  every_loop(SD_ISA_BASELINE);
}

static void loops_for_avx2(void **state)
{
  (void) state;
  every_loop(SD_ISA_AVX2);
}

static void loops_for_avx512(void **state)
{
  (void) state;
  every_loop(SD_ISA_AVX512);
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
  sd_sph_pack_x(2, x, NULL, NULL, 0.0, s.x4);
  for (int i = 0; i < 2; i++) s.x4[4 * i + 3] = A[i];
  double without[12] = {0}, with[12] = {0};
  sd_sph_forces(&s.model, &s.list, &s.p, 0, without, NULL);
  s.model.tenscorr = 1;
  coefficients(&s);
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
  build(&s, SD_SPH_CUBICSPLINE, 3, 2, 1, 1, SD_SPH_LAPLACIAN);
  memcpy(s.x4 + 4 * 7, s.x4 + 4 * 3, 3 * sizeof(double));
  double f4[4 * (N + 1)] = {0};
  assert_true(sd_sph_forces(&s.model, &s.list, &s.p, 1, f4, NULL) == 0.0);
}

static void sums_over_neighbours(void **state)
{
  (void) state;
  scene s;
  build(&s, SD_SPH_WENDLAND, 2, 2, 0, 0, 0);
  double sums[4 * (N + 1)] = {0}, weights[4 * (N + 1)];
  sd_sph_pack_masses(&s.model, &s.p, s.rho, weights);
  sd_sph_weigh(&s.model, &s.list, &s.p, weights, sums);
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
    CHECK_NEAR(sums[4 * i], mW, 1e-13 * mW);
    CHECK_NEAR(sums[4 * i + 1], VW, 1e-13 * VW);
    /* With the particle itself: the density by summation, and filtered, for every other particle. */
    const double own = s.m[i] * sd_sph_W(SD_SPH_WENDLAND, 2, 0.0, s.types[3 * s.cls[i]].h);
    double summed[N], filtered[N];
    memcpy(summed, s.rho, sizeof(summed));
    memcpy(filtered, s.rho, sizeof(filtered));
    sd_sph_densities how = {N, 1, 0, s.cls, sums};
    sd_sph_sum_densities(&s.model, &s.p, &how, summed);
    how.shepard = 1;
    sd_sph_sum_densities(&s.model, &s.p, &how, filtered);
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
    s.model.delta = 0.1;
    fill(&s);
    const double slope[3] = {30.0, -70.0, dimension == 3 ? 50.0 : 0.0};
    for (int i = 0; i < N; i++) {
      s.rho[i] = 1000.0;
      for (int d = 0; d < 3; d++) s.rho[i] += slope[d] * s.x[3 * i + d];
    }
    sd_sph_pack_v(N, s.v, s.rho, s.v4);
    sd_sph_pack_volumes(&s.model, &s.p, s.rho, s.x4);
    double sums[12 * (N + 1)] = {0}, found[4 * (N + 1)] = {0}, rate[N + 1] = {0},
                          curved[N + 1] = {0}, total = 0.0, largest = 0.0;
    sum_middle(&s, sums);
    const sd_sph_closing closing = {N, sums, s.cls, 0, 0, 0.0, 0.0, rate, found, NULL, NULL, NULL};
    assert_int_equal(sd_sph_close(&s.model, &s.p, &closing), -1);
    for (int i = 0; i < N; i++)
      for (int d = 0; d < 3; d++) CHECK_NEAR(found[4 * i + d], slope[d], 1e-9);
    s.p.slope = found;
    memset(rate, 0, sizeof(rate));
    diffuse(&s, rate);
    for (int i = 0; i < N; i++) CHECK_NEAR(rate[i], 0.0, 1e-9);
    /* A density with a bump spreads, and the volume integral of the rate is 0. */
    found[4 * 4 + 3] += 20.0;
    diffuse(&s, curved);
    assert_true(curved[4] < 0.0);
    for (int i = 0; i < N; i++) {
      total += s.m[i] / s.rho[i] * curved[i];
      largest = fmax(largest, s.m[i] / s.rho[i] * fabs(curved[i]));
    }
    CHECK_NEAR(total, 0.0, 1e-13 * largest);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(loops_for_any_processor),
      cmocka_unit_test(loops_for_avx2),
      cmocka_unit_test(loops_for_avx512),
      cmocka_unit_test(tensile_rule),
      cmocka_unit_test(one_place_is_reported),
      cmocka_unit_test(sums_over_neighbours),
      cmocka_unit_test(linear_density_does_not_diffuse),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
