#include "sd_ewald_cost.h"

#include <math.h>

#include "sd_constants.h"

/* Near pairs have a polynomial to evaluate beside the tensor; a sphere spreads three forces to
 * points^3 of the grid and gathers three velocities from them; a grid point goes through three
 * transforms forth and three back. */
static const double NEAR_PAIR = 5.8, WINDOW_POINT = 3.0, GRID_POINT = 40.0;

double sd_ewald_cost(const sd_ewald *e)
{
  const double ball = 4.0 / 3.0 * SD_PI * e->range * e->range * e->range;
  const double neighbors = fmin(e->count, e->count * ball / sd_ewald_volume(&e->box));
  const double window = (double) e->points * e->points * e->points;
  double grid = (double) e->grid[0] * e->grid[1] * e->grid[2];
  /* An open box is padded to eight times as many points; of the transforms along its lines 7 in 12
   * have something to transform. */
  if (!e->box.periodic) grid *= 8.0 * 7.0 / 12.0;
  return e->count * (NEAR_PAIR * neighbors + WINDOW_POINT * window) + GRID_POINT * grid;
}
