#include "table.h"

#include "sd_linear.h"
#include "sd_shape.h"

static const char *clusters[] = {"doublet",     "trimer_line", "triangle",  "square",
                                 "tetrahedron", "star4",       "tetrapod5", "octahedron",
                                 "hexagon7",    "cube8",       "fcc13",     "helix4_chiral"};
/* rotations and reflections; lines: eight azimuths, two hands, two ways */
static const int orders[] = {32, 32, 12, 16, 24, 12, 24, 48, 24, 48, 48, 2};
enum { N_CLUSTERS = 12, MOST = 64 };

/* y = c + Q x */
static void move(int n, const double *x, const double Q[9], const double c[3], double *y)
{
  for (int k = 0; k < n; k++) {
    sd_multiply3(Q, x + 3 * k, y + 3 * k);
    for (int d = 0; d < 3; d++) y[3 * k + d] += c[d];
  }
}

static void check_proper(const double R[9])
{
  double c[3];
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) CHECK_NEAR(sd_dot(R + 3 * p, R + 3 * q), p == q, 1e-13);
  sd_cross(R, R + 3, c);
  CHECK_NEAR(sd_dot(c, R + 6), 1.0, 1e-13);
}

static void pose_is_a_proper_rotation_that_maps_the_shape(void **state)
{
  (void) state;
  uint64_t seed = 3;
  double x[3 * MOST], a[MOST], y[3 * MOST];
  for (int m = -1; m < N_CLUSTERS; m++)
    for (int trial = 0; trial < 20; trial++) {
      int n = 1;
      if (m < 0) {
        a[0] = 0.7;
        for (int d = 0; d < 3; d++) x[d] = 5.0;
      } else
        n = table_cluster(clusters[m], x, a);
      sd_shape s;
      double Q[9], R[9], c[3], shift[3] = {31.0, -17.0, 0.3 * trial};
      assert_int_equal(sd_shape_create(n, x, a, &s), SD_OK);
      random_rotation(&seed, Q);
      move(n, x, Q, shift, y);
      CHECK_NEAR(sd_shape_pose(&s, y, R, c), 0.0, 1e-13);
      check_proper(R);
      if (s.rank == 2)
        for (int p = 0; p < 9; p++) CHECK_NEAR(R[p], Q[p], 1e-13);
      sd_shape_free(&s);
    }
}

/* Half a turn is where fits by least squares and quaternions have their poles. */
static void pose_survives_half_turns(void **state)
{
  (void) state;
  const double turns[4][9] = {{1, 0, 0, 0, -1, 0, 0, 0, -1},
                              {-1, 0, 0, 0, 1, 0, 0, 0, -1},
                              {-1, 0, 0, 0, -1, 0, 0, 0, 1},
                              {0, 1, 0, 1, 0, 0, 0, 0, -1}};
  const double none[3] = {0, 0, 0};
  double x[3 * MOST], a[MOST], y[3 * MOST], R[9], c[3];
  for (int m = 0; m < N_CLUSTERS; m++) {
    const int n = table_cluster(clusters[m], x, a);
    sd_shape s;
    assert_int_equal(sd_shape_create(n, x, a, &s), SD_OK);
    for (int k = 0; k < 4; k++) {
      move(n, x, turns[k], none, y);
      CHECK_NEAR(sd_shape_pose(&s, y, R, c), 0.0, 1e-14 * s.size);
      check_proper(R);
    }
    sd_shape_free(&s);
  }
}

static void deviation_tells_a_clump_that_is_not_rigid(void **state)
{
  (void) state;
  double x[3 * MOST], a[MOST], R[9], c[3];
  for (int m = 0; m < N_CLUSTERS; m++) {
    const int n = table_cluster(clusters[m], x, a);
    sd_shape s;
    assert_int_equal(sd_shape_create(n, x, a, &s), SD_OK);
    x[3 * (n - 1)] += 0.02 * x[3 * (n - 1)] + 0.01; /* every cluster changes its shape by that */
    x[3 * (n - 1) + 2] += 0.02;
    const double deviation = sd_shape_pose(&s, x, R, c);
    assert_true(deviation > 1e-3 && deviation < 0.05);
    check_proper(R);
    x[1] = NAN;
    assert_true(isinf(sd_shape_pose(&s, x, R, c)));
    sd_shape_free(&s);
  }
}

