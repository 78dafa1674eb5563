/* Shift, correction, central friction and two fluids: what they are exact for, what they keep. */
#include "sph_scene.h"

#include "sd_linear.h"

enum { WIDE = 32 };

/* What a step computes for one scene, as the glue calls it. */
typedef struct {
  double sums[WIDE * (N + 1)], slope[4 * (N + 1)], du[4 * (N + 1)], B[8 * (N + 1)], rate[N + 1], kick[3 * N],
      f4[4 * (N + 1)];
  int stops;
} step;

static void middle_of(scene *s, step *t, double least)
{
  memset(t, 0, sizeof(*t));
  int flows[N];
  for (int i = 0; i < N; i++) flows[i] = s->p.phase && s->phase[i] < 0 ? 0 : 1;
  sd_sph_pack_v(N, s->v, s->rho, s->v4);
  sd_sph_pack_volumes(&s->model, &s->p, s->rho, s->x4);
  sum_middle(s, t->sums);
  const sd_sph_closing closing = {N, t->sums, flows, 1, sd_sph_corrects(&s->model), least, 0.0, t->rate,
                                  t->slope, t->du, t->B, t->kick};
  t->stops = sd_sph_close(&s->model, &s->p, &closing);
  s->p.slope = t->slope;
  s->p.du = t->du;
  s->p.B = t->B;
}

static void force_of(scene *s, step *t)
{
  sd_sph_pack_pressures(&s->model, N, s->P, 0.0, s->rho, s->x4);
  memset(t->f4, 0, sizeof(t->f4));
  forces_of(s, t->f4);
}

static double mass(const scene *s, int i)
{
  return s->model.nclasses > 1 ? s->m[i] : s->p.mass;
}

/* Sum of the forces and of their moments, over the sum of their sizes. */
static double net(const scene *s, const step *t, int moments)
{
  double sum[3] = {0}, size = 0.0;
  for (int i = 0; i < N; i++) {
    const double *F = t->f4 + 4 * i, *x = s->x + 3 * i;
    for (int d = 0; d < 3; d++) {
      const int e = (d + 1) % 3, f = (d + 2) % 3;
      sum[d] += moments ? x[e] * F[f] - x[f] * F[e] : F[d];
      size += fabs(F[d]);
    }
  }
  assert_true(size > 0.0);
  return (fabs(sum[0]) + fabs(sum[1]) + fabs(sum[2])) / size;
}

/* v = A x + a */
static void linear_velocity(scene *s, const double A[9], const double a[3])
{
  for (int i = 0; i < N; i++)
    for (int d = 0; d < 3; d++) {
      s->v[3 * i + d] = d < s->model.dimension ? a[d] : 0.0;
      for (int e = 0; e < s->model.dimension && d < s->model.dimension; e++)
        s->v[3 * i + d] += A[3 * d + e] * s->x[3 * i + e];
    }
}

static void wide_scene(scene *s, sd_sph_scheme scheme, int dimension, int classes)
{
  build(s, SD_SPH_WENDLAND, dimension, classes, 0, 0, SD_SPH_INVISCID);
  s->model.scheme = scheme;
  s->model.delta = 0.1;
  fill(s);
}

static const double GENERAL[9] = {0.4, -1.1, 0.3, 0.9, 0.7, -0.2, 0.5, 0.6, -1.3},
                    SPIN[9] = {0.0, -1.1, 0.3, 1.1, 0.0, -0.2, -0.3, 0.2, 0.0},
                    DRIFT[3] = {3.0, -2.0, 1.0}, NONE[3] = {0.0, 0.0, 0.0};

