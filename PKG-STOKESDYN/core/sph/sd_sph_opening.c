#include "sd_sph_opening.h"

#include <math.h>

double sd_sph_hydrograph(int n, const double *t, const double *q, double time)
{
  if (time <= t[0]) return q[0];
  if (time >= t[n - 1]) return q[n - 1];
  int below = 0, above = n - 1;
  while (above - below > 1) {
    const int middle = (below + above) / 2;
    if (t[middle] <= time)
      below = middle;
    else
      above = middle;
  }
  const double part = (time - t[below]) / (t[above] - t[below]);
  return q[below] + part * (q[above] - q[below]);
}

/* The four nodes around a place, and their weights. */
typedef struct {
  int node[4];
  double weight[4];
} corners;

static corners around(const sd_sph_section *s, const double at[2])
{
  int low[2], high[2];
  double part[2];
  for (int d = 0; d < 2; d++) {
    const double last = s->n[d] - 1, k = s->n[d] > 1 ? (at[d] - s->lo[d]) / s->step[d] : 0.0;
    const double inside = fmin(fmax(k, 0.0), last);
    low[d] = (int) inside;
    high[d] = low[d] + 1 < s->n[d] ? low[d] + 1 : low[d];
    part[d] = inside - low[d];
  }
  return (corners){{low[0] + s->n[0] * low[1], high[0] + s->n[0] * low[1], low[0] + s->n[0] * high[1],
                    high[0] + s->n[0] * high[1]},
                   {(1.0 - part[0]) * (1.0 - part[1]), part[0] * (1.0 - part[1]),
                    (1.0 - part[0]) * part[1], part[0] * part[1]}};
}

void sd_sph_section_add(const sd_sph_section *s, const double at[2], double m, double v, double *sums)
{
  const corners c = around(s, at);
  for (int k = 0; k < 4; k++) {
    sums[2 * c.node[k]] += c.weight[k] * m;
    sums[2 * c.node[k] + 1] += c.weight[k] * m * v;
  }
}

double sd_sph_section_mass(const sd_sph_section *s, const double at[2], const double *sums)
{
  const corners c = around(s, at);
  double mass = 0.0;
  for (int k = 0; k < 4; k++) mass += c.weight[k] * sums[2 * c.node[k]];
  return mass;
}

double sd_sph_section_speed(const sd_sph_section *s, const double at[2], const double *sums,
                            double otherwise)
{
  const corners c = around(s, at);
  double weights = 0.0, speed = 0.0;
  for (int k = 0; k < 4; k++) {
    const double *node = sums + 2 * c.node[k];
    if (!(node[0] > 0.0)) continue;
    weights += c.weight[k];
    speed += c.weight[k] * node[1] / node[0];
  }
  return weights > 0.0 ? speed / weights : otherwise;
}
