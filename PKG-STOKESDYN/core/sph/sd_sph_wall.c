#include "sd_sph_wall.h"

#include "sd_sph_visit.h"

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

void sd_sph_wall_sums(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                      const int *mask, int bit, const double *pressure, const double b[3],
                      double *sums)
{
  sd_sph_visitor v;
  SD_SPH_VISIT(model, list, p, v)
  {
    const int first = (mask[v.i] & bit) != 0;
    if (first == ((mask[v.j] & bit) != 0)) continue;
    const int w = first ? v.i : v.j, f = first ? v.j : v.i;
    const double sign = first ? 1.0 : -1.0, W = v.k->weight * sd_sph_K(model->kernel, v.q);
    const double *fluid = p->v4 + 4 * (size_t) f;
    double *s = sums + 5 * (size_t) w, depth = 0.0;
    for (int c = 0; c < 3; c++) depth += sign * v.d[c] * b[c];
    s[0] += W;
    s[1] += (pressure[f] + fluid[3] * depth) * W;
    for (int c = 0; c < 3; c++) s[2 + c] += fluid[c] * W;
  }
}

void sd_sph_wall_particle(const sd_sph_state *state, const double s[5], const double v[3], int slip,
                          double row[4])
{
  const int alone = s[0] == 0.0;
  if (!alone || state->kind != SD_SPH_ABSOLUT)
    row[0] = sd_sph_density_of(state, alone ? state->P0 : s[1] / s[0]);
  for (int d = 0; d < 3; d++) {
    const double ahead = alone ? 0.0 : s[2 + d] / s[0] - v[d];
    row[1 + d] = slip ? ahead : -ahead;
  }
}
