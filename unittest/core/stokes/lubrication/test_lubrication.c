/* Lubrication: sd_lubrication.h. What a pair alone must be, where the sum must be continuous, that it
 * is positive whatever the packing, and that images count as spheres do. */
#include "near_scene.h"
#include "pair_blocks.h"

#include "sd_constants.h"
#include "sd_linear.h"
#include "sd_lubrication_internal.h"
#include "sd_two_sphere_exact.h"

/* 1.3: viscosity, so that no factor is 1 */
static const double eta = 1.3;

static near_scene pair_at(double xi, double a2)
{
  const double d[3] = {0.48, -0.6, 0.64}, R = (1.0 + a2) * (1.0 + 0.5 * xi);
  scene s = scene_create(2);
  scene_set(&s, 0, 0.2, 0.3, -0.1, 1.0, eta);
  scene_set(&s, 1, 0.2 + R * d[0], 0.3 + R * d[1], -0.1 + R * d[2], a2, eta);
  return near_create(s, 10.0, 1e-4);
}

/* M^-1 + L of two spheres is their exact resistance, up to half the range; tables give 1e-7. */
static void a_pair_alone_is_exact(void **state)
{
  (void) state;
  static const double gaps[] = {1e-4, 1e-3, 0.03, 0.3, 0.99}, radii[] = {1.0, 0.5, 2.0, 5.0};
  for (int k = 0; k < 5; k++)
    for (int l = 0; l < 4; l++) {
      const double a2 = radii[l], gap = gaps[k] * 0.5 * (1.0 + a2);
      near_scene q = pair_at(gaps[k], a2);
      near_place(&q);
      double *R = dense_mobility(&q.s), *L = near_dense(&q), exact[4][36];
      const sd_pair_resistance e = sd_two_sphere_exact(1.0, a2, gap, NULL);
      const double d[3] = {0.48, -0.6, 0.64};
      pair_blocks(&e, d, exact[0], exact[1], exact[3]);
      for (int p = 0; p < 6; p++)
        for (int c = 0; c < 6; c++) exact[2][6 * c + p] = exact[1][6 * p + c];
      assert_int_equal(sd_cholesky(12, R), SD_OK);
      assert_int_equal(sd_cholesky_inverse(12, R), SD_OK);
      for (int i = 0; i < 12; i++)
        for (int j = 0; j < 12; j++) {
          const double expected = eta * exact[2 * (i / 6) + j / 6][6 * (i % 6) + j % 6];
          CHECK_NEAR(R[12 * i + j] + L[12 * i + j], expected,
                     1e-5 * 6.0 * SD_PI * eta * pow(fmax(1.0, a2), 3));
        }
      memset(exact[1], 0, sizeof(exact[1]));
      sd_lubrication_add_block(q.L.link, exact[1]);
      for (int p = 0; p < 6; p++)
        for (int c = 0; c < 6; c++)
          CHECK_NEAR(exact[1][6 * p + c], L[12 * p + 6 + c], 1e-13 * fabs(L[12 * p + 6 + c]));
      free(R), free(L);
      near_free(&q);
    }
}

/* The largest entry of L; of its difference between two gaps */
static double change(double xi, double further)
{
  double most = 0.0, *L[2];
  for (int k = 0; k < 2; k++) {
    near_scene q = pair_at(k ? further : xi, 1.7);
    near_place(&q);
    L[k] = near_dense(&q);
    near_free(&q);
  }
  for (int e = 0; e < 144; e++) most = fmax(most, fabs(L[0][e] - L[1][e]));
  free(L[0]), free(L[1]);
  return most;
}

/* No jump at contact, at the floor, at half the range, where t begins to fall, and at its end:
 * what two gaps differ by falls with their distance. */
static void gaps_change_it_without_a_jump(void **state)
{
  (void) state;
  static const double at[] = {0.0, 1e-4, 1.0, 2.0};
  for (int k = 0; k < 4; k++) {
    const double h = at[k] > 0.5 ? 1e-5 : 1e-8, one = change(at[k] - h, at[k] + h),
                 two = change(at[k] - 0.01 * h, at[k] + 0.01 * h);
    assert_true(two < 0.05 * one + 1e-7);
  }
  assert_true(change(-0.3, 1e-4 * (1 - 1e-12)) < 1e-6); /* overlaps count as the floor */
  assert_true(change(2.0, 2.5) == 0.0);
  assert_true(change(0.1, 0.2) > 1.0);
}

