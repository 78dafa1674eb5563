#include "check.h"

#include "sd_flow_grid.h"

#include <float.h>
#include <string.h>

enum { MOST = 70 };

/* A grid with its numbers. */
typedef struct {
  double at[SD_GRID_AXES][MOST];
  double *value;
  sd_flow_grid grid;
} sample;

typedef void flow(const double x[3], double t, double *value);

/* Nodes of an axis: even, or bent by up to a third of a cell. */
static void place_nodes(sample *s, int axis, int n, double lo, double hi, double bend)
{
  for (int k = 0; k < n; k++) {
    const double q = n > 1 ? (double) k / (n - 1) : 0.0;
    s->at[axis][k] = lo + (hi - lo) * q + bend * (hi - lo) * q * (1.0 - q);
  }
}

static void fill(sample *s, const int n[4], const sd_outside outside[4], int columns, flow *u)
{
  for (int d = 0; d < SD_GRID_AXES; d++)
    assert_int_equal(sd_grid_axis_init(&s->grid.axis[d], n[d], s->at[d], outside[d]), 0);
  s->grid.columns = columns;
  s->value = malloc(sizeof(double) * sd_flow_grid_size(&s->grid));
  assert_non_null(s->value);
  double *out = s->value;
  for (int t = 0; t < n[3]; t++)
    for (int z = 0; z < n[2]; z++)
      for (int y = 0; y < n[1]; y++)
        for (int x = 0; x < n[0]; x++, out += columns)
          u((double[3]){s->at[0][x], s->at[1][y], s->at[2][z]}, s->at[3][t], out);
  s->grid.value = s->value;
}

static const sd_outside nowhere[4] = {SD_OUTSIDE_NONE, SD_OUTSIDE_NONE, SD_OUTSIDE_NONE,
                                      SD_OUTSIDE_NONE};

/* Linear in place, time and both; a viscosity that is too. */
static const double slope[4][5] = {{0.3, -1.1, 0.7, 2.3, 0.4},
                                   {-0.9, 0.6, 1.7, -0.2, 0.8},
                                   {1.3, 0.5, -0.8, 0.1, -0.6},
                                   {9.0, 0.2, 0.3, -0.4, 0.5}};

static void linear(const double x[3], double t, double *value)
{
  for (int p = 0; p < 4; p++)
    value[p] = slope[p][0] + slope[p][1] * x[0] + slope[p][2] * x[1] + slope[p][3] * x[2] +
        slope[p][4] * t;
}

/* A linear flow is its own interpolation, whatever the spacing: to rounding. */
static void a_linear_flow_is_exact(void **state)
{
  (void) state;
  for (int uneven = 0; uneven < 2; uneven++) {
    sample s;
    const int n[4] = {7, 11, 5, 4};
    for (int d = 0; d < 4; d++) place_nodes(&s, d, n[d], -1.3 - d, 2.1 + d, uneven ? 0.6 : 0.0);
    fill(&s, n, nowhere, 4, linear);
    assert_int_equal(sd_flow_grid_fault(&s.grid), sd_flow_grid_size(&s.grid));
    uint64_t seed = 3;
    for (int n_points = 0; n_points < 50; n_points++) {
      double x[3 * 50], value[4 * 50], exact[4], G[9 * 50];
      for (int k = 0; k < 3 * n_points; k++) x[k] = uniform(&seed, -1.3 - k % 3, 2.1 + k % 3);
      const double t = n_points % 9 ? uniform(&seed, -4.3, 5.1) : s.at[3][n_points % 4];
      sd_flow_frame frame;
      assert_int_equal(sd_flow_grid_frame(&s.grid, t, &frame), SD_OK);
      sd_flow_grid_at(&s.grid, &frame, n_points, x, value, G);
      for (int k = 0; k < n_points; k++) {
        linear(x + 3 * k, t, exact);
        for (int p = 0; p < 4; p++) CHECK_NEAR(value[4 * k + p], exact[p], 2e-13);
        for (int p = 0; p < 3; p++)
          for (int q = 0; q < 3; q++) CHECK_NEAR(G[9 * k + 3 * p + q], slope[p][1 + q], 1e-12);
      }
    }
    free(s.value);
  }
}

