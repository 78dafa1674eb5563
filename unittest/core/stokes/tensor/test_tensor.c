#include "check.h"

#include "sd_tensor.h"

static const double radii[][2] = {{0.7, 0.7}, {0.7, 1.9}, {1.3, 0.4}, {2.5, 0.025}};
enum { N_RADII = sizeof(radii) / sizeof(radii[0]) };

/* The published form of the overlap branch (Zuk et al. 2014), in long double. */
static void published_overlap(long double R, long double ai, long double aj, long double *f,
                              long double *g)
{
  const long double d2 = (ai - aj) * (ai - aj), R3 = R * R * R;
  *f = (16 * R3 * (ai + aj) - (d2 + 3 * R * R) * (d2 + 3 * R * R)) / (32 * R3) / (ai * aj);
  *g = 3 * (d2 - R * R) * (d2 - R * R) / (32 * R3) / (ai * aj);
}

static void overlap_branch_is_the_published_form(void **state)
{
  (void) state;
  for (int k = 0; k < N_RADII; k++) {
    const double ai = radii[k][0], aj = radii[k][1], lo = fabs(ai - aj), hi = ai + aj;
    for (int m = 1; m < 200; m++) {
      const double R = lo + (hi - lo) * m / 200.0;
      long double F, G;
      double f, g;
      published_overlap(R, ai, aj, &F, &G);
      sd_rpy_radial(R, ai, aj, &f, &g);
      /* R - |ai - aj| has a rounding of ai/b ulp */
      const double tol = 1e-15 * fmax(ai, aj) / fmin(ai, aj) * (double) F;
      CHECK_NEAR(f, (double) F, 4 * tol);
      CHECK_NEAR(g, (double) G, 4 * tol);
    }
  }
}

/* f and g at both joints: the far form meets the overlap form at contact, the overlap form meets 1/A where one sphere
 * is just inside. */
static void branches_join_with_their_values(void **state)
{
  (void) state;
  for (int k = 0; k < N_RADII; k++) {
    const double ai = radii[k][0], aj = radii[k][1], d = 1e-9;
    const double joints[2] = {ai + aj, fabs(ai - aj)};
    for (int j = 0; j < 2; j++) {
      double f[2], g[2];
      if (joints[j] == 0.0) continue;
      sd_rpy_radial(joints[j] * (1 - d), ai, aj, &f[0], &g[0]);
      sd_rpy_radial(joints[j] * (1 + d), ai, aj, &f[1], &g[1]);
      /* the slope is of order 1/b^2 at most */
      const double b = fmin(ai, aj), step = 2 * d * joints[j] / (b * b);
      CHECK_NEAR(f[1], f[0], step);
      CHECK_NEAR(g[1], g[0], step);
    }
  }
}

/* The slope is continuous at contact: the second difference across the joint is O(h^2), not O(h). */
static void slope_is_continuous_at_contact(void **state)
{
  (void) state;
  for (int k = 0; k < N_RADII; k++) {
    const double ai = radii[k][0], aj = radii[k][1], b = fmin(ai, aj), h = 1e-4 * b;
    double f[3], g[3];
    for (int m = 0; m < 3; m++) sd_rpy_radial(ai + aj + (m - 1) * h, ai, aj, &f[m], &g[m]);
    /* second derivatives are below 3/(R b^2); a jump of the slope would give h times itself, 1e4 times more */
    const double tol = 3.0 * h * h / ((ai + aj) * b * b);
    CHECK_NEAR(f[2] - 2 * f[1] + f[0], 0.0, tol);
    CHECK_NEAR(g[2] - 2 * g[1] + g[0], 0.0, tol);
  }
}

/* Where one sphere lies inside the other, both move with the larger one. */
static void hidden_sphere_moves_with_the_larger(void **state)
{
  (void) state;
  double f, g;
  sd_rpy_radial(0.9, 1.9, 0.7, &f, &g);
  CHECK_NEAR(f, 1.0 / 1.9, 0.0);
  CHECK_NEAR(g, 0.0, 0.0);
  sd_rpy_radial(0.0, 0.7, 0.7, &f, &g);
  CHECK_NEAR(f, 1.0 / 0.7, 0.0);
  CHECK_NEAR(g, 0.0, 0.0);
}