/* Smallest eigenvalue over the largest, of the symmetric L [(6n)^2] scaled to Stokes drags: by the
 * shift at which a factor exists. */
static void check_positive(const near_scene *q, const double *L)
{
  const int N = 6 * q->s.n;
  double *copy = malloc(sizeof(double) * (size_t) (N * N)), largest = 0.0;
  for (int i = 0; i < N; i++)
    for (int j = 0; j < N; j++) {
      CHECK_NEAR(L[i * N + j], L[j * N + i], 1e-9 * fabs(L[i * N + j]) + 1e-12);
      const double ai = q->s.a[i / 6], aj = q->s.a[j / 6];
      copy[i * N + j] = L[i * N + j] / sqrt((i % 6 < 3 ? 6.0 * ai : 8.0 * ai * ai * ai) *
                                            (j % 6 < 3 ? 6.0 * aj : 8.0 * aj * aj * aj));
    }
  for (int i = 0; i < N; i++) {
    double row = 0.0;
    for (int j = 0; j < N; j++) row += fabs(copy[i * N + j]);
    largest = fmax(largest, row);
  }
  /* 1e-8 of the largest: tables err by 1e-7 Stokes drags, floors allow 1e4 of them */
  assert_true(positive_definite(copy, N, -1e-8 * largest));
  free(copy);
}

static void it_resists_every_motion(void **state)
{
  (void) state;
  for (int k = 0; k < 100; k++) {
    near_scene q = near_create(cloud_dense(12, 0.1 + 0.004 * k, 1.0, 1.0 + 0.04 * k, eta, 17 + k), 5.0, 1e-4);
    for (int i = 0; i < 12; i++) q.s.w[i] = 1.0 / sqrt(eta * (1.0 + 0.1 * (i % 3)));
    near_place(&q);
    assert_true(q.L.count > 0);
    double *L = near_dense(&q);
    check_positive(&q, L);
    free(L);
    near_free(&q);
  }
}

/* The sum over the pairs of q with any p D + (1 - p) Q^T D Q, and any t >= 0 */
static double *dense_of_any_shares(const near_scene *q, uint64_t *seed)
{
  const int N = 6 * q->s.n;
  double *L = calloc((size_t) (N * N), sizeof(double)), d[3], B[3][36];
  for (long k = 0; k < q->L.count; k++) {
    const int i = q->L.pair[k][0], j = q->L.pair[k][1];
    const double ai = q->s.a[i], aj = q->s.a[j], t = uniform(seed, 0.0, 1.0);
    const double p = k % 3 ? uniform(seed, 0.0, 1.0) : k % 2;
    sd_minus(q->s.x + 3 * j, q->s.x + 3 * i, d);
    const double xi = fmax(2.0 * (sqrt(sd_dot(d, d)) / (ai + aj) - 1.0), q->gap);
    sd_normalize(d);
    sd_pair_resistance R;
    assert_int_equal(sd_two_sphere_correction(q->functions, ai, aj, xi, t * p, t * (1.0 - p), &R), SD_OK);
    pair_blocks(&R, d, B[0], B[1], B[2]);
    for (int r = 0; r < 6; r++)
      for (int c = 0; c < 6; c++) {
        L[(6 * i + r) * N + 6 * i + c] += B[0][6 * r + c];
        L[(6 * j + r) * N + 6 * j + c] += B[2][6 * r + c];
        L[(6 * i + r) * N + 6 * j + c] += B[1][6 * r + c];
        L[(6 * j + c) * N + 6 * i + r] += B[1][6 * r + c];
      }
  }
  return L;
}

/* Whatever the rule by which pairs share their common motion */
static void any_shares_resist_every_motion(void **state)
{
  (void) state;
  uint64_t seed = 8;
  for (int k = 0; k < 100; k++) {
    near_scene q = near_create(cloud_dense(12, 0.1 + 0.004 * k, 1.0, 1.0 + 0.04 * k, eta, 23 + k), 5.0, 1e-4);
    near_place(&q);
    assert_true(q.L.count > 0);
    double *L = dense_of_any_shares(&q, &seed);
    check_positive(&q, L);
    free(L);
    near_free(&q);
  }
}

