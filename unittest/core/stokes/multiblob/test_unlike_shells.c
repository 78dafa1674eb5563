/* Half shells, spheres of unlike numbers of points, and the inverse of a shell in blocks. */
#include "blobs.h"

#include "sd_mirrored.h"
#include "sd_multiblob_shape.h"

/* The blocks are the inverse: of a random right side, M times the answer is it again; and an eighth of the
 * numbers. */
static void inverse_in_blocks(void **state)
{
  (void) state;
  const int numbers[3] = {12, 42, 162};
  uint64_t seed = 11;
  for (int c = 0; c < 3; c++) {
    const int n = numbers[c], N = 3 * n;
    sd_multiblob m;
    sd_mirrored blocks;
    double axes[9], b[162], y[486], z[486], *M = malloc(sizeof(double) * (size_t) N * (size_t) N);
    assert_int_equal(n == 12 ? sd_multiblob_create(n, 1, &m) : sd_multiblob_create_half(n, 1, &m), SD_OK);
    for (int k = 0; k < n; k++) b[k] = m.point;
    sd_wall_matrix(NULL, n, 3, m.r, b, M);
    sd_multiblob_one_body_matrix(&m, 1.0, m.r, (size_t) N, M);
    sd_multiblob_axes(axes);
    assert_int_equal(sd_mirrored_create(n, m.r, axes, M, &blocks), SD_OK);
    int all = 0;
    long stored = 0;
    for (int parity = 0; parity < 8; parity++) {
      all += blocks.size[parity];
      stored += (long) blocks.size[parity] * blocks.size[parity];
    }
    assert_int_equal(all, N);
    assert_true(stored < (long) N * N / 7);
    for (int j = 0; j < N; j++) y[j] = uniform(&seed, -1, 1);
    sd_mirrored_apply(&blocks, y, z);
    for (int i = 0; i < N; i++) {
      double back = 0.0;
      for (int j = 0; j < N; j++) back += M[i * N + j] * z[j];
      CHECK_NEAR(back, y[i], 1e-11);
    }
    sd_mirrored_free(&blocks);
    /* points that are no mirror images */
    m.r[0] *= 1.01;
    assert_int_equal(sd_mirrored_create(n, m.r, axes, M, &blocks), SD_EOUTSIDE);
    free(M);
  }
}

/* The lone sphere of every half shell: drag, rotation and stresslet exact with the addition, and the shape's
 * numbers say so, those of 642 points in blocks. */
static void lone_half_shells_are_exact(void **state)
{
  (void) state;
  const int numbers[3] = {42, 162, 642};
  for (int c = 0; c < 3; c++) {
    sd_multiblob m;
    sd_multiblob_shape lone;
    assert_int_equal(sd_multiblob_create_half(numbers[c], 1, &m), SD_OK);
    assert_int_equal(sd_multiblob_shape_create(&m, NULL, NULL, &lone), SD_OK);
    assert_true((lone.points.mirrored != NULL) == (numbers[c] == 642));
    for (int p = 0; p < 6; p++)
      for (int q = 0; q < 6; q++) {
        const double exact = p != q ? 0.0 : p < 3 ? 6.0 * SD_PI : 8.0 * SD_PI;
        CHECK_NEAR(lone.points.resistance[6 * p + q] / (6.0 * SD_PI), exact / (6.0 * SD_PI), 1e-8);
      }
    /* a strain is seen as itself */
    const double E[9] = {0.2, 0.5, -0.1, 0.5, -0.3, 0.7, -0.1, 0.7, 0.1};
    double u[3 * 642], v[SD_FACES_WIDTH];
    for (int k = 0; k < m.n; k++) sd_multiply3(E, m.r + 3 * k, u + 3 * k);
    const sd_faces_pattern pattern = {m.n, lone.faces};
    const sd_faces faces = {&pattern, NULL, NULL, NULL, NULL};
    sd_faces_read(&faces, 1, u, v);
    const double expected[SD_FACES_WIDTH] = {0, 0, 0, E[0], E[4], E[8], E[1], E[2], E[5]};
    for (int e = 0; e < SD_FACES_WIDTH; e++) CHECK_NEAR(v[e], expected[e], 1e-8);
    sd_multiblob_shape_free(&lone);
  }
  sd_multiblob m;
  assert_int_equal(sd_multiblob_create_half(12, 1, &m), SD_EOUTSIDE);
}

