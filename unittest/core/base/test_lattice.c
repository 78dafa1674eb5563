/* Images of a periodic box. */
#include "check.h"

#include "sd_lattice.h"

#include <string.h>

static const int all[3] = {1, 1, 1};

static double square(const double d[3])
{
  return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

/* Against all images up to four cells away, in boxes tilted by up to the whole of their edges, open in some
   directions */
static void image_is_the_closest(void **state)
{
  (void) state;
  uint64_t seed = 83;
  for (int trial = 0; trial < 300; trial++) {
    double h[6], d[3], image[3], best = INFINITY;
    int periodic[3];
    for (int k = 0; k < 3; k++) h[k] = uniform(&seed, 3.0, 6.0);
    periodic[2] = periodic[1] = periodic[0] = 1;
    if (trial % 3 == 1) periodic[trial / 3 % 3] = 0;
    h[3] = trial % 2 && periodic[1] && periodic[2] ? uniform(&seed, -1.0, 1.0) * h[1] : 0.0;
    h[4] = trial % 2 && periodic[0] && periodic[2] ? uniform(&seed, -1.0, 1.0) * h[0] : 0.0;
    h[5] = trial % 2 && periodic[0] && periodic[1] ? uniform(&seed, -1.0, 1.0) * h[0] : 0.0;
    for (int k = 0; k < 3; k++) d[k] = uniform(&seed, -5.0, 5.0);
    memcpy(image, d, sizeof(image));
    sd_closest_image(h, periodic, image);
    for (int i = -6 * periodic[0]; i <= 6 * periodic[0]; i++)
      for (int j = -4 * periodic[1]; j <= 4 * periodic[1]; j++)
        for (int k = -4 * periodic[2]; k <= 4 * periodic[2]; k++)
          best = fmin(best, square((double[3]){d[0] - i * h[0] - j * h[5] - k * h[4],
                                               d[1] - j * h[1] - k * h[3], d[2] - k * h[2]}));
    CHECK_NEAR(square(image), best, 1e-10);
  }
}

/* 2^60 boxes away every digit that tells where is still there; beyond, whatever comes out is in the box, and comes at
   once. */
static void far_away_is_no_loop(void **state)
{
  (void) state;
  const double h[6] = {4.0, 8.0, 16.0, 0.0, 0.0, 0.0}, skew[6] = {4.0, 8.0, 16.0, 3.0, -1.0, 1.5};
  double d[3] = {0x1p62 + 0x1p12, -0x1p60, 3.0};
  sd_closest_image(h, all, d);
  CHECK_NEAR(d[0], 0.0, 0.0);
  CHECK_NEAR(d[1], 0.0, 0.0);
  CHECK_NEAR(d[2], 3.0, 0.0);
  for (double far = 1e15; far < 1e308; far *= 1e10) {
    double e[3] = {far, -0.7 * far, 0.3 * far};
    sd_closest_image(skew, all, e);
    assert_true(square(e) < 400.0);
  }
  double nowhere[3] = {INFINITY, NAN, -INFINITY};
  sd_closest_image(skew, all, nowhere);
  double open[3] = {1e300, 1.0, 9.0};
  sd_closest_image(h, (int[3]){0, 1, 1}, open);
  assert_true(open[0] == 1e300 && open[2] == -7.0);
}

/* A place that is brought close is its image so many edges away, and edges are 1 in units of edges. */
static void steps_and_edges_agree(void **state)
{
  (void) state;
  const double h[6] = {4.0, 5.0, 6.0, 1.1, -0.7, 1.9}, to[3] = {0.3, -0.2, 0.9};
  uint64_t seed = 89;
  for (int trial = 0; trial < 100; trial++) {
    double x[3], was[3], f[3];
    int steps[3];
    for (int d = 0; d < 3; d++) was[d] = x[d] = uniform(&seed, -30.0, 30.0);
    sd_bring_close(h, all, to, x, steps);
    assert_true(square((double[3]){x[0] - to[0], x[1] - to[1], x[2] - to[2]}) < 30.0);
    sd_add_edges(h, steps, was);
    for (int d = 0; d < 3; d++) CHECK_NEAR(x[d], was[d], 1e-12);
    sd_in_edges(h, (double[3]){3 * h[0] - 2 * h[5] + h[4], -2 * h[1] + h[3], h[2]}, f);
    CHECK_NEAR(f[0], 3.0, 1e-14);
    CHECK_NEAR(f[1], -2.0, 1e-14);
    CHECK_NEAR(f[2], 1.0, 1e-14);
  }
}

/* Faces are as far apart as the volume is large for their area. */
static void faces_are_volume_over_area_apart(void **state)
{
  (void) state;
  const double h[6] = {4.0, 5.0, 6.0, 1.1, -0.7, 1.9}, V = h[0] * h[1] * h[2];
  const double a[3] = {h[0], 0.0, 0.0}, b[3] = {h[5], h[1], 0.0}, c[3] = {h[4], h[3], h[2]};
  const double *other[3][2] = {{b, c}, {c, a}, {a, b}};
  for (int d = 0; d < 3; d++) {
    const double *p = other[d][0], *q = other[d][1];
    const double normal[3] = {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2],
                              p[0] * q[1] - p[1] * q[0]};
    CHECK_NEAR(sd_across_faces(h, d, 2.0), 2.0 * sqrt(square(normal)) / V, 1e-14);
  }
}

