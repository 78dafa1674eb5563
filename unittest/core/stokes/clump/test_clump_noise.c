/* Brownian motion of lone clumps: covariance of displacements, and where there is no drift. */
#include "clumps.h"

#include "sd_clump_noise.h"
#include "sd_pose.h"

typedef struct {
  int n;
  double x[3 * MOST], a[MOST], R[9], c[3];
  sd_shape shape;
  sd_clump clump;
  sd_clump_noise noise;
} body;

static body make(int n, const double *x, const double *a)
{
  body b = {.n = n};
  memcpy(b.x, x, sizeof(double) * 3 * (size_t) n);
  memcpy(b.a, a, sizeof(double) * (size_t) n);
  assert_int_equal(sd_shape_create(n, x, a, &b.shape), SD_OK);
  assert_true(sd_shape_pose(&b.shape, x, b.R, b.c) < 1e-12);
  b.clump = solve(n, x, a, 1, 1);
  sd_clump_noise_of(&b.clump, &b.noise);
  return b;
}

static void release(body *b)
{
  sd_shape_free(&b->shape);
  sd_clump_free(&b->clump);
}

/* N [6 6] in space about the point d (in space) from the centre of mobility, of the pose R: from the six draws of unit
   vectors */
static void covariance(const body *b, const double R[9], double eta, const double d[3], double N[36])
{
  memset(N, 0, 36 * sizeof(double));
  for (int k = 0; k < 6; k++) {
    double w[6] = {0}, y[6], turning[3];
    w[k] = 1.0;
    sd_clump_noise_draw(&b->noise, R, eta, w, y);
    sd_cross(y + 3, d, turning);
    for (int p = 0; p < 3; p++) y[p] += turning[p];
    for (int p = 0; p < 36; p++) N[p] += y[p / 6] * y[p % 6];
  }
}

static body of_l(void)
{
  const double x[12] = {0, 0, 0, 2, 0, 0, 4, 0, 0, 0, 2, 0}, a[4] = {1, 1, 1, 1};
  return make(4, x, a);
}

/* Four spheres in an L, forces and torques: figures of another program, to six digits */
static void l_of_four_has_the_known_covariance(void **state)
{
  (void) state;
  body b = of_l();
  const double eta = 1.3, unit = 6.0 * SD_PI * eta;
  double o[3], back[3], N[36];
  sd_multiply3(b.R, b.noise.centre, o);
  CHECK_NEAR(o[0], 0.135753, 1e-6);
  CHECK_NEAR(o[1], 0.074106, 1e-6);
  CHECK_NEAR(o[2], 0.0, 1e-12);
  for (int d = 0; d < 3; d++) back[d] = -o[d];
  covariance(&b, b.R, eta, back, N);
  static const struct {
    int row, column;
    double value;
  } known[] = {{0, 0, 0.561894}, {1, 1, 0.517759}, {2, 2, 0.473551}, {0, 1, -0.019734},
               {0, 5, 0.008365}, {1, 5, -0.012600}, {2, 3, -0.010115}, {2, 4, 0.007082}};
  for (int k = 0; k < 8; k++) CHECK_NEAR(unit * N[6 * known[k].row + known[k].column], known[k].value, 1e-6);
  release(&b);
}

/* Translation, mean of three; spin across and about the own axis. */
static void rods_diffuse_as_known(void **state)
{
  (void) state;
  const double a[5] = {1, 1, 1, 1, 1}, figures[2][3] = {{0.735294, 0.269737, 0.5625}, {0.440650, 0.033267, 0.243840}};
  for (int k = 0; k < 2; k++) {
    const int n = k ? 5 : 2;
    double x[15] = {0}, N[36], zero[3] = {0};
    for (int i = 0; i < n; i++) x[3 * i + 2] = 2.0 * i;
    body b = make(n, x, a);
    covariance(&b, b.R, 1.0, zero, N);
    CHECK_NEAR(6.0 * SD_PI * (N[0] + N[7] + N[14]) / 3.0, figures[k][0], 1e-6);
    CHECK_NEAR(8.0 * SD_PI * N[21], figures[k][1], 1e-6);
    CHECK_NEAR(8.0 * SD_PI * N[35], figures[k][2], 1e-6);
    release(&b);
  }
}