static void symmetries_map_the_shape_onto_itself(void **state)
{
  (void) state;
  double x[3 * MOST], a[MOST];
  for (int m = 0; m < N_CLUSTERS; m++) {
    const int n = table_cluster(clusters[m], x, a);
    sd_shape s;
    assert_int_equal(sd_shape_create(n, x, a, &s), SD_OK);
    if (s.symmetries != orders[m])
      fail_msg("%s has %d symmetries, expected %d", clusters[m], s.symmetries, orders[m]);
    for (int g = 0; g < s.symmetries; g++)
      for (int k = 0; k < n; k++) {
        double y[3];
        sd_multiply3(s.g + 9 * g, s.x + 3 * k, y);
        for (int d = 0; d < 3; d++) CHECK_NEAR(y[d], s.x[3 * s.perm[n * g + k] + d], 1e-9);
      }
    sd_shape_free(&s);
  }
}

/* Every cluster turned, moved and with its atoms in another order is the same shape; and of no other. */
/* Symmetric ones as well, whose symmetries make several frames as good but for rounding */
static void the_frame_turns_with_the_clump(void **state)
{
  (void) state;
  uint64_t seed = 17;
  double x[3 * MOST], a[MOST], y[3 * MOST];
  for (int m = 0; m < N_CLUSTERS; m++)
    for (int trial = 0; trial < 20; trial++) {
      const int n = table_cluster(clusters[m], x, a);
      const double shift[3] = {3.0, -17.0, 0.3 * trial};
      double Q[9], turned[9];
      sd_shape s, t;
      random_rotation(&seed, Q);
      move(n, x, Q, shift, y);
      assert_int_equal(sd_shape_create(n, x, a, &s), SD_OK);
      assert_int_equal(sd_shape_create(n, y, a, &t), SD_OK);
      sd_product3(Q, s.frame, turned);
      for (int p = 0; p < 9; p++) /* a line has its first axis only */
        if (s.rank == 2 || p % 3 == 0) CHECK_NEAR(t.frame[p], turned[p], 1e-12);
      sd_shape_free(&s);
      sd_shape_free(&t);
    }
}

static void equal_clumps_match_in_any_order(void **state)
{
  (void) state;
  uint64_t seed = 5;
  double x[3 * MOST], a[MOST], y[3 * MOST], z[3 * MOST], b[MOST], scratch[6 * MOST], R[9], c[3];
  int perm[MOST], order[MOST];
  for (int m = 0; m < N_CLUSTERS; m++)
    for (int l = 0; l < N_CLUSTERS; l++) {
      int n = table_cluster(clusters[m], x, a);
      sd_shape s;
      assert_int_equal(sd_shape_create(n, x, a, &s), SD_OK);
      n = table_cluster(clusters[l], x, a);
      for (int trial = 0; trial < 10; trial++) {
        double Q[9];
        const double shift[3] = {3.0, -8.0, 0.1};
        random_rotation(&seed, Q);
        random_order(&seed, n, order);
        move(n, x, Q, shift, y);
        for (int k = 0; k < n; k++) {
          memcpy(z + 3 * k, y + 3 * order[k], sizeof(double) * 3);
          b[k] = a[order[k]];
        }
        const int same = sd_shape_match(&s, n, z, b, perm, scratch);
        if (same != (m == l)) fail_msg("%s and %s: %d", clusters[m], clusters[l], same);
        if (!same) continue;
        for (int k = 0; k < n; k++) memcpy(y + 3 * k, z + 3 * perm[k], sizeof(double) * 3);
        CHECK_NEAR(sd_shape_pose(&s, y, R, c), 0.0, 1e-9);
      }
      sd_shape_free(&s);
    }
}

static void mirror_image_of_a_chiral_clump_is_another_shape(void **state)
{
  (void) state;
  double x[3 * MOST], a[MOST], scratch[6 * MOST];
  int perm[MOST];
  for (int m = 0; m < N_CLUSTERS; m++) {
    const int n = table_cluster(clusters[m], x, a);
    sd_shape s;
    assert_int_equal(sd_shape_create(n, x, a, &s), SD_OK);
    for (int k = 0; k < n; k++) x[3 * k] = -x[3 * k];
    const int same = sd_shape_match(&s, n, x, a, perm, scratch),
              chiral = !strcmp(clusters[m], "helix4_chiral");
    if (same == chiral) fail_msg("%s and its mirror image: %d", clusters[m], same);
    sd_shape_free(&s);
  }
}