/* Equal spheres that nearly coincide: 1/a (1 - 9R/32a) + 3R/32a hh, without loss down to the smallest distance. */
static void near_coincidence_keeps_its_digits(void **state)
{
  (void) state;
  const double a = 0.7;
  for (double R = 1.0; R > 1e-200; R *= 0.03) {
    double f, g;
    sd_rpy_radial(R, a, a, &f, &g);
    CHECK_NEAR(f, (1.0 - 9.0 * R / (32.0 * a)) / a, 1e-15);
    CHECK_NEAR(g / (3.0 * R / (32.0 * a * a)), 1.0, 1e-14);
  }
}

/* Far apart: (1 + a_i^2/6 lap)(1 + a_j^2/6 lap) on the Stokeslet, hence divergence free. The '+' of the manual page of
 * the original is not: there div = -2 e.r/r^5. Central differences, error O(h^2). */
static void tensor_is_divergence_free(void **state)
{
  (void) state;
  const double ai = 0.7, aj = 1.1, eta = 1.3, h = 1e-3, r[3] = {2.1, -1.7, 1.9};
  for (int c = 0; c < 3; c++) {
    double div = 0.0;
    for (int d = 0; d < 3; d++) {
      double p[3] = {r[0], r[1], r[2]}, m[3] = {r[0], r[1], r[2]}, P[9], M[9];
      p[d] += h;
      m[d] -= h;
      sd_tensor_uf(SD_TENSOR_RPY, p, ai, aj, eta, P);
      sd_tensor_uf(SD_TENSOR_RPY, m, ai, aj, eta, M);
      div += (P[3 * d + c] - M[3 * d + c]) / (2 * h);
    }
    CHECK_NEAR(div, 0.0, 1e-2 * h * h); /* the printed '+' would give 4e-4 and more */
  }
}

/* Touching pair along its axis: lambda = 1/(1 + 5/8), not the 1/2 of the '+' nor the 4/7 of Oseen. */
static void touching_pair_along_its_axis(void **state)
{
  (void) state;
  const double a = 0.7, eta = 1.3, r[3] = {0, 0, 2 * a}, self = 1.0 / (6 * SD_PI * eta * a);
  double M[9];
  sd_tensor_uf(SD_TENSOR_RPY, r, a, a, eta, M);
  CHECK_NEAR(self / (self + M[8]), 1.0 / 1.625, 1e-15);
  CHECK_NEAR(self / (self + M[0]), 1.0 / 1.4375, 1e-15);
  sd_tensor_uf(SD_TENSOR_OSEEN, r, a, a, eta, M);
  CHECK_NEAR(self / (self + M[8]), 4.0 / 7.0, 1e-15);
}

/* Equal and opposite forces along the line of centres: what their relative velocity lacks of that of
 * two lone spheres, from the blocks themselves. */
static void approach_is_resisted_as_the_blocks_say(void **state)
{
  (void) state;
  const double eta = 1.3;
  for (int k = 0; k < N_RADII; k++)
    for (int m = 0; m < 5; m++) {
      const double ai = radii[k][0], aj = radii[k][1], R = (ai + aj) * (1.0 + 0.3 * m), r[3] = {0.0, 0.0, R};
      double M[9];
      sd_tensor_uf(SD_TENSOR_RPY, r, ai, aj, eta, M);
      const double alone = (1.0 / ai + 1.0 / aj) / (6.0 * SD_PI * eta), both = alone - 2.0 * M[8];
      CHECK_NEAR(sd_rpy_approach(R, ai, aj, eta), 1.0 / both - 1.0 / alone, 1e-13 / both);
      assert_true(sd_rpy_approach(R, ai, aj, eta) > 0.0);
    }
}

static void block_is_symmetric_and_reciprocal(void **state)
{
  (void) state;
  uint64_t seed = 7;
  for (int n = 0; n < 300; n++) {
    const double ai = uniform(&seed, 0.05, 2.0), aj = uniform(&seed, 0.05, 2.0);
    double r[3], back[3], M[9], B[9];
    for (int d = 0; d < 3; d++) {
      r[d] = uniform(&seed, -2.0, 2.0);
      back[d] = -r[d];
    }
    sd_tensor_uf(SD_TENSOR_RPY, r, ai, aj, 1.3, M);
    sd_tensor_uf(SD_TENSOR_RPY, back, aj, ai, 1.3, B);
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++) {
        CHECK_NEAR(M[3 * p + q], M[3 * q + p], 1e-15 * fabs(M[0]));
        CHECK_NEAR(M[3 * p + q], B[3 * q + p], 1e-14 * fabs(M[0]));
      }
  }
}