/* The rate of a linear velocity is - rho div v, and the force of a linear pressure - V grad P. */
static void correction_is_exact_for_linear_fields(void **state)
{
  (void) state;
  for (int dimension = 2; dimension <= 3; dimension++)
    for (int classes = 1; classes <= 2; classes++) {
      scene s;
      step t;
      wide_scene(&s, SD_SPH_CORRECTION, dimension, classes);
      linear_velocity(&s, GENERAL, DRIFT);
      const double slope[3] = {300.0, -700.0, dimension == 3 ? 500.0 : 0.0};
      for (int i = 0; i < N; i++) {
        s.rho[i] = 1000.0;
        s.P[i] = 50.0;
        for (int d = 0; d < 3; d++) s.P[i] += slope[d] * s.x[3 * i + d];
      }
      middle_of(&s, &t, 0.1);
      assert_int_equal(t.stops, -1);
      const double divergence = GENERAL[0] + GENERAL[4] + (dimension == 3 ? GENERAL[8] : 0.0);
      force_of(&s, &t);
      for (int i = 0; i < N; i++) {
        CHECK_NEAR(t.rate[i], -1000.0 * divergence, 1e-9);    // of 1e3
        const double V = mass(&s, i) / s.rho[i];
        for (int d = 0; d < dimension; d++)
          CHECK_NEAR(t.f4[4 * i + d] / V, -slope[d], 1e-12 * 7e4);
        /* (G B) du for v = A x + a is A du. */
        for (int d = 0; d < dimension; d++) {
          double expected = 0.0;
          for (int e = 0; e < dimension; e++) expected += GENERAL[3 * d + e] * t.du[4 * i + e];
          CHECK_NEAR(t.kick[3 * i + d], expected, 1e-10);
        }
      }
    }
}

/* A particle with neighbours on one side only is named. */
static void correction_stops_at_a_free_surface(void **state)
{
  (void) state;
  scene s;
  step t;
  wide_scene(&s, SD_SPH_CORRECTION, 2, 1);
  middle_of(&s, &t, 0.1);
  assert_int_equal(t.stops, -1);
  s.x4[4 * 7] += 1.9;    // beyond the others, still in reach
  middle_of(&s, &t, 0.6);
  double largest = 0.0;
  for (int i = 0; i < N; i++) largest = fmax(largest, t.sums[24 * i + 4]);
  assert_true(t.stops >= 0 && largest > 0.6);
}

/* The law of the header, term by term, and that du is no longer than U. */
static void shift_is_the_law(void **state)
{
  (void) state;
  for (int dimension = 2; dimension <= 3; dimension++) {
    scene s;
    step t;
    wide_scene(&s, SD_SPH_SHIFT, dimension, 2);
    for (int i = 0; i < N; i++) s.m[i] *= 4.0;    // M above 0.9 for some
    middle_of(&s, &t, 0.0);
    int moved = 0, bounded = 0;
    for (int i = 0; i < N; i++) {
      double push[3] = {0}, U = 0.0, length = 0.0;
      for (int j = 0; j < N; j++) {
        if (j == i) continue;
        const sd_sph_parameters *k = &s.types[2 * s.cls[i] + s.cls[j]];
        double d[3], r2 = 0.0, vd = 0.0;
        for (int c = 0; c < 3; c++) {
          d[c] = s.x[3 * i + c] - s.x[3 * j + c];
          r2 += d[c] * d[c];
          vd += d[c] * (s.v[3 * i + c] - s.v[3 * j + c]);
        }
        const double r = sqrt(r2), f = sd_sph_W(SD_SPH_WENDLAND, dimension, r, k->h) /
            sd_sph_W(SD_SPH_WENDLAND, dimension, k->deltap, k->h);
        const double g = sd_sph_dW_over_r(SD_SPH_WENDLAND, dimension, r, k->h);
        for (int c = 0; c < 3; c++)
          push[c] += s.m[j] / s.rho[j] * (1.0 + 0.2 * pow(f, 4)) * g * d[c];
        if (r < 2.0 * k->h) U = fmax(U, fabs(vd) / r);
      }
      const double R = 2.0 * s.types[3 * s.cls[i]].h, *du = t.du + 4 * i;
      for (int c = 0; c < 3; c++) length += 25.0 * R * R * push[c] * push[c];
      length = sqrt(length);
      CHECK_NEAR(t.sums[16 * i + SD_SPH_MAXIMUM], U, 1e-12 * U);
      if (du[0] == 0.0) continue;
      moved++;
      bounded += length > 1.0;
      for (int c = 0; c < 3; c++)
        CHECK_NEAR(du[c], -U * 5.0 * R * push[c] / fmax(length, 1.0), 1e-12 * U);
      /* The density goes along: rate = sum + du . grad rho. */
      CHECK_NEAR(t.rate[i] - t.sums[16 * i],
                 du[0] * t.slope[4 * i] + du[1] * t.slope[4 * i + 1] + du[2] * t.slope[4 * i + 2],
                 1e-9 * fabs(t.rate[i]));
    }
    assert_true(moved > 2 && bounded > 0);
  }
}

