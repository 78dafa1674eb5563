#include "sd_sph_wall.h"

#include "sd_sph_visit.h"

double sd_sph_repulsion(double D, double r0, double r)
{
  if (!(r < r0)) return 0.0;
  const double s2 = (r0 / r) * (r0 / r);
  return D * (s2 * s2 - s2);
}

void sd_sph_wall_sums(const sd_sph_model *model, const sd_sph_list *list, const sd_sph_particles *p,
                      const int *is_wall, const double *pressure, const double b[3], double *sums)
{
  sd_sph_visitor v;
  SD_SPH_VISIT(model, list, p, v)
  {
    if (is_wall[v.i] == is_wall[v.j]) continue;
    const int w = is_wall[v.i] ? v.i : v.j, f = is_wall[v.i] ? v.j : v.i;
    const double sign = is_wall[v.i] ? 1.0 : -1.0, W = v.k->weight * sd_sph_K(model->kernel, v.q);
    const double *fluid = p->v4 + 4 * (size_t) f;
    double *s = sums + 5 * (size_t) w, depth = 0.0;
    for (int c = 0; c < 3; c++) depth += sign * v.d[c] * b[c];
    s[0] += W;
    s[1] += (pressure[f] + fluid[3] * depth) * W;
    for (int c = 0; c < 3; c++) s[2 + c] += fluid[c] * W;
  }
}
