/* sd_pair_resistance.h: blocks in space, the RPY pair, the relative motion. */
#include "check.h"
#include "pair_blocks.h"
#include "table.h"

#include "sd_constants.h"
#include "sd_linear.h"
#include "sd_pair_resistance.h"
#include "sd_tensor.h"

/* 12x12 in space */
static void whole(const sd_pair_resistance *R, const double d[3], double M[144])
{
  double B[3][36];
  pair_blocks(R, d, B[0], B[1], B[2]);
  for (int p = 0; p < 6; p++)
    for (int q = 0; q < 6; q++) {
      M[12 * p + q] = B[0][6 * p + q];
      M[12 * p + 6 + q] = M[12 * (6 + q) + p] = B[1][6 * p + q];
      M[12 * (6 + p) + 6 + q] = B[2][6 * p + q];
    }
}

/* something without any symmetry but its own */
static sd_pair_resistance some(void)
{
  return (sd_pair_resistance){
      {31, -17, 40}, {23, -9, 30}, {-5, 7, -11, 9}, {20, -3, 50}, {28, 6, 77}};
}

/* about the place [3]: 6 columns of the motion of both spheres as one body, M = K */
static void rigid(const double x1[3], const double x2[3], double K[72])
{
  memset(K, 0, 72 * sizeof(double));
  for (int s = 0; s < 2; s++) {
    const double *x = s ? x2 : x1;
    const double cross[9] = {0, x[2], -x[1], -x[2], 0, x[0], x[1], -x[0], 0}; /* W x x */
    for (int p = 0; p < 3; p++) {
      K[6 * (6 * s + p) + p] = K[6 * (6 * s + 3 + p) + 3 + p] = 1.0;
      for (int q = 0; q < 3; q++) K[6 * (6 * s + p) + 3 + q] = cross[3 * p + q];
    }
  }
}

static void inverse_of_the_mobility(void **state)
{
  (void) state;
  const double d[3] = {2.0 / 7, -3.0 / 7, 6.0 / 7}, a1 = 0.8, a2 = 1.9;
  for (int k = 0; k < 3; k++) {
    const double R = k == 0 ? 1.7 : k == 1 ? 2.75 : 6.0; /* overlapping, near, apart */
    const double r[3] = {-R * d[0], -R * d[1], -R * d[2]}, zero[3] = {0};
    const sd_pair_resistance pair = sd_pair_resistance_rpy(a1, a2, R);
    double M[144], M11[36], M12[36], M22[36], product;
    whole(&pair, d, M);
    sd_tensor_grand(zero, a1, a1, 1.0, M11);
    sd_tensor_grand(r, a1, a2, 1.0, M12);
    sd_tensor_grand(zero, a2, a2, 1.0, M22);
    for (int p = 0; p < 12; p++)
      for (int q = 0; q < 12; q++) {
        product = 0.0;
        for (int l = 0; l < 12; l++) {
          const double m = p < 6 ? (l < 6 ? M11[6 * p + l] : M12[6 * p + l - 6])
                                 : (l < 6 ? M12[6 * l + p - 6] : M22[6 * (p - 6) + l - 6]);
          product += m * M[12 * l + q];
        }
        CHECK_NEAR(product, p == q, 1e-12);
      }
  }
}

/* The pair turned as a whole, and the pair told from the other side */
static void turned_and_exchanged(void **state)
{
  (void) state;
  uint64_t seed = 4;
  double T[9], M[144], N[144];
  const double d[3] = {2.0 / 7, -3.0 / 7, 6.0 / 7}, back[3] = {-d[0], -d[1], -d[2]};
  double e[3];
  random_rotation(&seed, T);
  sd_multiply3(T, d, e);
  const sd_pair_resistance R = some(), E = sd_pair_resistance_exchanged(&R);
  whole(&R, d, M);
  whole(&R, e, N);
  for (int p = 0; p < 12; p++)
    for (int q = 0; q < 12; q++) {
      double turned = 0.0;
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
          turned +=
              T[3 * (p % 3) + i] * T[3 * (q % 3) + j] * M[12 * (p / 3 * 3 + i) + q / 3 * 3 + j];
      CHECK_NEAR(N[12 * p + q], turned, 1e-12);
      CHECK_NEAR(M[12 * p + q], M[12 * q + p], 0.0);
    }
  whole(&E, back, N);
  for (int p = 0; p < 12; p++)
    for (int q = 0; q < 12; q++)
      CHECK_NEAR(N[12 * p + q], M[12 * ((p + 6) % 12) + (q + 6) % 12], 1e-14);
}

/* Q^T D Q as it is defined, with K about any place. It bears no force on the pair as a whole and no
 * torque on it, radii 1:3. */
static void relative_part(void **state)
{
  (void) state;
  const double d[3] = {2.0 / 7, -3.0 / 7, 6.0 / 7}, a[2] = {0.7, 2.1}, R = 3.1;
  const double x1[3] = {0.3, -0.2, 0.9};
  const double x2[3] = {x1[0] + R * d[0], x1[1] + R * d[1], x1[2] + R * d[2]};
  const sd_pair_resistance D = some(), relative = sd_pair_resistance_relative(&D, a[0], a[1], R);
  double full[144], part[144], K[72], A[12], G[36], S[72], Q[144];
  whole(&D, d, full);
  whole(&relative, d, part);
  rigid(x1, x2, K);
  for (int p = 0; p < 12; p++)
    A[p] = p % 6 < 3 ? 6.0 * SD_PI * a[p / 6] : 8.0 * SD_PI * pow(a[p / 6], 3.0);
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < 6; j++) {
      G[6 * i + j] = 0.0;
      for (int p = 0; p < 12; p++) G[6 * i + j] += K[6 * p + i] * A[p] * K[6 * p + j];
    }
  /* S [12][6]: rows (K^T A K)^-1 (K^T A) e_q */
  for (int q = 0; q < 12; q++)
    for (int i = 0; i < 6; i++) S[6 * q + i] = K[6 * q + i] * A[q];
  assert_int_equal(sd_cholesky_solve(6, G, 12, S), SD_OK);
  for (int p = 0; p < 12; p++)
    for (int q = 0; q < 12; q++) {
      Q[12 * p + q] = p == q;
      for (int i = 0; i < 6; i++) Q[12 * p + q] -= K[6 * p + i] * S[6 * q + i];
    }
  for (int p = 0; p < 12; p++) {
    for (int q = 0; q < 12; q++) {
      double sum = 0.0;
      for (int i = 0; i < 12; i++)
        for (int j = 0; j < 12; j++) sum += Q[12 * i + p] * full[12 * i + j] * Q[12 * j + q];
      CHECK_NEAR(part[12 * p + q], sum, 1e-11);
    }
    for (int i = 0; i < 6; i++) {
      double total = 0.0;
      for (int q = 0; q < 12; q++) total += part[12 * p + q] * K[6 * q + i];
      CHECK_NEAR(total, 0.0, 1e-12);
    }
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(inverse_of_the_mobility),
      cmocka_unit_test(turned_and_exchanged),
      cmocka_unit_test(relative_part),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