static void shift_sees_neither_drift_nor_rotation(void **state)
{
  (void) state;
  for (int dimension = 2; dimension <= 3; dimension++) {
    scene s;
    step still, t;
    wide_scene(&s, SD_SPH_SHIFT, dimension, 1);
    s.p.mass *= 4.0;
    middle_of(&s, &still, 0.0);
    for (int i = 0; i < N; i++)
      for (int d = 0; d < dimension; d++) s.v[3 * i + d] += DRIFT[d];
    middle_of(&s, &t, 0.0);
    double largest = 0.0;
    for (int k = 0; k < 4 * N; k++) largest = fmax(largest, fabs(still.du[k]));
    assert_true(largest > 0.01);
    for (int k = 0; k < 4 * N; k++) CHECK_NEAR(t.du[k], still.du[k], 1e-12 * largest);
    linear_velocity(&s, SPIN, NONE);
    middle_of(&s, &t, 0.0);
    for (int k = 0; k < 4 * N; k++) CHECK_NEAR(t.du[k], 0.0, 1e-12);
  }
}

/* Walls are not moved, and do not count in U. */
static void shift_leaves_walls_alone(void **state)
{
  (void) state;
  scene s;
  step t;
  wide_scene(&s, SD_SPH_SHIFT, 2, 1);
  s.p.mass *= 4.0;
  for (int i = 0; i < N; i++) s.phase[i] = i % 3 ? 0 : -1;
  s.p.phase = s.phase;
  linear_velocity(&s, SPIN, NONE);
  for (int i = 0; i < N; i += 3) s.v[3 * i] += 5.0;    // walls that slide past
  middle_of(&s, &t, 0.0);
  for (int i = 0; i < N; i++) {
    if (i % 3 == 0) assert_true(t.du[4 * i] == 0.0 && t.du[4 * i + 1] == 0.0);
    if (i % 3) CHECK_NEAR(t.sums[16 * i + SD_SPH_MAXIMUM], 0.0, 1e-12);
    if (i % 3 == 0) assert_true(t.sums[16 * i + SD_SPH_MAXIMUM] > 1.0);
  }
}

/* Of one fluid du is that of shift alone; a few particles in another fluid have too few of their own
 * around them, and stay where they are. */
static void shift_is_off_at_an_interface(void **state)
{
  (void) state;
  scene s;
  step one, t;
  wide_scene(&s, SD_SPH_SHIFT, 2, 1);
  s.p.mass *= 4.0;
  middle_of(&s, &one, 0.0);
  s.model.scheme = SD_SPH_VOLUME_SHIFT;
  for (int i = 0; i < N; i++) s.phase[i] = 0;
  s.p.phase = s.phase;
  middle_of(&s, &t, 0.0);
  double others = 0.0, few = 0.0;
  for (int i = 0; i < N; i++)
    for (int d = 0; d < 2; d++) {
      CHECK_NEAR(t.du[4 * i + d], one.du[4 * i + d], 1e-13);
      if (i % 6 == 0) few = fmax(few, fabs(t.du[4 * i + d]));
    }
  assert_true(few > 0.01);
  for (int i = 0; i < N; i++) s.phase[i] = i % 6 == 0;
  middle_of(&s, &t, 0.0);
  for (int i = 0; i < N; i++)
    for (int d = 0; d < 2; d++) {
      if (i % 6 == 0) assert_true(t.du[4 * i + d] == 0.0);
      if (i % 6) others = fmax(others, fabs(t.du[4 * i + d]));
    }
  assert_true(others > 0.01);
}

