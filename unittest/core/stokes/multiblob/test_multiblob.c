/* A lone sphere as a shell of points, and its points. */
#include "blobs.h"

#include "table.h"

#include "sd_multiblob_shape.h"

enum { MOST = 3 * 42 };

/* Over exact: with the forces of the motion g_k V, which is the pressure mode as it passes a sphere that moves with the
 * exact Faxen velocity, a free one moves at -R_01/R_00 more. */
typedef struct {
  double drag, rotation, stresslet, faxen, pressure_gradient;
} lone_numbers;

/* What the lone sphere of radius a and viscosity eta has over exact, from its whole matrix, in
 * direction and plane e */
static lone_numbers numbers_of(int n, int one_body, double a, double eta, int e)
{
  sd_multiblob m;
  double r[MOST], b[SD_MULTIBLOB_MOST], v[5][MOST], f[5][MOST], R[5][5] = {{0.0}}, unit[MOST],
                                                                column[MOST];
  static double M[MOST * MOST];
  assert_int_equal(sd_multiblob_create(n, one_body, &m), SD_OK);
  const int N = 3 * n, p = (e + 1) % 3;
  for (int k = 0; k < N; k++) r[k] = a * m.r[k], b[k / 3] = a * m.point;
  sd_wall_matrix(NULL, n, 3, r, b, M);
  for (int k = 0; k < N * N; k++) M[k] /= eta;
  for (int j = 0; j < N; j++) {
    for (int k = 0; k < N; k++) unit[k] = k == j, column[k] = 0.0;
    sd_multiblob_one_body(&m, a, eta, r, unit, column);
    for (int k = 0; k < N; k++) M[N * k + j] += column[k];
  }
  memset(v, 0, sizeof v);
  for (int k = 0; k < n; k++) {
    const double *x = r + 3 * k, turn[3] = {e == 0, e == 1, e == 2};
    v[0][3 * k + e] = 1.0;
    sd_cross(turn, x, v[1] + 3 * k);
    v[2][3 * k + e] = x[p], v[2][3 * k + p] = x[e];
    /* u_G of G = 1 along e, with b^2/6 of its Laplacian, 1 along e */
    for (int d = 0; d < 3; d++)
      v[3][3 * k + d] =
          (2.0 * sd_dot(x, x) * (d == e) - x[d] * x[e]) / 10.0 + (d == e) * b[0] * b[0] / 6.0;
  }
  memcpy(f, v, sizeof f);
  assert_int_equal(sd_cholesky_solve(N, M, 1, f[0]), SD_OK);
  for (int c = 1; c < 4; c++) sd_cholesky_apply(N, M, 1, f[c]);
  for (int c = 0; c < 4; c++)
    for (int g = 0; g < 4; g++)
      for (int k = 0; k < N; k++) R[c][g] += v[c][k] * f[g][k];
  const double moves = R[0][3] / R[0][0], stokes = eta * a;
  return (lone_numbers){
      R[0][0] / (6.0 * SD_PI * stokes), R[1][1] / (8.0 * SD_PI * stokes * a * a),
      R[2][2] / (40.0 / 3.0 * SD_PI * stokes * a * a), 6.0 * moves / (a * a),
      (R[3][3] - moves * R[0][3]) / (2.0 / 15.0 * SD_PI * stokes * pow(a, 4))};
}

/* The table: drag and rotation exact, the others 0.999153, 0.992570, 0.765891 with 12 points. */
static void points_alone(void **state)
{
  (void) state;
  int rows = 0;
  table t = table_open("multiblob/lone_shell.csv");
  while (table_next(&t)) {
    sd_multiblob m;
    rows++;
    const int n = (int) table_number(&t, 0);
    assert_int_equal(sd_multiblob_create(n, 0, &m), SD_OK);
    CHECK_NEAR(m.radius, table_number(&t, 1), 1e-10);
    CHECK_NEAR(m.point, table_number(&t, 2), 1e-10);
    for (int e = 0; e < 3; e++) {
      const lone_numbers l = numbers_of(n, 0, 1.7, 0.6, e);
      const double five[5] = {l.drag, l.rotation, l.stresslet, l.faxen, l.pressure_gradient};
      for (int k = 0; k < 5; k++) CHECK_NEAR(five[k], table_number(&t, 3 + k), 1e-6);
      CHECK_NEAR(l.drag, 1.0, 1e-12);
      CHECK_NEAR(l.rotation, 1.0, 1e-12);
    }
  }
  assert_int_equal(rows, 2);
}

/* All five are those of a sphere, whatever its radius, the viscosity, and the direction. */
static void exact_with_the_addition(void **state)
{
  (void) state;
  for (int n = 12; n <= 42; n += 30)
    for (int e = 0; e < 3; e++) {
      const lone_numbers l = numbers_of(n, 1, 0.3, 2.3, e);
      CHECK_NEAR(l.drag, 1.0, 1e-12);
      CHECK_NEAR(l.rotation, 1.0, 1e-12);
      CHECK_NEAR(l.stresslet, 1.0, 1e-12);
      CHECK_NEAR(l.faxen, 1.0, 1e-12);
      CHECK_NEAR(l.pressure_gradient, 1.0, 1e-12);
    }
}

