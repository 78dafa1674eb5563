#include "sd_sph_wall.h"

#include <stddef.h>
#include <string.h>

double sd_sph_repulsion(double D, double r0, double r)
{
  if (!(r < r0)) return 0.0;
  const double s2 = (r0 / r) * (r0 / r);
  return D * (s2 * s2 - s2);
}

double sd_sph_mirror(double m, double P, double rho, double dW)
{
  return -m * m * 2.0 * P / (rho * rho) * dW;
}

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void sd_sph_pack_fluid(const sd_sph_particles *p, const double *pressure, const double b[3],
                       double *q)
{
  memset(q, 0, 8 * sizeof(double) * (size_t) (p->n + 1));
  for (int i = 0; i < p->n; i++) {
    if (p->phase[i] < 0) continue;
    const double *v4 = p->v4 + 4 * (size_t) i;
    double *row = q + 8 * (size_t) i;
    row[0] = 1.0;
    row[1] = pressure[i] - v4[3] * dot(b, p->x4 + 4 * (size_t) i);
    row[2] = v4[3];
    memcpy(row + 4, v4, 3 * sizeof(double));
  }
}

double sd_sph_wall_particle(const sd_sph_wall *wall, const double s[8], const double x[3],
                            const double v[3], double row[4])
{
  const int alone = s[0] == 0.0;
  const double P = alone ? wall->state->P0 : (s[1] + dot(wall->b, x) * s[2]) / s[0];
  if (!alone || wall->state->kind != SD_SPH_ABSOLUT) row[0] = sd_sph_density_of(wall->state, P);
  for (int d = 0; d < 3; d++) {
    const double ahead = alone ? 0.0 : s[4 + d] / s[0] - v[d];
    row[1 + d] = wall->slip ? ahead : -ahead;
  }
  return P;
}
