/* Gradients of a flow. */
#include "check.h"

#include "sd_box_flow.h"
#include "sd_flow_points.h"
#include "sd_linear.h"

#include <math.h>
#include <string.h>

/* A fluid that turns like a rigid body, with a strain that must not show */
static const double TURN[3] = {0.7, -1.9, 2.3};
static const double G[9] = {0.4, 1.1 - 2.3, -0.6 - 1.9, 1.1 + 2.3, -0.9, 0.3 - 0.7,
                            -0.6 + 1.9, 0.3 + 0.7, 0.5};

static void rigid_fluid_turns_at_its_rate(void **state)
{
  (void) state;
  double w[3];
  sd_flow_rotation(G, w);
  for (int d = 0; d < 3; d++) CHECK_NEAR(w[d], TURN[d], 1e-15);
}

static void given_vorticity_leaves_the_strain(void **state)
{
  (void) state;
  const double vorticity[3] = {3.1, 0.2, -1.7};
  double other[9], w[3];
  memcpy(other, G, sizeof(other));
  sd_flow_set_vorticity(vorticity, other);
  sd_flow_rotation(other, w);
  for (int d = 0; d < 3; d++) CHECK_NEAR(w[d], 0.5 * vorticity[d], 1e-15);
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++)
      CHECK_NEAR(other[3 * p + q] + other[3 * q + p], G[3 * p + q] + G[3 * q + p], 1e-15);
}

/* u = 2 x + 5 x^2 + 4 x^3 at x = 0.3: the slope, and 4 a^2 more */
static void slope_of_a_cubic_is_off_by_its_radius_squared(void **state)
{
  (void) state;
  const double x = 0.3, a[3] = {0.2, 0.1, 0.0};
  const double exact = 2.0 + 10.0 * x + 12.0 * x * x;
  for (int i = 0; i < 3; i++) {
    const double p = x + a[i], m = x - a[i];
    const double slope = sd_flow_slope(2.0 * p + 5.0 * p * p + 4.0 * p * p * p,
                                       2.0 * m + 5.0 * m * m + 4.0 * m * m * m, a[i]);
    CHECK_NEAR(slope, a[i] > 0.0 ? exact + 4.0 * a[i] * a[i] : 0.0, 1e-13);
  }
}

/* Points at fixed fractions of a cell move with the flow of the cell: G (H s) = (dH/dt) s. A cell
 * whose edge c is taken as c + 2 a - b has the same lattice, and the same flow. */
static void flow_of_a_cell_moves_its_edges(void **state)
{
  (void) state;
  const double h[6] = {3.1, 2.3, 4.7, 0.9, -1.3, 0.6}, rate[6] = {0.2, -0.5, 0.4, 0.7, -0.3, 1.1};
  const double s[3] = {0.3, -0.7, 1.9};
  double G[9], other[9], x[3], v[3];
  sd_flow_of_cell(h, rate, G);
  const double *of[2] = {h, rate};
  for (int k = 0; k < 2; k++) {
    double *out = k ? v : x;
    out[0] = of[k][0] * s[0] + of[k][5] * s[1] + of[k][4] * s[2];
    out[1] = of[k][1] * s[1] + of[k][3] * s[2];
    out[2] = of[k][2] * s[2];
  }
  for (int p = 0; p < 3; p++)
    CHECK_NEAR(G[3 * p] * x[0] + G[3 * p + 1] * x[1] + G[3 * p + 2] * x[2], v[p], 1e-14);
  double chosen[2][6];
  for (int k = 0; k < 2; k++) {
    for (int e = 0; e < 6; e++) chosen[k][e] = of[k][e];
    chosen[k][3] -= of[k][1];
    chosen[k][4] += 2.0 * of[k][0] - of[k][5];
  }
  sd_flow_of_cell(chosen[0], chosen[1], other);
  for (int k = 0; k < 9; k++) CHECK_NEAR(other[k], G[k], 1e-14);
}

/* u_p of a cubic flow about x, by its derivatives there */
static double cubic(const double u, const double g[3], const double K[6], const double r[3])
{
  const double third = 0.7 * r[0] * r[0] * r[1] - 1.1 * r[0] * r[1] * r[2] + 0.4 * r[2] * r[2] * r[2];
  return u + g[0] * r[0] + g[1] * r[1] + g[2] * r[2] +
      0.5 * (K[0] * r[0] * r[0] + K[1] * r[1] * r[1] + K[2] * r[2] * r[2]) + K[3] * r[0] * r[1] +
      K[4] * r[0] * r[2] + K[5] * r[1] * r[2] + third;
}