/* Free spheres stand as icosahedron.csv has them. */
static void orientation_in_the_laboratory(void **state)
{
  (void) state;
  sd_multiblob m;
  int rows = 0;
  assert_int_equal(sd_multiblob_create(12, 1, &m), SD_OK);
  table t = table_open("multiblob/icosahedron.csv");
  for (; table_next(&t); rows++) {
    double least = 9.0;
    for (int k = 0; k < 12; k++) {
      double off = 0.0;
      for (int d = 0; d < 3; d++) off += fabs(m.r[3 * k + d] / m.radius - table_number(&t, 4 + d));
      least = fmin(least, off);
    }
    CHECK_NEAR(least, 0.0, 1e-13);
  }
  assert_int_equal(rows, 12);
  assert_int_equal(sd_multiblob_create(13, 1, &m), SD_EOUTSIDE);
}

/* Spheres of a clump that touch keep all their points; those that overlap lose the hidden ones
 * and the addition. */
static void points_inside_another_member(void **state)
{
  (void) state;
  sd_multiblob m;
  sd_shape touching, fused;
  sd_multiblob_mask mask[2];
  const double a[2] = {1.0, 1.0}, x[6] = {0, 0, 0, 1.2, 1.6, 0}, y[6] = {0, 0, 0, 0.6, 0.3, 0.0};
  assert_int_equal(sd_multiblob_create(42, 1, &m), SD_OK);
  assert_int_equal(sd_shape_create(2, x, a, &touching), SD_OK);
  assert_int_equal(sd_shape_create(2, y, a, &fused), SD_OK);
  const sd_multiblob_mask whole = sd_multiblob_whole(&m);
  sd_multiblob_masks(&m, NULL, &touching, touching.frame, mask);
  for (int i = 0; i < 2; i++) assert_memory_equal(mask + i, &whole, sizeof whole);
  sd_multiblob_masks(&m, NULL, &fused, fused.frame, mask);
  for (int i = 0; i < 2; i++) {
    int left = 0;
    assert_true(!sd_multiblob_mask_is_whole(mask + i));
    for (int k = 0; k < 42; k++) left += sd_multiblob_has_point(mask + i, k);
    assert_true(left > 21 && left < 42); /* 0.67 apart: more than half of each is outside */
  }
  sd_shape_free(&touching);
  sd_shape_free(&fused);
}

/* All points of a clump of n equal spheres at x [3n], which are looked at in their order or in the opposite one */
static void points_of_clump(const sd_multiblob *m, int n, const double *x, int backwards, double *points)
{
  const double unity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  double y[3 * 4], a[4] = {1.0, 1.0, 1.0, 1.0}, pose[9], turn[9];
  for (int k = 0; k < n; k++) memcpy(y + 3 * k, x + 3 * (backwards ? n - 1 - k : k), 3 * sizeof(double));
  sd_shape clump;
  sd_multiblob_shape shape;
  assert_int_equal(sd_shape_create(n, y, a, &clump), SD_OK);
  assert_int_equal(sd_multiblob_shape_create(m, &clump, NULL, &shape), SD_OK);
  sd_multiblob_shape_stand(&shape, unity, pose, turn);
  for (int k = 0; k < n * m->n; k++) {
    sd_multiply3(turn, m->r + 3 * (k % m->n), points + 3 * k);
    for (int d = 0; d < 3; d++) points[3 * k + d] += clump.x[3 * (k / m->n) + d];
  }
  sd_multiblob_shape_free(&shape);
  sd_shape_free(&clump);
}

/* Clumps that half a turn or a mirror maps onto themselves: two, a row, an S, a bent row, four at corners of a
 * rectangle, and four without symmetry. With points elsewhere the loads of the S's members differ by 30 %. */
static void points_of_a_clump_do_not_know_the_order_of_its_members(void **state)
{
  (void) state;
  static const struct {
    int n;
    double x[12];
  } clump[] = {{2, {0, 0, 0, 0.5, 1.1, -1.6}},
               {3, {0, 0, 0, 0.3, 1.1, -1.6, 0.6, 2.2, -3.2}},
               {4, {0, 0, 0, 0.8, -0.6, 0.5, 1.6, -1.2, 2.2, 2.4, -1.8, 2.7}},
               {3, {0, 0, 0, 1.5, 1.2, 0.2, 3, 1, -1}},
               {4, {0, 0, 0, 2, 0.5, 0, 1.5, 2.5, 0.7, -0.5, 2, 0.7}},
               {4, {0, 0, 0, 2, 0.5, 0, 1.5, 2.5, 0.7, -0.5, 2, 1.9}}};
  sd_multiblob m;
  assert_int_equal(sd_multiblob_create(12, 1, &m), SD_OK);
  for (int c = 0; c < 6; c++) {
    const int n = clump[c].n * m.n;
    double p[3 * 48], q[3 * 48];
    points_of_clump(&m, clump[c].n, clump[c].x, 0, p);
    points_of_clump(&m, clump[c].n, clump[c].x, 1, q);
    for (int k = 0; k < n; k++) {
      double least = 9.0;
      for (int l = 0; l < n; l++) least = fmin(least, sd_distance_squared(p + 3 * k, q + 3 * l));
      CHECK_NEAR(sqrt(least), 0.0, 1e-12);
    }
  }
}