/* Spheres of one body, not 0, have none between them. */
static void none_within_a_body(void **state)
{
  (void) state;
  near_scene q = pair_at(0.01, 1.0);
  q.body[0] = q.body[1] = -7;
  near_place(&q);
  assert_int_equal(q.L.count, 0);
  q.body[1] = 7;
  near_place(&q);
  assert_int_equal(q.L.count, 1);
  q.body[0] = q.body[1] = 0;
  near_place(&q);
  assert_int_equal(q.L.count, 1);
  q.body[0] = 1LL << 53; /* a double rounds both to the same number */
  q.body[1] = q.body[0] + 1;
  near_place(&q);
  assert_int_equal(q.L.count, 1);
  near_free(&q);
}

/* Common motion is shared: a sphere with six neighbours resists a translation of all of them with
 * less than each pair would, and a relative one in full. */
static void neighbours_share_the_common_motion(void **state)
{
  (void) state;
  scene s = scene_create(7);
  scene_set(&s, 0, 0, 0, 0, 1.0, eta);
  for (int k = 0; k < 6; k++)
    scene_set(&s, 1 + k, (k == 0) * 2.02 - (k == 1) * 2.02, (k == 2) * 2.02 - (k == 3) * 2.02,
              (k == 4) * 2.02 - (k == 5) * 2.02, 1.0, eta);
  near_scene q = near_create(s, 1.0, 1e-4), p = pair_at(0.02, 1.0);
  near_place(&q);
  near_place(&p);
  double V[42] = {0}, f[42], V2[12] = {0}, f2[12], W[42] = {0};
  for (int i = 0; i < 7; i++) V[6 * i] = 1.0;
  for (int d = 0; d < 3; d++) V2[d] = V2[6 + d] = d == 0 ? 0.48 : d == 1 ? -0.6 : 0.64;
  assert_int_equal(sd_lubrication_apply(&q.L, V, f), SD_OK);
  assert_int_equal(sd_lubrication_apply(&p.L, V2, f2), SD_OK);
  const double alone = f2[0] * V2[0] + f2[1] * V2[1] + f2[2] * V2[2];
  assert_true(f[0] > 0.0 && f[0] < 6.0 * 0.5 * alone);
  /* squeezed from both sides along x: two pairs, each with all that it has */
  W[6] = -1.0, W[12] = 1.0;
  for (int d = 0; d < 3; d++) V2[6 + d] = 0.0;
  assert_int_equal(sd_lubrication_apply(&q.L, W, f), SD_OK);
  assert_int_equal(sd_lubrication_apply(&p.L, V2, f2), SD_OK);
  const double squeeze = -(f2[6] * V2[0] + f2[7] * V2[1] + f2[8] * V2[2]);
  assert_true(-f[6] > 0.97 * squeeze);
  near_free(&q);
  near_free(&p);
}

/* A fluid that moves and turns as a rigid body takes spheres along: L V - carried is that of V less its
 * motion. One that strains does not move two spheres that keep their distance: nothing as stiff as the
 * film is in it. */
static void a_flow_takes_pairs_along(void **state)
{
  (void) state;
  near_scene q = near_create(cloud_dense(12, 0.4, 1.0, 3.0, eta, 5), 5.0, 1e-4);
  double u[72], f[72];
  for (int i = 0; i < 12; i++) {
    const double W[3] = {0.3, -0.2, 0.5}, *x = q.s.x + 3 * i;
    sd_cross(W, x, u + 6 * i);
    for (int d = 0; d < 3; d++) {
      u[6 * i + d] += d + 0.1;
      u[6 * i + 3 + d] = W[d];
    }
  }
  q.u = u;
  near_place(&q);
  assert_int_equal(sd_lubrication_apply(&q.L, u, f), SD_OK);
  double largest = 0.0;
  for (int j = 0; j < 72; j++) {
    CHECK_NEAR(f[j], q.L.carried[j], 1e-7); /* of stiff films */
    largest = fmax(largest, fabs(f[j]));
  }
  assert_true(largest > 1.0);
  near_free(&q);

  near_scene pair = pair_at(1e-4, 1.0);
  double strain[12] = {0};
  for (int i = 0; i < 2; i++)
    for (int d = 0; d < 3; d++) strain[6 * i + d] = (d < 2 ? 1.0 : -2.0) * pair.s.x[3 * i + d];
  pair.u = strain;
  near_place(&pair);
  for (int j = 0; j < 12; j++) assert_true(fabs(pair.L.carried[j]) < 3.0);
  assert_int_equal(sd_lubrication_apply(&pair.L, strain, f), SD_OK);
  assert_true(fabs(f[0]) > 1e3);
  near_free(&pair);
}

