#include "sd_clump_strain.h"

#include "sd_linear.h"

/* Rows and columns of E_xx E_yy E_zz E_yz E_xz E_xy */
static const int row_of[6] = {0, 1, 2, 1, 0, 0}, column_of[6] = {0, 1, 2, 2, 2, 1};

void sd_clump_unit_strain(int c, const double y[3], double v[3])
{
  for (int d = 0; d < 3; d++) v[d] = 0.0;
  v[row_of[c]] = y[column_of[c]];
  v[column_of[c]] = y[row_of[c]];
}

void sd_clump_strain_matrix(const double E[6], double A[9])
{
  for (int e = 0; e < 6; e++) A[3 * row_of[e] + column_of[e]] = A[3 * column_of[e] + row_of[e]] = E[e];
}

void sd_clump_split_gradient(const double R[9], const double G[9], double W[3], double E[6])
{
  double GR[9], S[9];
  sd_product3(G, R, GR);
  for (int q = 0; q < 3; q++) {
    const double column[3] = {GR[q], GR[3 + q], GR[6 + q]};
    double turned[3];
    sd_multiply3t(R, column, turned);
    for (int p = 0; p < 3; p++) S[3 * p + q] = turned[p];
  }
  for (int e = 0; e < 6; e++)
    E[e] = 0.5 * (S[3 * row_of[e] + column_of[e]] + S[3 * column_of[e] + row_of[e]]);
  W[0] = 0.5 * (G[7] - G[5]);
  W[1] = 0.5 * (G[2] - G[6]);
  W[2] = 0.5 * (G[3] - G[1]);
}