static void wavy(const double x[3], double t, double *value)
{
  value[0] = sin(1.1 * x[0] + 0.3) * cos(0.7 * x[1]) * cos(1.9 * t);
  value[1] = cos(0.9 * x[1] - 0.2) * sin(1.3 * x[2]) + sin(1.7 * t);
  value[2] = sin(0.8 * x[2]) * sin(0.6 * x[0] + x[1]) * exp(0.4 * t);
}

/* Largest error over many places of a flow on grids of nx nodes a side and nt frames. */
static double largest_error(int nx, int nt, double *of_gradient)
{
  sample s;
  const int n[4] = {nx, nx, nx, nt};
  for (int d = 0; d < 4; d++) place_nodes(&s, d, n[d], 0.0, 2.0, 0.0);
  fill(&s, n, nowhere, 3, wavy);
  uint64_t seed = 7;
  double worst = 0.0;
  *of_gradient = 0.0;
  for (int k = 0; k < 4000; k++) {
    double x[3], value[3], exact[3], G[9];
    for (int d = 0; d < 3; d++) x[d] = uniform(&seed, 0.0, 2.0);
    const double t = uniform(&seed, 0.0, 2.0);
    sd_flow_frame frame;
    assert_int_equal(sd_flow_grid_frame(&s.grid, t, &frame), SD_OK);
    sd_flow_grid_at(&s.grid, &frame, 1, x, value, G);
    wavy(x, t, exact);
    for (int p = 0; p < 3; p++) worst = fmax(worst, fabs(value[p] - exact[p]));
    const double du_dx = 1.1 * cos(1.1 * x[0] + 0.3) * cos(0.7 * x[1]) * cos(1.9 * t);
    const double dw_dy = sin(0.8 * x[2]) * cos(0.6 * x[0] + x[1]) * exp(0.4 * t);
    *of_gradient = fmax(*of_gradient, fmax(fabs(G[0] - du_dx), fabs(G[7] - dw_dy)));
  }
  free(s.value);
  return worst;
}

/* Twice the nodes: a quarter of the error, of which h^2 |u''| / 8 is the most; the gradient halves. */
static void errors_are_of_second_order_in_space_and_time(void **state)
{
  (void) state;
  double coarse_G, fine_G, unused;
  // So many frames do not show beside 9 nodes, and so many nodes not beside 5 frames.
  const double coarse = largest_error(9, MOST - 1, &coarse_G);
  const double fine = largest_error(17, MOST - 1, &fine_G);
  CHECK_NEAR(log2(coarse / fine), 2.0, 0.2);
  CHECK_NEAR(log2(coarse_G / fine_G), 1.0, 0.2);
  CHECK_NEAR(log2(largest_error(49, 5, &unused) / largest_error(49, 9, &unused)), 2.0, 0.2);
}

/* Along each axis the value is linear within a cell: its difference there is its derivative, to the
 * rounding of the difference. Between two frames, on even and uneven axes. */
static void the_gradient_is_the_derivative_of_the_value(void **state)
{
  (void) state;
  const double step = 0.01;
  for (int uneven = 0; uneven < 2; uneven++) {
    sample s;
    const int n[4] = {5, 4, 6, 3};
    for (int d = 0; d < 4; d++) place_nodes(&s, d, n[d], 0.0, 2.0, uneven ? 0.3 : 0.0);
    fill(&s, n, nowhere, 3, wavy);
    uint64_t seed = 9;
    for (int k = 0; k < 200; k++) {
      double x[3], value[3], G[9];
      for (int d = 0; d < 3; d++) {
        const int cell = (int) uniform(&seed, 0.0, n[d] - 1);
        x[d] = uniform(&seed, s.at[d][cell] + step, s.at[d][cell + 1] - step);
      }
      sd_flow_frame frame;
      assert_int_equal(sd_flow_grid_frame(&s.grid, uniform(&seed, 0.0, 2.0), &frame), SD_OK);
      sd_flow_grid_at(&s.grid, &frame, 1, x, value, G);
      for (int q = 0; q < 3; q++) {
        double side[6] = {x[0], x[1], x[2], x[0], x[1], x[2]}, u[6];
        side[q] += step;
        side[3 + q] -= step;
        sd_flow_grid_at(&s.grid, &frame, 2, side, u, NULL);
        for (int p = 0; p < 3; p++) CHECK_NEAR(G[3 * p + q], (u[p] - u[3 + p]) / (2.0 * step), 1e-12);
      }
    }
    free(s.value);
  }
}