/* Published overlap forms of the rotation blocks (Zuk et al. 2014), in long double: f', g', c_ij. */
static void published_overlap_rotation(long double R, long double ai, long double aj,
                                       long double *f, long double *g, long double *c)
{
  const long double a2 = ai * ai, b2 = aj * aj, d2 = (ai - aj) * (ai - aj), R2 = R * R, R3 = R2 * R;
  const long double m = a2 + 4 * ai * aj + b2, scale = 64 * R3 * a2 * ai * b2 * aj;
  *f = (5 * R3 * R3 - 27 * R2 * R2 * (a2 + b2) + 32 * R3 * (a2 * ai + b2 * aj) -
        9 * R2 * (a2 - b2) * (a2 - b2) - d2 * d2 * m) /
      scale;
  *g = 3 * (d2 - R2) * (d2 - R2) * (m - R2) / scale;
  *c = (ai - aj + R) * (ai - aj + R) * (b2 + 2 * aj * (ai + R) - 3 * (ai - R) * (ai - R)) /
      (16 * a2 * ai * aj * R2);
}

static void rotation_overlap_is_the_published_form(void **state)
{
  (void) state;
  for (int k = 0; k < 2 * N_RADII; k++) {
    const double ai = radii[k / 2][k % 2], aj = radii[k / 2][1 - k % 2], lo = fabs(ai - aj),
                 hi = ai + aj;
    const double A = fmax(ai, aj), b = fmin(ai, aj);
    for (int m = 1; m < 200; m++) {
      const double R = lo + (hi - lo) * m / 200.0;
      long double F, G, C;
      double f, g;
      published_overlap_rotation(R, ai, aj, &F, &G, &C);
      sd_rpy_radial_wt(R, ai, aj, &f, &g);
      /* R - |ai - aj| has a rounding of A/b ulp; the long double form itself loses (A/b)^3 of its 64 bits */
      const double tol = 1e-15 * A / b + 1e-18 * pow(A / b, 3);
      CHECK_NEAR(f * A * A * A, (double) F * A * A * A, 4 * tol);
      CHECK_NEAR(g * A * A * A, (double) G * A * A * A, 4 * tol);
      CHECK_NEAR(sd_rpy_radial_wf(R, ai, aj) * A * A, (double) C * A * A, 4 * tol);
    }
  }
}

static void rotation_branches_join_with_their_values(void **state)
{
  (void) state;
  for (int k = 0; k < 2 * N_RADII; k++) {
    const double ai = radii[k / 2][k % 2], aj = radii[k / 2][1 - k % 2], d = 1e-9;
    const double joints[2] = {ai + aj, fabs(ai - aj)};
    const double A = fmax(ai, aj), b = fmin(ai, aj);
    for (int j = 0; j < 2; j++) {
      double f[2], g[2], c[2];
      for (int m = 0; m < 2; m++) {
        const double R = joints[j] * (1 + (2 * m - 1) * d);
        if (joints[j] == 0.0) continue;
        sd_rpy_radial_wt(R, ai, aj, &f[m], &g[m]);
        c[m] = sd_rpy_radial_wf(R, ai, aj);
      }
      if (joints[j] == 0.0) continue;
      /* slopes are of order 1/(b A^3) and 1/(b A^2) at most */
      const double step = 10 * 2 * d * joints[j] / (b * A * A);
      CHECK_NEAR(f[1], f[0], step / A);
      CHECK_NEAR(g[1], g[0], step / A);
      CHECK_NEAR(c[1], c[0], step);
    }
  }
}

/* Both spheres at nearly one point turn as one: f' -> 1/a^3 (1 - 27R/(32a)), g' -> 9R/(32 a^4), c -> R/(2 a^3), with
 * every digit. */
static void rotation_keeps_its_digits_near_coincidence(void **state)
{
  (void) state;
  const double a = 0.7;
  for (double R = 1e-9; R > 1e-300; R *= 0.003) {
    double f, g;
    sd_rpy_radial_wt(R, a, a, &f, &g);
    CHECK_NEAR(f * a * a * a, 1.0 - 27.0 * R / (32.0 * a), 2e-15);
    CHECK_NEAR(g / (9.0 * R / (32.0 * a * a * a * a)), 1.0, 3e-9);
    CHECK_NEAR(sd_rpy_radial_wf(R, a, a) / (R / (2 * a * a * a)), 1.0, 3e-9);
  }
  double f, g;
  sd_rpy_radial_wt(0.0, a, a, &f, &g);
  CHECK_NEAR(f * a * a * a, 1.0, 1e-15);
  assert_true(g == 0.0 && sd_rpy_radial_wf(0.0, a, a) == 0.0);
}