/* Films lose (V_inf - V).L (V_inf - V) >= 0 in any flow at any motion: the power of the forces, and that
 * of the strain. A pair that moves as the fluid does has the second alone; a rigid flow has none. */
static void films_in_a_strain_lose_power(void **state)
{
  (void) state;
  near_scene q = near_create(cloud_dense(12, 0.4, 1.0, 3.0, eta, 5), 5.0, 1e-3);
  const double G[9] = {0.4, 1.1, -0.3, 0.2, 0.5, 0.7, -0.6, 0.1, -0.9};
  double u[72], V[72], f[72], power[12];
  for (int i = 0; i < 12; i++) {
    const double *x = q.s.x + 3 * i;
    sd_multiply3(G, x, u + 6 * i);
    u[6 * i + 3] = 0.5 * (G[7] - G[5]);
    u[6 * i + 4] = 0.5 * (G[2] - G[6]);
    u[6 * i + 5] = 0.5 * (G[3] - G[1]);
  }
  q.u = u;
  near_place(&q);
  double losses[3], least = INFINITY;
  for (int way = 0; way < 3; way++) { /* with the fluid; along and against the forces */
    for (int j = 0; j < 72; j++) V[j] = u[j] + (way ? (way == 1 ? 1e-3 : -1e-3) * f[j] : 0.0);
    if (!way) assert_int_equal(sd_lubrication_forces(&q.L, V, f), SD_OK);
    double F[72];
    assert_int_equal(sd_lubrication_forces(&q.L, V, F), SD_OK);
    sd_lubrication_strain_power(&q.L, V, power);
    losses[way] = 0.0;
    for (int i = 0; i < 12; i++) losses[way] += power[i];
    for (int j = 0; j < 72; j++) losses[way] += F[j] * (u[j] - V[j]);
    least = fmin(least, losses[way]);
  }
  assert_true(least > 0.0);
  /* a quadratic form in V: along and against differ by twice the linear part, which is 2 |f|^2 1e-3 */
  double square = 0.0;
  for (int j = 0; j < 72; j++) square += f[j] * f[j];
  CHECK_NEAR(losses[2] - losses[1], 4e-3 * square, 1e-9 * square);
  near_free(&q);
}

/* Two spheres of masses m1, m2 lose their approach at the rate XA (1/m1 + 1/m2). */
static void the_fastest_rate_is_that_of_the_film(void **state)
{
  (void) state;
  near_scene q = pair_at(1e-3, 2.0);
  near_place(&q);
  sd_pair_resistance full;
  assert_int_equal(sd_two_sphere_correction(q.functions, 1.0, 2.0, 1e-3, 1.0, 0.0, &full), SD_OK);
  const double W[12] = {0.3, 0.3, 0.3, 9.0, 9.0, 9.0, 0.7, 0.7, 0.7, 9.0, 9.0, 9.0};
  double v[12], work[12], rate;
  for (int j = 0; j < 12; j++) v[j] = 1.0 + 0.1 * j;
  assert_int_equal(sd_lubrication_rate(&q.L, W, v, work, &rate), SD_OK);
  const double expected = eta * (full.XA[0] / 0.3 + full.XA[2] / 0.7);
  CHECK_NEAR(rate, expected, 2e-3 * expected); /* XA_12 is not quite -XA_11 */
  near_free(&q);
}

/* --- images --- */

/* A row along x that repeats itself: this rank's spheres, and copies to either side. */
typedef struct {
  int n, copies;
} repeats;

static sd_status from_originals(void *ctx, const double *rows, double *images, int width)
{
  const repeats *r = ctx;
  for (int g = 0; g < r->copies; g++)
    memcpy(images + width * g, rows + width * (g % r->n), sizeof(double) * (size_t) width);
  return SD_OK;
}

/* n spheres in a period with their images are as many of them as stand within reach, all of which move
 * alike: also a single one, which meets only itself. */