/* A force on each point whose first moment about the centre is known; no force and no torque in
 * a strain. */
static void moments_in_a_strain(void **state)
{
  (void) state;
  const double x[3] = {0.4, -2.0, 1.1}, a = 1.4,
               E[9] = {0.2, 0.5, -0.1, 0.5, -0.3, 0.7, -0.1, 0.7, 0.1};
  double V[6], S[6];
  blobs *s = blobs_create(12, 1, 1, x, &a);
  blobs_open(s);
  blobs_factor(s);
  blobs_resistance(s);
  assert_int_equal(sd_cholesky(6, s->R), SD_OK);
  blobs_move(s, NULL, E, V, S);
  /* exact: -20/3 pi a^3 E; forces act on the fluid, which the sphere keeps from straining */
  const double unit = -20.0 / 3.0 * SD_PI * pow(a, 3),
               expected[6] = {E[0], E[4], E[8], E[1], E[2], E[5]};
  for (int e = 0; e < 6; e++) {
    CHECK_NEAR(V[e], 0.0, 1e-12);
    CHECK_NEAR(S[e] / unit, expected[e], 1e-12);
  }
  /* a simple shear turns it with half its rate */
  const double G[9] = {0, 0.8, 0, 0, 0, 0, 0, 0, 0};
  blobs_move(s, NULL, G, V, S);
  CHECK_NEAR(V[5], -0.4, 1e-12);
  blobs_free(s);
}

/* A rigid motion of a sphere is seen as its velocity and no strain, a strain as itself, turned as
 * they may be; and what is pushed is the transpose of what is read. */
static void faces_see_motion_and_strain(void **state)
{
  (void) state;
  const double a = 1.7, U[3] = {0.4, -1.1, 0.3}, W[3] = {0.7, 0.2, -0.9},
               E[9] = {0.2, 0.5, -0.1, 0.5, -0.3, 0.7, -0.1, 0.7, 0.1};
  uint64_t seed = 5;
  for (int n = 12; n <= 42; n += 30) {
    sd_multiblob m;
    sd_multiblob_shape lone;
    double turn[9], u[MOST], l[MOST] = {0.0}, v[SD_FACES_WIDTH], f[SD_FACES_WIDTH], by_v = 0, by_u = 0;
    assert_int_equal(sd_multiblob_create(n, 1, &m), SD_OK);
    assert_int_equal(sd_multiblob_shape_create(&m, NULL, NULL, &lone), SD_OK);
    random_rotation(&seed, turn);
    for (int k = 0; k < n; k++) {
      double r[3], spin[3], strain[3];
      sd_multiply3(turn, m.r + 3 * k, r);
      for (int d = 0; d < 3; d++) r[d] *= a;
      sd_cross(W, r, spin);
      sd_multiply3(E, r, strain);
      for (int d = 0; d < 3; d++) u[3 * k + d] = U[d] + spin[d] + strain[d];
    }
    const sd_faces_pattern pattern = {n, lone.faces};
    const sd_faces faces = {&pattern, turn, NULL, NULL, NULL};
    sd_faces_read(&faces, 1, u, v);
    const double expected[SD_FACES_WIDTH] = {U[0],     U[1],     U[2],     a * E[0], a * E[4],
                                             a * E[8], a * E[1], a * E[2], a * E[5]};
    for (int e = 0; e < SD_FACES_WIDTH; e++) CHECK_NEAR(v[e], expected[e], 1e-12);
    for (int e = 0; e < SD_FACES_WIDTH; e++) {
      f[e] = uniform(&seed, -1, 1);
      by_v += f[e] * v[e];
    }
    sd_faces_push(&faces, 1, f, l);
    for (int j = 0; j < 3 * n; j++) by_u += l[j] * u[j];
    CHECK_NEAR(by_u, by_v, 1e-12);
    const char none = 0;
    const sd_faces without = {&pattern, turn, &none, NULL, NULL};
    sd_faces_read(&without, 1, u, v);
    for (int e = 0; e < SD_FACES_WIDTH; e++) assert_true(v[e] == 0.0);
    sd_multiblob_shape_free(&lone);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(points_alone),
      cmocka_unit_test(exact_with_the_addition),
      cmocka_unit_test(orientation_in_the_laboratory),
      cmocka_unit_test(points_inside_another_member),
      cmocka_unit_test(points_of_a_clump_do_not_know_the_order_of_its_members),
      cmocka_unit_test(moments_in_a_strain),
      cmocka_unit_test(faces_see_motion_and_strain),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
