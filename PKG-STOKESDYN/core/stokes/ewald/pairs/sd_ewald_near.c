#include "sd_ewald_near.h"

#include <math.h>

#include "sd_constants.h"

long sd_ewald_pairs_near(sd_ewald_pairs *p, int row, int end, int ranges, const int *range, long many)
{
  const double range2 = p->ewald.range * p->ewald.range, *centre = sd_ewald_centres(p);
  double x[3 * SD_BUNCH];
  for (int k = row; k < end; k++)
    for (long d = 0; d < 3; d++) x[3 * (k - row) + d] = centre[d * p->rows + k];
  const sd_near_ranges rows = {centre, p->rows, range, ranges};
  int *list = p->neighbor + many;
  long found = p->doubles->search(&rows, x, end - row, range2, list);
  while (found % p->full) list[found++] = p->rows;
  return many + found;
}

sd_near_part sd_ewald_pairs_part(const sd_ewald_pairs *p)
{
  sd_near_part k = {.bunches = p->bunches,
                    .begin = p->begin,
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