static void images_count_as_spheres(void **state)
{
  (void) state;
  for (int n = 1; n <= 3; n++) {
    const double period = 2.1 * n + 0.3;
    enum { SIDES = 3 };
    const int all = n * (2 * SIDES + 1);
    repeats r = {n, all - n};
    near_scene q = near_create(scene_create(all), 1.0, 1e-3), full = near_create(scene_create(all), 1.0, 1e-3);
    for (int k = 0, at = 0; k <= 2 * SIDES; k++)
      for (int i = 0; i < n; i++, at++) {
        const double shift = period * (k == 0 ? 0 : k <= SIDES ? k : SIDES - k);
        scene_set(&q.s, at, 2.1 * i + shift, 0.1 * i, 0.2 * i * i, 1.0, eta);
        scene_set(&full.s, at, 2.1 * i + shift, 0.1 * i, 0.2 * i * i, 1.0, eta);
      }
    sd_lubrication_scene where = near_where(&q);
    where.n = n;
    where.world = (sd_world){.ctx = &r, .me = 0, .ranks = 1, .refresh = from_originals};
    assert_int_equal(sd_lubrication_place(&q.L, &where), SD_OK);
    near_place(&full);
    double V[6 * 21], f[6 * 21], g[6 * 21];
    for (int j = 0; j < 6 * all; j++) V[j] = sin(1.0 + j % (6 * n));
    assert_int_equal(sd_lubrication_apply(&q.L, V, f), SD_OK);
    assert_int_equal(sd_lubrication_apply(&full.L, V, g), SD_OK);
    for (int j = 0; j < 6 * n; j++) CHECK_NEAR(f[j], g[j], 1e-10);
    near_free(&q);
    near_free(&full);
  }
}

/* out += B V */
static void add_times(const double B[36], const double *V, double *out)
{
  for (int e = 0; e < 36; e++) out[e / 6] += B[e] * V[e % 6];
}

/* The sums of (L + X) V with springs c, written out with blocks, against those of each instruction set */
static void all_instructions_make_the_same_product(void **state)
{
  (void) state;
  enum { N = 40, WIDTH = 6 * N };
  near_scene q = near_create(cloud_dense(N, 0.4, 1.0, 1.0, eta, 3), 1.0, 1e-3);
  near_place(&q);
  const sd_lubrication *L = &q.L;
  double V[WIDTH], own[WIDTH], expected[WIDTH] = {0.0}, out[WIDTH], largest = 0.0;
  double *c = malloc(sizeof(double) * (size_t) L->count);
  uint64_t seed = 7;
  for (int j = 0; j < WIDTH; j++) V[j] = uniform(&seed, -1, 1), own[j] = uniform(&seed, 0, 1);
  for (int i = 0; i < N; i++) {
    double B[36];
    sd_lubrication_own_block(L, i, B);
    add_times(B, V + 6 * i, expected + 6 * i);
    for (int e = 0; e < 9; e++)
      expected[6 * i + e / 3] += own[6 * i + sd_symmetric3_at(e / 3, e % 3)] * V[6 * i + e % 3];
  }
  for (long k = 0; k < L->count; k++) {
    double B[36] = {0.0}, turned[36];
    sd_lubrication_link link = L->link[k];
    c[k] = uniform(&seed, 0, 1);
    link.XA -= c[k];
    sd_lubrication_add_block(&link, B);
    for (int e = 0; e < 36; e++) turned[e] = B[6 * (e % 6) + e / 6];
    add_times(B, V + 6 * L->pair[k][1], expected + 6 * L->pair[k][0]);
    add_times(turned, V + 6 * L->pair[k][0], expected + 6 * L->pair[k][1]);
  }
  for (int j = 0; j < WIDTH; j++) largest = fmax(largest, fabs(expected[j]));
  assert_true(L->count > N);
  for (sd_isa isa = SD_ISA_PLAIN; isa <= SD_ISA_AVX512; isa++) {
    if (!sd_isa_supported(isa)) continue;
    SD_KERNELS_OF(sd_lubrication, plain, isa)->times(L, own, c, V, out);
    for (int j = 0; j < WIDTH; j++) CHECK_NEAR(out[j], expected[j], 1e-14 * largest);
  }
  free(c);
  near_free(&q);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_pair_alone_is_exact),
      cmocka_unit_test(gaps_change_it_without_a_jump),
      cmocka_unit_test(it_resists_every_motion),
      cmocka_unit_test(any_shares_resist_every_motion),
      cmocka_unit_test(none_within_a_body),
      cmocka_unit_test(neighbours_share_the_common_motion),
      cmocka_unit_test(a_flow_takes_pairs_along),
      cmocka_unit_test(films_in_a_strain_lose_power),
      cmocka_unit_test(the_fastest_rate_is_that_of_the_film),
      cmocka_unit_test(images_count_as_spheres),
      cmocka_unit_test(all_instructions_make_the_same_product),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