/* Periodic, held and none, one on each axis; x again on the far side of many periods. */
static void outside_an_axis_does_what_it_says(void **state)
{
  (void) state;
  sample s;
  const int n[4] = {9, 5, 4, 3};
  const sd_outside outside[4] = {SD_OUTSIDE_PERIODIC, SD_OUTSIDE_CLAMP, SD_OUTSIDE_NONE,
                                 SD_OUTSIDE_PERIODIC};
  for (int d = 0; d < 4; d++) place_nodes(&s, d, n[d], 1.0, 3.0, d % 2 ? 0.5 : 0.0);
  fill(&s, n, outside, 3, wavy);
  sd_flow_frame frame, again;
  assert_int_equal(sd_flow_grid_frame(&s.grid, 2.3, &frame), SD_OK);
  assert_int_equal(sd_flow_grid_frame(&s.grid, 2.3 - 6.0, &again), SD_OK);
  double here[3], there[3], G[9], H[9];
  const double x[3] = {1.7, 2.2, 1.9};
  sd_flow_grid_at(&s.grid, &frame, 1, x, here, G);
  sd_flow_grid_at(&s.grid, &again, 1, (double[3]){1.7 + 8.0, 2.2, 1.9}, there, H);
  for (int p = 0; p < 3; p++) CHECK_NEAR(there[p], here[p], 1e-14);
  for (int k = 0; k < 9; k++) CHECK_NEAR(H[k], G[k], 1e-13);

  // held: the value of the edge, with no slope across it and the edge's own along it
  sd_flow_grid_at(&s.grid, &frame, 1, (double[3]){1.7, 3.0, 1.9}, here, G);
  sd_flow_grid_at(&s.grid, &frame, 1, (double[3]){1.7, 77.0, 1.9}, there, H);
  for (int p = 0; p < 3; p++) {
    assert_true(there[p] == here[p]);
    assert_true(H[3 * p + 1] == 0.0 && H[3 * p] == G[3 * p] && H[3 * p + 2] == G[3 * p + 2]);
  }

  for (int side = 0; side < 2; side++) {
    const double z = side ? 3.0 + 1e-9 : 1.0 - 1e-9;
    sd_flow_grid_at(&s.grid, &frame, 1, (double[3]){1.7, 2.2, z}, there, H);
    assert_true(isnan(there[0]) && isnan(there[2]) && isnan(H[8]));
    sd_flow_grid_at(&s.grid, &frame, 1, (double[3]){1.7, 2.2, side ? 3.0 : 1.0}, there, NULL);
    assert_true(isfinite(there[0] + there[1] + there[2]));
  }
  sd_flow_grid_at(&s.grid, &frame, 1, (double[3]){NAN, 2.2, 2.0}, there, H);
  assert_true(isnan(there[1]) && isnan(H[4]));
  sd_flow_grid_at(&s.grid, &frame, 1, (double[3]){1.7, INFINITY, 2.0}, there, H);
  assert_true(isnan(there[1]) && isnan(H[4]));
  assert_int_equal(sd_flow_grid_frame(&s.grid, NAN, &again), SD_ENOTFINITE);
  free(s.value);
}

static void a_series_that_has_ended_says_so(void **state)
{
  (void) state;
  sample s;
  const int n[4] = {2, 2, 2, 3};
  for (int d = 0; d < 4; d++) place_nodes(&s, d, n[d], 0.5, 2.0, 0.0);
  fill(&s, n, nowhere, 3, wavy);
  sd_flow_frame frame;
  assert_int_equal(sd_flow_grid_frame(&s.grid, 2.0 + 1e-9, &frame), SD_EOUTSIDE);
  assert_int_equal(sd_flow_grid_frame(&s.grid, 0.5 - 1e-9, &frame), SD_EOUTSIDE);
  assert_int_equal(sd_flow_grid_frame(&s.grid, 2.0, &frame), SD_OK);
  free(s.value);
}