static void radii_and_spacing_tell_shapes_apart(void **state)
{
  (void) state;
  const double x[9] = {0, 0, 0, 0, 0, 2, 0, 0, 4.5}, a[3] = {0.9, 1.1, 1.3}, size = 4.6;
  double y[9], b[3], scratch[18];
  int perm[3];
  sd_shape s;
  assert_int_equal(sd_shape_create(3, x, a, &s), SD_OK);
  for (int k = 0; k < 3; k++) { /* from the other end */
    b[k] = a[2 - k];
    for (int d = 0; d < 3; d++) y[3 * k + d] = x[3 * (2 - k) + 2 - d];
  }
  assert_true(sd_shape_match(&s, 3, y, b, perm, scratch));
  assert_true(perm[0] == 2 && perm[1] == 1 && perm[2] == 0);
  b[0] = a[1]; /* radii exchanged */
  b[1] = a[2];
  b[2] = a[0];
  assert_false(sd_shape_match(&s, 3, y, b, perm, scratch));
  memcpy(y, x, sizeof(y));
  y[5] += 0.3 * SD_SHAPE_TOLERANCE * size; /* within and beyond the tolerance */
  assert_true(sd_shape_match(&s, 3, y, a, perm, scratch));
  y[5] += 3.0 * SD_SHAPE_TOLERANCE * size;
  assert_false(sd_shape_match(&s, 3, y, a, perm, scratch));
  assert_false(sd_shape_match(&s, 2, y, a, perm, scratch));
  sd_shape_free(&s);
}

/* Concentric spheres, one sphere, two equal spheres at one point, a sheet with one sphere off it */
static void degenerate_clumps_are_shapes_too(void **state)
{
  (void) state;
  const double x[12] = {1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3}, a[4] = {0.5, 0.7, 0.9, 0.9};
  double R[9], c[3], scratch[24], b[4] = {0.9, 0.5, 0.9, 0.7};
  int perm[4];
  sd_shape s;
  assert_int_equal(sd_shape_create(4, x, a, &s), SD_OK);
  assert_int_equal(s.rank, 0);
  assert_true(sd_shape_match(&s, 4, x, b, perm, scratch));
  for (int k = 0; k < 4; k++) CHECK_NEAR(b[perm[k]], a[k], 0.0);
  CHECK_NEAR(sd_shape_pose(&s, x, R, c), 0.0, 0.0);
  check_proper(R);
  sd_shape_free(&s);
  assert_int_equal(sd_shape_create(4, x, (double[4]){1, 1, -1, 1}, &s), SD_ENOTFINITE);
  assert_int_equal(sd_shape_create(4, (double[12]){[5] = NAN}, a, &s), SD_ENOTFINITE);
  const double bent[9] = {0, 0, 0, 2, 0, 0, 4, 3e-3, 0};
  assert_int_equal(sd_shape_create(3, bent, a, &s), SD_OK);
  assert_int_equal(s.rank, 2);
  CHECK_NEAR(sd_shape_pose(&s, bent, R, c), 0.0, 1e-14);
  sd_shape_free(&s);
}

/* Coordinates as a data file with six digits has them, far from the origin: every cluster keeps its symmetry, is one
 * shape in any orientation and order, and the shape of the exact cluster is that of the rounded one. */
static void six_digits_are_one_shape(void **state)
{
  (void) state;
  uint64_t seed = 29;
  double x[3 * MOST], a[MOST], y[3 * MOST], z[3 * MOST], b[MOST], scratch[6 * MOST];
  int perm[MOST], order[MOST];
  for (int m = 0; m < N_CLUSTERS; m++) {
    const int n = table_cluster(clusters[m], x, a);
    sd_shape exact, rounded;
    assert_int_equal(sd_shape_create(n, x, a, &exact), SD_OK);
    for (int trial = 0; trial < 20; trial++) {
      double Q[9];
      const double shift[3] = {31.0, -48.0, 17.1};
      random_rotation(&seed, Q);
      random_order(&seed, n, order);
      move(n, x, Q, shift, y);
      for (int k = 0; k < n; k++) {
        for (int d = 0; d < 3; d++) {
          char text[24];
          snprintf(text, sizeof(text), "%.6g", y[3 * order[k] + d]);
          z[3 * k + d] = atof(text);
        }
        b[k] = a[order[k]];
      }
      if (!sd_shape_match(&exact, n, z, b, perm, scratch)) fail_msg("%s: rounded", clusters[m]);
      assert_int_equal(sd_shape_create(n, z, b, &rounded), SD_OK);
      assert_int_equal(rounded.rank, exact.rank);
      assert_int_equal(rounded.symmetries, orders[m]);
      assert_true(fabs(sd_shape_size(n, z, b) - exact.size) <= 2.0 * SD_SHAPE_TOLERANCE * exact.size);
      if (!sd_shape_match(&rounded, n, x, a, perm, scratch)) fail_msg("%s: exact", clusters[m]);
      sd_shape_free(&rounded);
    }
    sd_shape_free(&exact);
  }
}