static void second_differences_of_a_cubic_flow_are_exact(void **state)
{
  (void) state;
  const double g[3] = {0.3, -1.2, 0.8}, K[6] = {0.9, -0.4, 1.7, 0.6, -1.5, 0.35}, h = 0.37;
  double bend[SD_FLOW_DIRECTIONS], H[6];
  for (int e = 0; e < SD_FLOW_DIRECTIONS; e++) {
    const double *d = sd_flow_around[e];
    const double r[3] = {h * d[0], h * d[1], h * d[2]}, back[3] = {-r[0], -r[1], -r[2]};
    bend[e] = cubic(1.3, g, K, r) + cubic(1.3, g, K, back) - 2.0 * 1.3;
  }
  sd_flow_curvature(bend, h, H);
  for (int e = 0; e < 6; e++) CHECK_NEAR(H[e], K[e], 1e-13);
}

/* Faxen: the mean over a ball's surface. Of a quadratic flow it is that of the corners of a cube. */
static void a_bent_flow_carries_a_sphere_with_its_mean(void **state)
{
  (void) state;
  const double H[SD_FLOW_SECOND] = {0.9,  -0.4, 1.7, 0.6, -1.5, 0.35, 0.2, 0.8, -0.3,
                                    -0.7, 1.2,  0.1, 1.4, -0.6, 0.5,  0.3, 0.9, -1.1};
  const double r[3] = {0.6, -0.5, 1.1}, b = 0.8, corner = b / sqrt(3.0);
  double out[3] = {0.5, 0.0, 0.0}, mean[3] = {0.5, 0.0, 0.0};
  sd_flow_bend(H, r, b, out);
  for (int k = 0; k < 8; k++) {
    double x[3], u[3] = {0.0};
    for (int d = 0; d < 3; d++) x[d] = r[d] + (k >> d & 1 ? corner : -corner);
    sd_flow_bend(H, x, 0.0, u);
    for (int d = 0; d < 3; d++) mean[d] += u[d] / 8.0;
  }
  for (int d = 0; d < 3; d++) CHECK_NEAR(out[d], mean[d], 1e-14);
}

/* Of one quadratic flow it does not matter which sphere tells of it: points move as the flow carries them where they
 * are, of shells of any size. */
static void points_go_with_a_quadratic_flow(void **state)
{
  (void) state;
  static const double H[SD_FLOW_SECOND] = {0.9,  -0.4, 1.7, 0.6, -1.5, 0.35, 0.2, 0.8, -0.3,
                                           -0.7, 1.2,  0.1, 1.4, -0.6, 0.5,  0.3, 0.9, -1.1};
  static sd_multiblob model[2];
  const double X[6] = {0.3, -1.1, 0.7, 2.0, 1.4, -0.6}, a[2] = {1.2, 0.5}, w[2] = {1.0, 1.0};
  const int kind[2] = {1, 0}, first[3] = {0, 42, 54};
  double r[3 * 54], x[3 * 54], b[54], u[3 * 54], velocity[8], gradient[18], second[2 * SD_FLOW_SECOND];
  assert_int_equal(sd_multiblob_create(12, 1, &model[0]), SD_OK);
  assert_int_equal(sd_multiblob_create(42, 1, &model[1]), SD_OK);
  const sd_multiblob_spheres spheres = {X, a, NULL, NULL, 2, kind, first};
  sd_multiblob_expand(model, &spheres, r, x, b);
  for (int i = 0; i < 2; i++) {
    const double *c = X + 3 * i;
    memset(velocity + 4 * i, 0, 3 * sizeof(double));
    sd_flow_bend(H, c, 0.0, velocity + 4 * i);
    for (int p = 0; p < 3; p++) { /* xx yy zz xy xz yz */
      const double *K = H + 6 * p;
      gradient[9 * i + 3 * p] = K[0] * c[0] + K[3] * c[1] + K[4] * c[2];
      gradient[9 * i + 3 * p + 1] = K[3] * c[0] + K[1] * c[1] + K[5] * c[2];
      gradient[9 * i + 3 * p + 2] = K[4] * c[0] + K[5] * c[1] + K[2] * c[2];
    }
    memcpy(second + SD_FLOW_SECOND * i, H, sizeof(H));
  }
  const sd_multiblob_additions points = {model, spheres, w, r};
  const sd_flow_spheres bent = {velocity, 4, gradient, second}, straight = {velocity, 4, gradient, NULL};
  sd_flow_at_points(&points, &bent, u);
  for (int k = 0; k < 54; k++) {
    double there[3] = {0.0};
    sd_flow_bend(H, x + 3 * k, b[k], there);
    for (int d = 0; d < 3; d++) CHECK_NEAR(u[3 * k + d], there[d], 1e-13);
  }
  sd_flow_at_points(&points, &straight, u);
  for (int k = 0; k < 54; k++)
    for (int d = 0; d < 3; d++) {
      const double *G = gradient + 9 * (k >= 42) + 3 * d, *from = r + 3 * k;
      CHECK_NEAR(u[3 * k + d], velocity[4 * (k >= 42) + d] + sd_dot(G, from), 1e-14);
    }
}