/* The host of a hidden sphere turns all that is inside with it, and feels a force at the hidden centre as its torque R
   x F. */
static void hidden_sphere_turns_with_its_host(void **state)
{
  (void) state;
  const double A = 1.9, b = 0.7, R = 0.9;
  double f, g;
  sd_rpy_radial_wt(R, A, b, &f, &g);
  CHECK_NEAR(f, 1.0 / (A * A * A), 1e-16);
  CHECK_NEAR(g, 0.0, 0.0);
  CHECK_NEAR(sd_rpy_radial_wf(R, A, b), R / (A * A * A), 1e-16);
  CHECK_NEAR(sd_rpy_radial_wf(R, b, A), 0.0, 0.0);
}

/* Half the curl, by central differences, of column q of rows 0-2 (velocity) of the block: -> w [3] */
static void half_curl(const double r[3], double ai, double aj, double eta, int q, double h,
                      double w[3])
{
  double D[3][3]; /* D[d][p] = d u_p / d x_d */
  for (int d = 0; d < 3; d++) {
    double plus[3] = {r[0], r[1], r[2]}, minus[3] = {r[0], r[1], r[2]}, P[36], M[36];
    plus[d] += h;
    minus[d] -= h;
    sd_tensor_grand(plus, ai, aj, eta, P);
    sd_tensor_grand(minus, ai, aj, eta, M);
    for (int p = 0; p < 3; p++) D[d][p] = (P[6 * p + q] - M[6 * p + q]) / (2 * h);
  }
  for (int p = 0; p < 3; p++) {
    const int a = (p + 1) % 3, b = (p + 2) % 3;
    w[p] = 0.5 * (D[a][b] - D[b][a]);
  }
}

/* Far apart W_i is half the curl of the flow that moves i, for a force and for a torque at j (the flow of a torque and
 * the vorticity are harmonic, so radii do not enter); the flow of a torque is free of divergence as well. */
static void rotation_is_half_the_curl(void **state)
{
  (void) state;
  const double ai = 0.7, aj = 1.1, eta = 1.3, h = 1e-3, r[3] = {2.1, -1.7, 1.9};
  double M[36];
  sd_tensor_grand(r, ai, aj, eta, M);
  for (int q = 0; q < 6; q++) {
    double w[3];
    half_curl(r, ai, aj, eta, q, h, w);
    for (int p = 0; p < 3; p++) CHECK_NEAR(w[p], M[6 * (p + 3) + q], 1e-2 * h * h);
  }
}

/* Values of the test-suite of PyGRPY (R. Waszkiewicz, github.com/RadostW/PyGRPY, tests/test_tensors.py): equal spheres
 * a = 1 at r = 1, viscosity 1. */
static void grand_block_has_the_values_of_pygrpy(void **state)
{
  (void) state;
  const double r[3] = {0, 0, 1};
  double M[36];
  sd_tensor_grand(r, 1.0, 1.0, 1.0, M);
  CHECK_NEAR(M[0], 0.03813087178243326, 1e-16);
  CHECK_NEAR(M[14], 0.04310446375405499, 1e-16);
  CHECK_NEAR(M[21], 0.009325484946790743, 1e-16);
  CHECK_NEAR(M[35], 0.018650969893581486, 1e-16);
  /* force along x: W = c F x h along -y */
  CHECK_NEAR(M[6 * 4 + 0], -0.012433979929054324, 1e-16);
}

static void grand_block_is_reciprocal(void **state)
{
  (void) state;
  uint64_t seed = 17;
  for (int n = 0; n < 1000; n++) {
    const double ai = uniform(&seed, 0.05, 2.0), aj = uniform(&seed, 0.05, 2.0);
    double r[3], back[3], M[36], B[36], U[9];
    for (int d = 0; d < 3; d++) {
      r[d] = uniform(&seed, -2.0, 2.0);
      back[d] = -r[d];
    }
    sd_tensor_grand(r, ai, aj, 1.3, M);
    sd_tensor_grand(back, aj, ai, 1.3, B);
    sd_tensor_uf(SD_TENSOR_RPY, r, ai, aj, 1.3, U);
    for (int p = 0; p < 6; p++)
      for (int q = 0; q < 6; q++)
        CHECK_NEAR(M[6 * p + q], B[6 * q + p], 1e-15 * fabs(M[0] + M[21]));
    for (int p = 0; p < 9; p++) CHECK_NEAR(M[6 * (p / 3) + p % 3], U[p], 1e-15 * fabs(U[0]));
  }
}

enum { MOST = 29 };