static void shift_keeps_momentum(void **state)
{
  (void) state;
  for (int variant = 0; variant < 4; variant++) {
    const int classes = 1 + variant % 2;
    scene s;
    step t;
    wide_scene(&s, variant / 2 ? SD_SPH_VOLUME_SHIFT : SD_SPH_SHIFT, 3, classes);
    for (int i = 0; i < N; i++) s.m[i] *= 4.0;
    s.p.mass *= 4.0;
    for (int i = 0; i < N; i++) s.P[i] = 0.0;    // the momentum term alone
    middle_of(&s, &t, 0.0);
    force_of(&s, &t);
    assert_true(net(&s, &t, 0) < 1e-13);
  }
}

static void central_friction_keeps_both_momenta(void **state)
{
  (void) state;
  for (int dimension = 2; dimension <= 3; dimension++) {
    scene s;
    step t = {.stops = 0};
    build(&s, SD_SPH_WENDLAND, dimension, 2, 0, 0, SD_SPH_CENTRAL);
    for (int i = 0; i < N; i++) s.P[i] = 0.0;
    force_of(&s, &t);
    assert_true(net(&s, &t, 0) < 1e-13 && net(&s, &t, 1) < 1e-12);
    double largest = 0.0;
    for (int k = 0; k < 4 * N; k++) largest = fmax(largest, fabs(t.f4[k]));
    linear_velocity(&s, SPIN, DRIFT);
    sd_sph_pack_v(N, s.v, s.rho, s.v4);
    force_of(&s, &t);
    for (int i = 0; i < N; i++)
      for (int d = 0; d < 3; d++) CHECK_NEAR(t.f4[4 * i + d], 0.0, 1e-13 * largest);
  }
}

/* With correction, friction has the scalar d.(B_a + B_b) d / 2 r^2 before g; along d with central. A
 * wall has the B of its partner. */
static void corrected_friction(void **state)
{
  (void) state;
  for (int variant = 0; variant < 4; variant++) {
    const int central = variant & 1, walls = variant & 2;
    scene s;
    step t;
    build(&s, SD_SPH_WENDLAND, 3, 2, 0, 0, central ? SD_SPH_CENTRAL : SD_SPH_LAPLACIAN);
    for (int i = 0; i < N; i++) s.phase[i] = walls && i % 4 == 0 ? -1 : 0;
    s.p.phase = s.phase;
    s.model.scheme = SD_SPH_CORRECTION;
    s.model.delta = 0.1;
    fill(&s);
    for (int i = 0; i < N; i++) s.P[i] = 0.0;
    middle_of(&s, &t, 0.0);
    force_of(&s, &t);
    double expected[3] = {0}, size = 0.0;
    const int a = 5;
    for (int b = 0; b < N; b++) {
      if (b == a) continue;
      const sd_sph_parameters *k = &s.types[2 * s.cls[a] + s.cls[b]];
      double d[3], u[3], r2 = 0.0, vd = 0.0, Bd = 0.0;
      for (int c = 0; c < 3; c++) {
        d[c] = s.x[3 * a + c] - s.x[3 * b + c];
        u[c] = s.v[3 * a + c] - s.v[3 * b + c];
        r2 += d[c] * d[c];
        vd += d[c] * u[c];
      }
      const double *mine = t.B + 8 * a, *other = s.phase[b] < 0 ? mine : t.B + 8 * b;
      for (int c = 0; c < 3; c++)
        for (int e = 0; e < 3; e++) {
          const int at = sd_symmetric3_at(c, e);
          Bd += 0.5 * d[c] * d[e] * (mine[at] + other[at]);
        }
      const double g = sd_sph_dW_over_r(SD_SPH_WENDLAND, 3, sqrt(r2), k->h) * Bd / r2;
      const double rub = s.m[a] * s.m[b] * 2.0 * k->mu / (s.rho[a] * s.rho[b]) * g;
      for (int c = 0; c < 3; c++) {
        const double part = central ? rub * 5.0 * vd / (r2 + 0.001 * k->h * k->h) * d[c] : rub * u[c];
        expected[c] += part;
        size += fabs(part);
      }
    }
    for (int c = 0; c < 3; c++) CHECK_NEAR(t.f4[4 * a + c], expected[c], 1e-12 * size);
    assert_true(net(&s, &t, 0) < 1e-12);
    if (central) assert_true(net(&s, &t, 1) < 1e-12);
  }
}

