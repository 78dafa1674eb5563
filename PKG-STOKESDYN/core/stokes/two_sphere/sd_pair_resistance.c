#include "sd_pair_resistance.h"

#include "sd_constants.h"
#include "sd_tensor.h"

/* Everything across d lies in two equal planes. In the plane of x and d = -z, with torques along y,
 * U x d of a velocity along x is along +y: the rows F1 F2 T1 T2 and columns U1 U2 W1 W2 are
 *
 *   | YA11 YA12 YB11 YB21 |
 *   | YA12 YA22 YB12 YB22 |
 *   | YB11 YB12 YC11 YC12 |
 *   | YB21 YB22 YC12 YC22 | */
static void across_from(const sd_pair_resistance *R, double Y[16])
{
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) {
      Y[4 * i + j] = R->YA[i + j];
      Y[4 * (i + 2) + j + 2] = R->YC[i + j];
      Y[4 * (i + 2) + j] = Y[4 * j + i + 2] = R->YB[2 * i + j];
    }
}

static void across_to(const double Y[16], sd_pair_resistance *R)
{
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) {
      R->YA[i + j] = Y[4 * i + j];
      R->YC[i + j] = Y[4 * (i + 2) + j + 2];
      R->YB[2 * i + j] = Y[4 * (i + 2) + j];
    }
}

sd_pair_resistance sd_pair_resistance_exchanged(const sd_pair_resistance *R)
{
  sd_pair_resistance E;
  for (int k = 0; k < 3; k++) {
    E.XA[k] = R->XA[2 - k];
    E.YA[k] = R->YA[2 - k];
    E.XC[k] = R->XC[2 - k];
    E.YC[k] = R->YC[2 - k];
  }
  for (int k = 0; k < 4; k++) E.YB[k] = -R->YB[3 - k];
  return E;
}

/* inverse of the symmetric (p q; q r), as its p q r */
static void invert2(double p, double q, double r, double inverse[3])
{
  const double det = p * r - q * q;
  inverse[0] = r / det;
  inverse[1] = -q / det;
  inverse[2] = p / det;
}

/* Across: the mobility is (A B^T; B C), A velocities from forces, C spins from torques and B spins
 * from forces, which has no diagonal: a force does not spin its own sphere. In the plane of
 * across_from, where x_1 - x_2 is along +z, W_1 = -c_12 F_2 and W_2 = c_21 F_1 (over 8 pi). With
 * G = C^-1 B and S = (A - B^T G)^-1 the inverse is (S, -S G^T; -G S, C^-1 + G S G^T). */
sd_pair_resistance sd_pair_resistance_rpy(double a1, double a2, double distance)
{
  const double uf = 1.0 / (6.0 * SD_PI), wt = 1.0 / (8.0 * SD_PI);
  const double s1 = wt / (a1 * a1 * a1), s2 = wt / (a2 * a2 * a2);
  double f, g, fw, gw, C[3], S[3], Y[16];
  sd_rpy_radial(distance, a1, a2, &f, &g);
  sd_rpy_radial_wt(distance, a1, a2, &fw, &gw);
  const double b12 = -wt * sd_rpy_radial_wf(distance, a1, a2);
  const double b21 = wt * sd_rpy_radial_wf(distance, a2, a1);

  sd_pair_resistance R;
  invert2(uf / a1, uf * (f + g), uf / a2, R.XA);
  invert2(s1, wt * (fw + gw), s2, R.XC);
  invert2(s1, wt * fw, s2, C);
  const double G[2][2] = {{C[1] * b21, C[0] * b12}, {C[2] * b21, C[1] * b12}};
  invert2(uf / a1 - b21 * G[1][0], uf * f - b21 * G[1][1], uf / a2 - b12 * G[0][1], S);
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) {
      Y[4 * i + j] = S[i + j];
      Y[4 * (i + 2) + j] = Y[4 * j + i + 2] = -(G[i][0] * S[j] + G[i][1] * S[1 + j]);
    }
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++)
      Y[4 * (i + 2) + j + 2] = C[i + j] - Y[4 * (i + 2)] * G[j][0] - Y[4 * (i + 2) + 1] * G[j][1];
  across_to(Y, &R);
  return R;
}

/* D [n n] becomes P^T D P, P = 1 - k m^T with m = A k/(k.A k): the motion k is taken out */
static void take_out(int n, const double *A, const double *k, double *D)
{
  double m[4], Dk[4], kAk = 0.0, kDk = 0.0;
  for (int p = 0; p < n; p++) {
    m[p] = A[p] * k[p];
    kAk += k[p] * m[p];
    Dk[p] = 0.0;
    for (int q = 0; q < n; q++) Dk[p] += D[n * p + q] * k[q];
    kDk += k[p] * Dk[p];
  }
  for (int p = 0; p < n; p++) m[p] /= kAk;
  for (int p = 0; p < n; p++)
    for (int q = 0; q < n; q++) D[n * p + q] += kDk * m[p] * m[q] - m[p] * Dk[q] - Dk[p] * m[q];
}

static void take_out_common(const double *A, double X[3])
{
  double D[4] = {X[0], X[1], X[1], X[2]};
  take_out(2, A, (double[2]){1.0, 1.0}, D);
  X[0] = D[0];
  X[1] = D[1];
  X[2] = D[3];
}

/* Rotation about the centre of the drags moves it nowhere: then its column and that of translation
 * are orthogonal in A, and go one after the other. */
sd_pair_resistance sd_pair_resistance_relative(const sd_pair_resistance *D, double a1, double a2,
                                               double distance)
{
  const double A[4] = {6.0 * a1, 6.0 * a2, 8.0 * a1 * a1 * a1, 8.0 * a2 * a2 * a2};
  const double turn[4] = {distance * a2 / (a1 + a2), -distance * a1 / (a1 + a2), 1.0, 1.0};
  double Y[16];
  sd_pair_resistance Q = *D;
  take_out_common(A, Q.XA);
  take_out_common(A + 2, Q.XC);
  across_from(D, Y);
  take_out(4, A, (double[4]){1.0, 1.0, 0.0, 0.0}, Y);
  take_out(4, A, turn, Y);
  across_to(Y, &Q);
  return Q;
}

sd_pair_resistance sd_pair_resistance_sum(double p, const sd_pair_resistance *A, double q,
                                          const sd_pair_resistance *B)
{
  sd_pair_resistance S;
  for (int k = 0; k < 3; k++) {
    S.XA[k] = p * A->XA[k] + q * B->XA[k];
    S.YA[k] = p * A->YA[k] + q * B->YA[k];
    S.XC[k] = p * A->XC[k] + q * B->XC[k];
    S.YC[k] = p * A->YC[k] + q * B->YC[k];
  }
  for (int k = 0; k < 4; k++) S.YB[k] = p * A->YB[k] + q * B->YB[k];
  return S;
}