/* A random clump: neighbours at 0.2 to 1 of the sum of radii, radii 0.05 to 2. Returns the number of spheres. */
static int random_clump(uint64_t *seed, double x[MOST][3], double a[MOST])
{
  const int n = 2 + (int) uniform(seed, 0.0, MOST - 2.0);
  for (int d = 0; d < 3; d++) x[0][d] = 0.0;
  for (int i = 0; i < n; i++) {
    a[i] = uniform(seed, 0.05, 2.0);
    if (i == 0) continue;
    const int j = (int) uniform(seed, 0.0, i);
    double e[3], norm = 0.0;
    for (int d = 0; d < 3; d++) {
      e[d] = uniform(seed, -1.0, 1.0);
      norm += e[d] * e[d];
    }
    const double R = uniform(seed, 0.2, 1.0) * (a[i] + a[j]) / sqrt(norm);
    for (int d = 0; d < 3; d++) x[i][d] = x[j][d] + R * e[d];
  }
  return n;
}

/* Matrices of random clumps scaled to unit diagonal, translation alone and with rotation. An independent evaluation of
 * 300 other such clumps found smallest eigenvalues from 0.038 and 0.030, and these have them from 0.032 and 0.028: a
 * wrong overlap form shows long before it is indefinite. The far form used inside goes to -1e4. */
static void overlapping_clumps_are_positive_definite(void **state)
{
  (void) state;
  static double A[9 * MOST * MOST], G[36 * MOST * MOST];
  uint64_t seed = 11;
  for (int clump = 0; clump < 300; clump++) {
    double x[MOST][3], a[MOST];
    const int n = random_clump(&seed, x, a), m = 3 * n;
    for (int i = 0; i < n; i++)
      for (int j = 0; j < n; j++) {
        double r[3], M[9], W[36];
        for (int d = 0; d < 3; d++) r[d] = x[i][d] - x[j][d];
        sd_tensor_uf(SD_TENSOR_RPY, r, a[i], a[j], 1.0, M);
        sd_tensor_grand(r, a[i], a[j], 1.0, W);
        const double length[2] = {sqrt(4.0 / 3.0) * a[i], sqrt(4.0 / 3.0) * a[j]};
        for (int p = 0; p < 3; p++)
          for (int q = 0; q < 3; q++)
            A[(3 * i + p) * m + 3 * j + q] = i == j ? (p == q)
                                                    : 6 * SD_PI * sqrt(a[i] * a[j]) * M[3 * p + q];
        for (int p = 0; p < 6; p++)
          for (int q = 0; q < 6; q++)
            G[(6 * i + p) * 2 * m + 6 * j + q] = 6 * SD_PI * sqrt(a[i] * a[j]) * W[6 * p + q] *
                (p < 3 ? 1.0 : length[0]) * (q < 3 ? 1.0 : length[1]);
      }
    for (int k = 0; k < 2 * m; k++) CHECK_NEAR(G[k * 2 * m + k], 1.0, 1e-15);
    /* A hidden sphere of equal size as its host is the only way to zero, and random radii exclude it. */
    if (!positive_definite(A, m, 0.032))
      fail_msg("clump %d of %d spheres has an eigenvalue below 0.032", clump, n);
    if (!positive_definite(G, 2 * m, 0.028))
      fail_msg("clump %d of %d spheres with rotation has an eigenvalue below 0.028", clump, n);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(overlap_branch_is_the_published_form),
      cmocka_unit_test(branches_join_with_their_values),
      cmocka_unit_test(slope_is_continuous_at_contact),
      cmocka_unit_test(hidden_sphere_moves_with_the_larger),
      cmocka_unit_test(near_coincidence_keeps_its_digits),
      cmocka_unit_test(tensor_is_divergence_free),
      cmocka_unit_test(touching_pair_along_its_axis),
      cmocka_unit_test(approach_is_resisted_as_the_blocks_say),
      cmocka_unit_test(block_is_symmetric_and_reciprocal),
      cmocka_unit_test(rotation_overlap_is_the_published_form),
      cmocka_unit_test(rotation_branches_join_with_their_values),
      cmocka_unit_test(rotation_keeps_its_digits_near_coincidence),
      cmocka_unit_test(hidden_sphere_turns_with_its_host),
      cmocka_unit_test(rotation_is_half_the_curl),
      cmocka_unit_test(grand_block_has_the_values_of_pygrpy),
      cmocka_unit_test(grand_block_is_reciprocal),
      cmocka_unit_test(overlapping_clumps_are_positive_definite),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