/* The power of the pressure is what compression takes: sum F.v = - sum V P rate / rho; and pressure
 * along d keeps both momenta, whatever the densities. */
static void two_fluids_exchange_energy_exactly(void **state)
{
  (void) state;
  for (int dimension = 2; dimension <= 3; dimension++)
    for (int classes = 1; classes <= 2; classes++) {
      scene s;
      step t;
      wide_scene(&s, SD_SPH_VOLUME, dimension, classes);
      for (int i = 0; i < N; i++) {
        s.phase[i] = i % 2;
        if (i % 2) s.rho[i] *= 1e-3;
      }
      s.p.phase = s.phase;
      middle_of(&s, &t, 0.0);
      force_of(&s, &t);
      double power = 0.0, work = 0.0, size = 0.0;
      for (int i = 0; i < N; i++) {
        for (int d = 0; d < 3; d++) {
          power += t.f4[4 * i + d] * s.v[3 * i + d];
          size += fabs(t.f4[4 * i + d] * s.v[3 * i + d]);
        }
        work -= mass(&s, i) / s.rho[i] * s.P[i] * t.rate[i] / s.rho[i];
      }
      CHECK_NEAR(power, work, 1e-12 * size);
      assert_true(net(&s, &t, 0) < 1e-12 && net(&s, &t, 1) < 1e-12);
    }
}

/* Density diffuses within a fluid only: two uniform fluids stay as they are. */
static void two_fluids_do_not_mix(void **state)
{
  (void) state;
  scene s;
  step t;
  wide_scene(&s, SD_SPH_VOLUME, 2, 1);
  for (int i = 0; i < N; i++) {
    s.phase[i] = i % 2;
    s.rho[i] = i % 2 ? 1.0 : 1000.0;
  }
  s.p.phase = s.phase;
  middle_of(&s, &t, 0.0);
  double rate[N + 1] = {0};
  diffuse(&s, rate);
  for (int i = 0; i < N; i++) CHECK_NEAR(rate[i], 0.0, 1e-12);
  s.rho[4] *= 1.01;
  middle_of(&s, &t, 0.0);
  memset(rate, 0, sizeof(rate));
  diffuse(&s, rate);
  double volume = 0.0;
  for (int i = 0; i < N; i++) volume += s.p.mass / s.rho[i] * rate[i];
  assert_true(rate[4] < 0.0);
  CHECK_NEAR(volume, 0.0, 1e-12 * fabs(rate[4]) * s.p.mass / s.rho[4]);
  for (int i = 1; i < N; i += 2) CHECK_NEAR(rate[i], 0.0, 1e-12);
}

/* Two fluids with correction: the rate is exact for a linear velocity whatever the densities, and the
 * force is the formula, - V_a sum V_b 2 rho_a / (rho_a + rho_b) (P_b - P_a) B_a g d. */