/* Drift of the point at d from the centre of mobility, in space: sum over turns t_r about axis r of d N_pr / d t_r, by
   differences */
static void drift(const body *b, const double d[3], double out[3])
{
  const double h = 1e-5;
  for (int p = 0; p < 3; p++) out[p] = 0.0;
  for (int r = 0; r < 3; r++)
    for (int sign = -1; sign <= 1; sign += 2) {
      double turn[9], R[9], at[3], N[36];
      const double w[3] = {r == 0 ? sign * h : 0, r == 1 ? sign * h : 0, r == 2 ? sign * h : 0};
      sd_rotation(w, turn);
      sd_product3(turn, b->R, R);
      sd_multiply3(turn, d, at);
      covariance(b, R, 1.0, at, N);
      for (int p = 0; p < 3; p++) out[p] += sign * N[6 * p + 3 + r] / (2.0 * h);
    }
}

static void nothing_drifts_at_the_centre_of_mobility(void **state)
{
  (void) state;
  double x[3 * MOST], a[MOST];
  const int n = table_cluster("helix4_chiral", x, a);
  a[0] = 0.6; /* no symmetry is left */
  body b[2] = {of_l(), make(n, x, a)};
  for (int k = 0; k < 2; k++) {
    const double zero[3] = {0}, off[3] = {3.0, 0.0, 0.0};
    double none[3], some[3], N[36];
    drift(b + k, zero, none);
    drift(b + k, off, some);
    for (int p = 0; p < 3; p++) CHECK_NEAR(6.0 * SD_PI * none[p], 0.0, 1e-9);
    assert_true(6.0 * SD_PI * sqrt(sd_dot(some, some)) > 0.1);
    covariance(b + k, b[k].R, 1.0, zero, N);
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < p; q++) CHECK_NEAR(6.0 * SD_PI * (N[6 * p + 3 + q] - N[6 * q + 3 + p]), 0.0, 1e-12);
  }
  assert_true(fabs(b[1].clump.centre[0] - b[1].noise.centre[0]) + fabs(b[1].clump.centre[1] - b[1].noise.centre[1]) >
              1e-6);
  for (int k = 0; k < 2; k++) release(b + k);
}

/* The covariance is the mobility that moves the clump when forces act. */
static void covariance_is_the_mobility(void **state)
{
  (void) state;
  body b = of_l();
  const double d[3] = {0.3, -0.2, 0.5};
  double N[36], R_d[36], at[3], shape_d[3], turned[36] = {0};
  /* resistance about the same point, turned into space */
  sd_multiply3t(b.R, d, at);
  for (int p = 0; p < 3; p++) shape_d[p] = b.noise.centre[p] + at[p];
  sd_resistance_shift(b.clump.R, shape_d, R_d);
  for (int p = 0; p < 36; p++)
    for (int k = 0; k < 9; k++) {
      const int row = p / 6, column = p % 6;
      turned[p] += b.R[3 * (row % 3) + k / 3] * b.R[3 * (column % 3) + k % 3] *
          R_d[6 * (row / 3 * 3 + k / 3) + column / 3 * 3 + k % 3];
    }
  covariance(&b, b.R, 1.0, d, N);
  for (int p = 0; p < 36; p++) {
    double unity = 0.0;
    for (int k = 0; k < 6; k++) unity += N[6 * (p / 6) + k] * turned[6 * k + p % 6];
    CHECK_NEAR(unity, p % 7 == 0, 1e-10);
  }
  release(&b);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(l_of_four_has_the_known_covariance),
      cmocka_unit_test(rods_diffuse_as_known),
      cmocka_unit_test(nothing_drifts_at_the_centre_of_mobility),
      cmocka_unit_test(covariance_is_the_mobility),
  };
  return cmocka_run_group_tests(tests, NULL, free_shells);
}
