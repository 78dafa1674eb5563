#include "sd_two_sphere_exact.h"

#include <math.h>

#include "sd_two_sphere_modes_internal.h"

/* The mirror image of a number becomes it; what they differed by */
static void mirror(sd_real number, sd_real *image, sd_real size, sd_real *asymmetry)
{
  *asymmetry = fmaxl(*asymmetry, fabsl(number - *image) / size);
  *image = number;
}

/* cosh(alpha + beta) - 1 = gap (2 (a1 + a2) + gap)/(2 a1 a2), and c = a1 a2 sinh(alpha + beta)/R */
sd_pair_resistance sd_two_sphere_exact(double a1, double a2, double gap, double *asymmetry)
{
  if (a1 > a2) {
    const sd_pair_resistance R = sd_two_sphere_exact(a2, a1, gap, asymmetry);
    return sd_pair_resistance_exchanged(&R);
  }
  const sd_real A = a1, B = a2, t = gap * (2.0L * (A + B) + gap) / (2.0L * A * B);
  const sd_real c = A * B * sqrtl(t * (t + 2.0L)) / (A + B + gap);
  const sd_real alpha = asinhl(c / A), beta = asinhl(c / B), c2 = c * c, c3 = c2 * c;
  sd_real XA[2][2], XC[2][2], Y[4][4], worst = 0.0L;
  sd_two_sphere_axial_translation(alpha, beta, XA);
  sd_two_sphere_axial_rotation(alpha, beta, XC);
  sd_two_sphere_across(alpha, beta, Y);

  /* the better ones: what acts on the smaller sphere, and what cancels less */
  static const int better[6][2] = {{0, 1}, {0, 3}, {2, 1}, {2, 3}, {0, 2}, {3, 1}};
  mirror(XA[0][1], &XA[1][0], fabsl(XA[0][0]), &worst);
  for (int b = 0; b < 6; b++) {
    const int i = better[b][0], j = better[b][1];
    mirror(Y[i][j], &Y[j][i], sqrtl(Y[i][i] * Y[j][j]), &worst);
  }
  if (asymmetry) *asymmetry = (double) worst;
  sd_pair_resistance R;
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) {
      R.XA[i + j] = (double) (c * XA[i][j]);
      R.YA[i + j] = (double) (c * Y[i][j]);
      R.YB[2 * i + j] = (double) (c2 * Y[2 + i][j]);
      R.XC[i + j] = (double) (c3 * XC[i][j]);
      R.YC[i + j] = (double) (c3 * Y[2 + i][2 + j]);
    }
  return R;
}