/* What is nearly a line or a point is one, and a shape of itself whatever its azimuth. */
static void nearly_a_line_is_a_line(void **state)
{
  (void) state;
  const double a[3] = {0.5, 0.7, 0.9}, x[9] = {0, 0, 0, 2, 1e-4, 0, 4, 0, 1e-4};
  double R[9], c[3];
  sd_shape s;
  assert_int_equal(sd_shape_create(3, x, a, &s), SD_OK);
  assert_int_equal(s.rank, 1);
  assert_int_equal(s.symmetries, 16);
  assert_true(sd_shape_pose(&s, x, R, c) <= SD_SHAPE_TOLERANCE * s.size);
  sd_shape_free(&s);
}

/* Random clumps have no symmetry, and match themselves however they come. */
static void random_clumps_match_themselves(void **state)
{
  (void) state;
  uint64_t seed = 23;
  double x[3 * MOST], a[MOST], y[3 * MOST], z[3 * MOST], b[MOST], scratch[6 * MOST];
  int perm[MOST], order[MOST];
  for (int trial = 0; trial < 100; trial++) {
    const int n = 3 + (int) uniform(&seed, 0.0, MOST - 3.0);
    for (int k = 0; k < n; k++) {
      a[k] = uniform(&seed, 0.5, 1.0) < 0.7 ? 0.6 : uniform(&seed, 0.5, 1.0);
      for (int d = 0; d < 3; d++) x[3 * k + d] = uniform(&seed, -4.0, 4.0);
    }
    sd_shape s;
    double Q[9];
    const double shift[3] = {3.0, -8.0, 0.1};
    assert_int_equal(sd_shape_create(n, x, a, &s), SD_OK);
    assert_int_equal(s.symmetries,
                     1 + (n == 3)); /* three centres have their own plane as a mirror */
    random_rotation(&seed, Q);
    random_order(&seed, n, order);
    move(n, x, Q, shift, y);
    for (int k = 0; k < n; k++) {
      memcpy(z + 3 * k, y + 3 * order[k], sizeof(double) * 3);
      b[k] = a[order[k]];
    }
    assert_true(sd_shape_match(&s, n, z, b, perm, scratch));
    for (int k = 0; k < n; k++) assert_int_equal(order[perm[k]], k);
    sd_shape_free(&s);
  }
}

/* Whether or not its spheres are looked at one by one: with what there is below, at and above the largest of them. */
static void the_fastest_sphere_is_found_whatever_there_is(void **state)
{
  (void) state;
  uint64_t seed = 29;
  double x[3 * MOST], a[MOST];
  for (int m = 0; m < N_CLUSTERS; m++) {
    const int n = table_cluster(clusters[m], x, a);
    double from[3], U[3], W[3], largest = 0.0;
    sd_shape s;
    for (int k = 0; k < n; k++) a[k] *= uniform(&seed, 0.8, 1.2);
    assert_int_equal(sd_shape_create(n, x, a, &s), SD_OK);
    for (int d = 0; d < 3; d++) {
      from[d] = uniform(&seed, -0.5, 0.5);
      U[d] = uniform(&seed, -1.0, 1.0);
      W[d] = uniform(&seed, -1.0, 1.0);
    }
    for (int k = 0; k < n; k++) {
      double arm[3], v[3];
      sd_minus(s.x + 3 * k, from, arm);
      sd_cross(W, arm, v);
      for (int d = 0; d < 3; d++) v[d] += U[d];
      largest = fmax(largest, sd_dot(v, v) / (s.a[k] * s.a[k]));
    }
    for (double part = 0.0; part < 3.0; part += 0.25)
      CHECK_NEAR(sd_shape_fastest(&s, from, U, W, part * largest), fmax(part, 1.0) * largest, 1e-13 * largest);
    sd_shape_free(&s);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pose_is_a_proper_rotation_that_maps_the_shape),
      cmocka_unit_test(pose_survives_half_turns),
      cmocka_unit_test(deviation_tells_a_clump_that_is_not_rigid),
      cmocka_unit_test(symmetries_map_the_shape_onto_itself),
      cmocka_unit_test(the_frame_turns_with_the_clump),
      cmocka_unit_test(equal_clumps_match_in_any_order),
      cmocka_unit_test(mirror_image_of_a_chiral_clump_is_another_shape),
      cmocka_unit_test(radii_and_spacing_tell_shapes_apart),
      cmocka_unit_test(degenerate_clumps_are_shapes_too),
      cmocka_unit_test(six_digits_are_one_shape),
      cmocka_unit_test(nearly_a_line_is_a_line),
      cmocka_unit_test(random_clumps_match_themselves),
      cmocka_unit_test(the_fastest_sphere_is_found_whatever_there_is),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
