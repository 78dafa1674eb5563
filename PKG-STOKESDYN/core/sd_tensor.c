#include "sd_tensor.h"

void sd_tensor_uf(sd_tensor kind, const double r[3], double ai, double aj, double eta, double M[9])
{
  const double R = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
  const double scale = 1.0 / (6.0 * SD_PI * eta);
  double f, g;
  if (kind == SD_TENSOR_RPY)
    sd_rpy_radial(R, ai, aj, &f, &g);
  else
    sd_oseen_radial(R, &f, &g);
  const double inv = R > 0.0 ? 1.0 / R : 0.0;
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++)
      M[3 * p + q] = scale * (g * (r[p] * inv) * (r[q] * inv) + (p == q ? f : 0.0));
}
