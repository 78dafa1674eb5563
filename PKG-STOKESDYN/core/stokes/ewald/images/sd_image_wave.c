#include "sd_image_wave.h"

/* (1) with the ends of both spheres, sorted by f, R and z */
void sd_image_wave(const sd_filter *filter, const double xi[3], double a, const double xj[3],
                   double b, double c[5])
{
  const double g = xi[2], h = xj[2], x = xi[0] - xj[0], y = xi[1] - xj[1], z = g + h;
  const double A = a * a / 6.0, B = b * b / 6.0, ref = filter->a_ref * filter->a_ref / 6.0;
  const double bi = A - ref, bj = B - ref;
  const int apart = bi != 0.0 || bj != 0.0;
  const sd_filtered f = sd_filtered_at(filter, x * x + y * y + z * z, 5, apart);
  double I, J, I1, J1, I2, J2;
  sd_filtered_stokeslet(&f, 0, &I, &J);
  if (apart) {
    sd_filtered_stokeslet(&f, 1, &I1, &J1);
    sd_filtered_stokeslet(&f, 2, &I2, &J2);
    I += (bi + bj) * I1 + bi * bj * I2;
    J += (bi + bj) * J1 + bi * bj * J2;
  }
  /* L with 1 + b lap of both, of i, of j, of none */
  double both[5], of_i[5], of_j[5], X[5], Q[5];
  const double *L = f.L[0];
  for (int n = 0; n < 5; n++) {
    const double L1 = apart ? f.L[1][n] : 0.0, L2 = apart ? f.L[2][n] : 0.0;
    of_i[n] = L[n] + bi * L1;
    of_j[n] = L[n] + bj * L1;
    both[n] = L[n] + (bi + bj) * L1 + bi * bj * L2;
    /* the derivatives that come with heights, of one end and of both */
    X[n] = 4.0 * (g * bj * of_i[n] + h * bi * of_j[n] + z * ref * both[n]);
    Q[n] = 8.0 * (bi * bj * L[n] + ref * (bi * of_j[n] + bj * of_i[n] + ref * both[n]));
  }
  const double gh = 2.0 * g * h, sides = X[2] + 2.0 * z * Q[3];
  const double turn = (g - h) * both[1] + 2.0 * z * (bi * of_j[2] - bj * of_i[2]);
  c[0] = -I + gh * both[1] + X[2] * z + Q[2] + z * z * Q[3];
  c[1] = 2.0 * I + 2.0 * Q[2];
  c[2] = -J + gh * both[2] + X[3] * z + Q[3] + z * z * Q[4];
  c[3] = J * z - turn + sides;
  c[4] = J * z + turn + sides;
}
