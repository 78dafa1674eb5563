#include "sd_ewald_near.h"

#include <math.h>

#include "sd_constants.h"

long sd_ewald_pairs_near(sd_ewald_pairs *p, int row, int ranges, const int *range, long many)
{
  const double range2 = p->ewald.range * p->ewald.range, *centre = sd_ewald_centres(p) + row;
  const double x[3] = {centre[0], centre[p->rows], centre[2 * (long) p->rows]};
  int *list = p->neighbor + many;
  long found = p->doubles->search(sd_ewald_centres(p), p->rows, range, ranges, x, range2, list);
  while (found % p->full) list[found++] = p->rows;
  return many + found;
}

sd_near_part sd_ewald_pairs_part(const sd_ewald_pairs *p)
{
  sd_near_part k = {.rows = p->rows,
                    .width = p->width,
                    .first = p->first,
                    .neighbor = p->neighbor,
                    .row = p->row,
                    .torque_row = p->torque_row,
                    .u = p->u,
                    .degree = p->degree};
  k.unit = p->scale / sd_ewald_pairs_steps(p);
  const double s = p->scale, range = p->ewald.range * s, ref = p->ewald.a_ref * s;
  k.range2 = range * range;
  k.ref2 = ref * ref;
  k.equal = p->equal;
  static const int power[SD_RADIALS] = {1, 3, 3, 5, 5, 7, 3, 5};
  for (int f = 0; f < SD_RADIALS; f++) {
    const double unit = 8.0 * SD_PI / pow(s, power[f]);
    for (int m = 0; m <= p->degree; m++) k.coefficient[f][m] = unit * p->coefficient[f][m];
  }
  return k;
}