/* Rows of spheres of unlike numbers of points are those of each sphere by itself; masks know all of the
 * points. */
static void rows_by_offset(void **state)
{
  (void) state;
  static sd_multiblob m[4];
  const double x[9] = {0.1, 0.2, 0.3, 5.0, 4.0, 3.0, -7.0, 1.0, 2.0}, a[3] = {0.3, 1.7, 0.8}, w[3] = {1.0, 0.5, 2.0};
  const int kind[3] = {0, 3, 1}, first[4] = {0, 12, 654, 696};
  assert_int_equal(sd_multiblob_create(12, 1, m), SD_OK);
  for (int k = 1; k < 4; k++)
    assert_int_equal(sd_multiblob_create_half(k == 1 ? 42 : k == 2 ? 162 : 642, 1, m + k), SD_OK);
  sd_multiblob_mask mask[3];
  for (int i = 0; i < 3; i++) mask[i] = sd_multiblob_whole(m + kind[i]);
  mask[1].word[10] = 0; /* points from 639 on */
  const sd_multiblob_spheres all = {x, a, NULL, mask, 3, kind, first};
  double r[3 * 696], at[3 * 696], b[696], f[3 * 696], u[3 * 696] = {0.0};
  sd_multiblob_expand(m, &all, r, at, b);
  uint64_t seed = 3;
  for (int j = 0; j < 3 * 696; j++) f[j] = uniform(&seed, -1, 1);
  sd_multiblob_add(&(sd_multiblob_additions){m, all, w, r}, 0, 3, f, u);
  for (int i = 0; i < 3; i++) {
    const sd_multiblob *of = m + kind[i];
    const sd_multiblob_spheres one = {x + 3 * i, a + i, NULL, NULL, 1, NULL, NULL};
    double own[3 * 642], there[3 * 642], radius[642], moved[3 * 642] = {0.0};
    sd_multiblob_expand(of, &one, own, there, radius);
    sd_multiblob_add(&(sd_multiblob_additions){of, one, w + i, own}, 0, 1, f + 3 * first[i], moved);
    for (int k = 0; k < of->n; k++)
      assert_true(b[first[i] + k] == (i == 1 && k >= 639 ? 0.0 : radius[k]));
    assert_memory_equal(at + 3 * first[i], there, sizeof(double) * 3 * (size_t) of->n);
    assert_memory_equal(u + 3 * first[i], moved, sizeof(double) * 3 * (size_t) of->n);
  }
}

/* Moments about a centre that is an arm further on lack those of what the points of a sphere exert together, at that
 * arm: of spheres of any number of points, one of which has none. */
static void moments_go_with_forces(void **state)
{
  (void) state;
  enum { SPHERES = 4, ROWS = 17 };
  static const int first[SPHERES + 1] = {0, 5, 5, 6, ROWS};
  const double d[3] = {0.7, -1.3, 2.1};
  double arm[3 * SPHERES], r[3 * ROWS], from[3 * ROWS], f[3 * ROWS];
  double F[3 * SPHERES] = {0}, S[6 * SPHERES] = {0}, moved[6 * SPHERES] = {0};
  uint64_t seed = 8;
  for (int j = 0; j < 3 * ROWS; j++) {
    r[j] = uniform(&seed, -1, 1);
    f[j] = uniform(&seed, -1, 1);
    from[j] = r[j] - (j < 3 * first[1] ? 1.0 : -0.4) * d[j % 3];
  }
  for (int j = 0; j < 3 * SPHERES; j++) arm[j] = (j < 3 ? 1.0 : -0.4) * d[j % 3];
  sd_multiblob_forces(SPHERES, first, f, F);
  sd_multiblob_moments(SPHERES, first, r, f, S);
  sd_multiblob_moments(SPHERES, first, from, f, moved);
  sd_multiblob_moments_at(SPHERES, arm, F, moved);
  for (int e = 0; e < 6 * SPHERES; e++) CHECK_NEAR(moved[e], S[e], 1e-13);
  for (int e = 6; e < 12; e++) CHECK_NEAR(S[e], 0.0, 0.0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(inverse_in_blocks),
      cmocka_unit_test(lone_half_shells_are_exact),
      cmocka_unit_test(rows_by_offset),
      cmocka_unit_test(moments_go_with_forces),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