static void two_fluids_with_correction(void **state)
{
  (void) state;
  for (int dimension = 2; dimension <= 3; dimension++)
    for (int classes = 1; classes <= 2; classes++) {
      scene s;
      step t;
      wide_scene(&s, SD_SPH_VOLUME_CORRECTION, dimension, classes);
      linear_velocity(&s, GENERAL, DRIFT);
      for (int i = 0; i < N; i++) {
        s.phase[i] = i % 2;
        s.rho[i] = 1000.0;
        if (i % 2) s.rho[i] *= 0.3;
        s.m[i] *= s.rho[i] / 1000.0;
      }
      s.p.phase = s.phase;
      middle_of(&s, &t, 0.1);
      assert_int_equal(t.stops, -1);
      const double divergence = GENERAL[0] + GENERAL[4] + (dimension == 3 ? GENERAL[8] : 0.0);
      /* M of all fluids is that of one: it does not know of phases */
      force_of(&s, &t);
      for (int i = 0; i < N; i++) {
        CHECK_NEAR(t.rate[i], -s.rho[i] * divergence, 1e-9);
        const double *B = t.B + 8 * i, V = mass(&s, i) / s.rho[i];
        const double rows[3][3] = {{B[0], B[3], B[4]}, {B[3], B[1], B[5]}, {B[4], B[5], B[2]}};
        double expected[3] = {0.0}, size = 0.0;
        for (int j = 0; j < N; j++) {
          if (j == i) continue;
          double d[3], r2 = 0.0;
          for (int c = 0; c < 3; c++) {
            d[c] = s.x[3 * i + c] - s.x[3 * j + c];
            r2 += d[c] * d[c];
          }
          const double g = sd_sph_dW_over_r(SD_SPH_WENDLAND, dimension, sqrt(r2),
                                            s.types[classes > 1 ? 2 * s.cls[i] + s.cls[j] : 0].h);
          const double weight = -V * mass(&s, j) / s.rho[j] * 2.0 * s.rho[i] / (s.rho[i] + s.rho[j]) *
              (s.P[j] - s.P[i]) * g;
          for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) expected[a] += weight * rows[a][b] * d[b];
          size += fabs(weight) * sqrt(r2);
        }
        for (int c = 0; c < dimension; c++) CHECK_NEAR(t.f4[4 * i + c], expected[c], 1e-12 * size);
      }
    }
}

/* Where particles are shifted nobody feels a background P0, neither fluid nor wall. */
static void shift_has_no_background(void **state)
{
  (void) state;
  const double P0 = 1.7e4;
  for (int scheme = SD_SPH_SHIFT; scheme <= SD_SPH_VOLUME_CORRECTION; scheme++) {
    if (scheme == SD_SPH_VOLUME) continue;
    scene s;
    step t;
    wide_scene(&s, (sd_sph_scheme) scheme, 3, 2);
    for (int i = 0; i < N; i++) s.phase[i] = i % 4 == 0 ? -1 : 0;
    s.p.phase = s.phase;
    middle_of(&s, &t, 0.0);
    force_of(&s, &t);
    double more[4 * (N + 1)] = {0}, size = 0.0;
    for (int i = 0; i < N; i++) {
      s.P[i] += P0;
      size = fmax(size, fabs(t.f4[4 * i]));
    }
    sd_sph_pack_pressures(&s.model, N, s.P, P0, s.rho, s.x4);
    forces_of(&s, more);
    for (int i = 0; i < N; i++)
      for (int d = 0; d < 3; d++) CHECK_NEAR(more[4 * i + d], t.f4[4 * i + d], 1e-10 * size);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(correction_is_exact_for_linear_fields),
                                     cmocka_unit_test(correction_stops_at_a_free_surface),
                                     cmocka_unit_test(shift_is_the_law),
                                     cmocka_unit_test(shift_sees_neither_drift_nor_rotation),
                                     cmocka_unit_test(shift_leaves_walls_alone),
                                     cmocka_unit_test(shift_is_off_at_an_interface),
                                     cmocka_unit_test(shift_keeps_momentum),
                                     cmocka_unit_test(central_friction_keeps_both_momenta),
                                     cmocka_unit_test(corrected_friction),
                                     cmocka_unit_test(two_fluids_exchange_energy_exactly),
                                     cmocka_unit_test(two_fluids_do_not_mix),
                                     cmocka_unit_test(two_fluids_with_correction),
                                     cmocka_unit_test(shift_has_no_background)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