/* One node: whatever the coordinate, and nothing beyond value[] is read (the sanitizers see that). */
static void nothing_varies_along_an_axis_of_one_node(void **state)
{
  (void) state;
  sample s;
  const int n[4] = {1, 6, 1, 1};
  for (int d = 0; d < 4; d++) place_nodes(&s, d, n[d], 0.2, 1.4, 0.0);
  fill(&s, n, nowhere, 3, wavy);
  sd_flow_frame frame;
  assert_int_equal(sd_flow_grid_frame(&s.grid, -1e9, &frame), SD_OK);
  assert_null(frame.next);
  double here[3], there[3], G[9];
  sd_flow_grid_at(&s.grid, &frame, 1, (double[3]){0.2, 0.5, 0.2}, here, G);
  sd_flow_grid_at(&s.grid, &frame, 1, (double[3]){-70.0, 0.5, 5.0}, there, NULL);
  for (int p = 0; p < 3; p++) {
    assert_true(here[p] == there[p]);
    assert_true(G[3 * p] == 0.0 && G[3 * p + 2] == 0.0);
  }
  assert_true(G[1] != 0.0);
  free(s.value);
}

/* Both ends of an uneven axis and every node on it give the number that stands there. */
static void a_node_has_its_own_value(void **state)
{
  (void) state;
  for (int uneven = 0; uneven < 2; uneven++) {
    sample s;
    const int n[4] = {13, 3, 2, 1};
    for (int d = 0; d < 4; d++) place_nodes(&s, d, n[d], 0.1, 1.7, uneven ? -0.7 : 0.0);
    fill(&s, n, nowhere, 3, wavy);
    sd_flow_frame frame;
    assert_int_equal(sd_flow_grid_frame(&s.grid, 0.0, &frame), SD_OK);
    for (int k = 0; k < 13; k++) {
      double value[3];
      const double x[3] = {s.at[0][k], s.at[1][1], s.at[2][1]};
      sd_flow_grid_at(&s.grid, &frame, 1, x, value, NULL);
      for (int p = 0; p < 3; p++)
        CHECK_NEAR(value[p], s.value[3 * (k + 13 * (1 + 3 * 1)) + p], 40 * DBL_EPSILON);
    }
    free(s.value);
  }
}

static void what_is_no_grid_is_found(void **state)
{
  (void) state;
  sd_grid_axis axis;
  assert_int_equal(sd_grid_axis_init(&axis, 4, (double[]){0.0, 1.0, 1.0, 2.0}, SD_OUTSIDE_NONE), 2);
  assert_int_equal(sd_grid_axis_init(&axis, 2, (double[]){0.3, -1.0}, SD_OUTSIDE_NONE), 1);

  sample s;
  const int n[4] = {3, 4, 2, 2};
  const sd_outside around[4] = {SD_OUTSIDE_NONE, SD_OUTSIDE_PERIODIC, SD_OUTSIDE_NONE, SD_OUTSIDE_NONE};
  for (int d = 0; d < 4; d++) place_nodes(&s, d, n[d], 0.1, 1.7, 0.0);
  fill(&s, n, around, 4, linear);
  s.value[4 * 11 + 3] = 0.0;
  assert_int_equal(sd_flow_grid_fault(&s.grid), 4 * 11 + 3);
  s.value[4 * 5 + 1] = NAN;
  assert_int_equal(sd_flow_grid_fault(&s.grid), 4 * 5 + 1);

  // a seam of one number in 96
  for (int k = 0; k < 3 * 4 * 2 * 2 * 4; k++) s.value[k] = k % 4 == 3 ? 50.0 : k % 4 - 2.0;
  assert_true(sd_flow_grid_seam(&s.grid, SD_GRID_Y) == 0.0);
  s.value[4 * (2 + 3 * (3 + 4 * (1 + 2 * 0))) + 2] += 0.125;
  CHECK_NEAR(sd_flow_grid_seam(&s.grid, SD_GRID_Y), 0.125 / 2.0, 1e-15);
  assert_true(sd_flow_grid_seam(&s.grid, SD_GRID_X) == 0.0);
  free(s.value);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_linear_flow_is_exact),
      cmocka_unit_test(errors_are_of_second_order_in_space_and_time),
      cmocka_unit_test(the_gradient_is_the_derivative_of_the_value),
      cmocka_unit_test(outside_an_axis_does_what_it_says),
      cmocka_unit_test(a_series_that_has_ended_says_so),
      cmocka_unit_test(nothing_varies_along_an_axis_of_one_node),
      cmocka_unit_test(a_node_has_its_own_value),
      cmocka_unit_test(what_is_no_grid_is_found),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