static void edges_of(const double h[6], const int steps[3], double x[3])
{
  x[0] = x[1] = x[2] = 0.0;
  sd_add_edges(h, steps, x);
}

/* A simple shear of rate g moves the fluid by S(dt) x, and a displacement by what the shear does in the half
 * step that is left: S(dt) x + S(dt/2) move. */
static void shear_carries_a_move_for_half_a_step(void **state)
{
  (void) state;
  const double g = 0.7, dt = 0.3, move[3] = {0.2, -0.5, 0.4}, lo[3] = {-1.5, 2.0, 0.7};
  sd_box box[3];
  for (int k = 0; k < 3; k++) {
    const double h[6] = {4.0, 5.0, 6.0, 0.0, 0.0, 0.3 + 5.0 * g * 0.5 * k * dt};
    memcpy(box[k].lo, lo, sizeof(lo));
    memcpy(box[k].h, h, sizeof(h));
  }
  double x[3] = {3.0, -1.1, 2.2};
  const double height = x[1] - lo[1];
  sd_box_step(&box[0], &box[1], &box[2], move, x);
  CHECK_NEAR(x[0], 3.0 + g * dt * height + move[0] + 0.5 * g * dt * move[1], 1e-14);
  CHECK_NEAR(x[1], -1.1 + move[1], 1e-14);
  CHECK_NEAR(x[2], 2.2 + move[2], 1e-14);
}

/* An image stays one: whatever the box does, both go so that the edges between them are those of then. */
static void image_of_a_point_stays_its_image(void **state)
{
  (void) state;
  const sd_box start = {{0.1, -3.0, 2.0}, {4.0, 5.0, 6.0, 1.1, -0.7, 1.9}},
               middle = {{0.3, -3.5, 2.1}, {4.2, 4.7, 6.1, 1.3, -0.2, 2.1}},
               end = {{0.6, -4.1, 1.8}, {4.5, 4.3, 6.3, 1.2, 0.4, 2.5}};
  const int steps[3] = {2, -1, 3};
  const double move[3] = {0.4, 0.3, -0.8};
  double x[3] = {1.7, -0.4, 3.3}, image[3], shift[3];
  edges_of(start.h, steps, shift);
  for (int d = 0; d < 3; d++) image[d] = x[d] + shift[d];
  sd_box_step(&start, &middle, &end, move, x);
  sd_box_step(&start, &middle, &end, move, image);
  edges_of(end.h, steps, shift);
  for (int d = 0; d < 3; d++) CHECK_NEAR(image[d], x[d] + shift[d], 1e-13);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(image_is_the_closest),
      cmocka_unit_test(far_away_is_no_loop),
      cmocka_unit_test(steps_and_edges_agree),
      cmocka_unit_test(faces_are_volume_over_area_apart),
      cmocka_unit_test(shear_carries_a_move_for_half_a_step),
      cmocka_unit_test(image_of_a_point_stays_its_image),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