/* A box of skew edges, and one that grows, shears and drifts */
static const sd_box BOX = {{-1.5, 0.4, 2.2}, {3.1, 2.3, 4.7, 0.9, -1.3, 0.6}};
static const sd_box_flow DRIFT = {{0.2, -0.7, 0.3, 0.0, -0.1, 0.5, 0.0, 0.0, 0.4}, {-1.5, 0.4, 2.2}, {1.1, -0.2, 0.7}};

/* Points at fixed fractions of the box are carried by the flow, for a short time t: x + t u(x) stands at the same
 * fractions of the later box, exactly, as edges change evenly. */
static void a_later_box_has_its_points_where_the_flow_takes_them(void **state)
{
  (void) state;
  const double t = 0.3;
  const sd_box then = sd_box_later(&DRIFT, &BOX, t);
  const int corner[3] = {1, -2, 3};
  double x[3], end[3], u[3];
  memcpy(x, BOX.lo, sizeof(x));
  memcpy(end, then.lo, sizeof(end));
  sd_add_edges(BOX.h, corner, x);
  sd_add_edges(then.h, corner, end);
  sd_box_flow_at(&DRIFT, x, u);
  for (int d = 0; d < 3; d++) CHECK_NEAR(x[d] + t * u[d], end[d], 1e-13);
}

/* Whoever goes with the flow keeps his place in the box; a body and its image, whose velocities differ by the flow's,
 * end an edge of the later box apart. Where nothing is carried a step is t V. */
static void steps_in_a_box_are_the_same_for_all_images(void **state)
{
  (void) state;
  const double t = 0.2, V[3] = {0.7, -1.3, 0.4}, x[3] = {0.2, 1.1, 3.3};
  const int edges[3] = {1, -1, 2};
  const sd_box then = sd_box_later(&DRIFT, &BOX, t);
  sd_step_in_box s = {t, 1, BOX, BOX, then, DRIFT};
  double u[3], step[3], f[3], there[3], r[3];
  sd_box_flow_at(&DRIFT, x, u);
  sd_step_in_box_of(&s, u, x, x, step);
  for (int d = 0; d < 3; d++) r[d] = x[d] - BOX.lo[d];
  sd_in_edges(BOX.h, r, f);
  for (int d = 0; d < 3; d++) r[d] = x[d] + step[d] - then.lo[d];
  sd_in_edges(then.h, r, there);
  for (int d = 0; d < 3; d++) CHECK_NEAR(there[d], f[d], 1e-14);

  double image[3], its_V[3], its_step[3], apart[3] = {0.0};
  memcpy(image, x, sizeof(image));
  sd_add_edges(BOX.h, edges, image);
  sd_box_flow_at(&DRIFT, image, its_V);
  for (int d = 0; d < 3; d++) its_V[d] += V[d] - u[d];
  sd_step_in_box_of(&s, V, x, x, step);
  sd_step_in_box_of(&s, its_V, image, image, its_step);
  sd_add_edges(then.h, edges, apart);
  for (int d = 0; d < 3; d++) CHECK_NEAR(image[d] + its_step[d] - x[d] - step[d], apart[d], 1e-13);

  s.carried = 0;
  sd_step_in_box_of(&s, V, x, x, step);
  for (int d = 0; d < 3; d++) CHECK_NEAR(step[d], t * V[d], 0.0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rigid_fluid_turns_at_its_rate),
      cmocka_unit_test(given_vorticity_leaves_the_strain),
      cmocka_unit_test(slope_of_a_cubic_is_off_by_its_radius_squared),
      cmocka_unit_test(flow_of_a_cell_moves_its_edges),
      cmocka_unit_test(second_differences_of_a_cubic_flow_are_exact),
      cmocka_unit_test(a_bent_flow_carries_a_sphere_with_its_mean),
      cmocka_unit_test(points_go_with_a_quadratic_flow),
      cmocka_unit_test(a_later_box_has_its_points_where_the_flow_takes_them),
      cmocka_unit_test(steps_in_a_box_are_the_same_for_all_images),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
