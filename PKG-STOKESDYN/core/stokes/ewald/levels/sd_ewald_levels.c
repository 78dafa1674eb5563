#include "sd_ewald_levels.h"

#include <math.h>
#include <string.h>

#include "sd_ewald_cost.h"
#include "sd_ewald_rule_internal.h"

/* A pair with a large sphere is kept as its tensor, made once a solve. */
static const double LARGE_PAIR = 30.0;

double sd_ewald_levels_cost(const sd_ewald *first, const sd_ewald_level *second)
{
  const double cost = sd_ewald_cost(first);
  if (!(second->from > 0.0)) return cost;
  const sd_ewald *e = &second->split;
  const double pairs = sd_ewald_near_pairs(e, e->count, second->count, e->range);
  return cost + LARGE_PAIR * pairs + sd_ewald_grid_cost(e);
}

/* Of the tolerance, for the second level: all spheres are so many more than the large ones that
 * their rms says nothing of those, whose velocities shall be as good. */
static const double LARGE_TOO = 0.12;

enum { SMALL, LARGE };

/* All have one a_ref, that of the small ones: it is in the waves that one level takes from the other. */
static sd_status lv_split(const sd_ewald_box *box, const sd_ewald_class spheres[2], int width, double times,
                          double tolerance, sd_ewald *first, sd_ewald_level *second)
{
  const sd_ewald_class *small = spheres + SMALL, *large = spheres + LARGE;
  sd_ewald *coarse = &second->split;
  sd_status status = sd_ewald_gaussian(box, small, width, tolerance, first);
  if (status == SD_OK)
    status = sd_ewald_gaussian_at(box, large, width, times, LARGE_TOO * tolerance, coarse);
  if (status != SD_OK || coarse->xi >= first->xi) return SD_ENOMEMORY;
  first->taken = coarse->xi;
  coarse->a_ref = first->a_ref;
  coarse->tolerance = tolerance;
  coarse->count = small->count + large->count;
  second->count = large->count;
  return SD_OK;
}

/* Where two levels part, and xi times the largest sphere, are those that cost least: a larger xi has
 * fewer pairs and wider windows. */
sd_status sd_ewald_levels_best(const sd_ewald_box *box, const sd_ewald_sizes *sizes, int width,
                               double tolerance, sd_ewald *first, sd_ewald_level *second)
{
  static const double times[] = {1.5, 2.0};
  const sd_ewald_box own = *box;
  double least = INFINITY;
  sd_ewald_class spheres[2] = {{0}};
  for (int k = 0; k + 1 < SD_EWALD_OCTAVES; k++) {
    sd_ewald_add_class(spheres + LARGE, sizes->octave + k);
    if (!(sizes->octave[k].count > 0.0)) continue;
    spheres[SMALL] = (sd_ewald_class){0};
    for (int l = k + 1; l < SD_EWALD_OCTAVES; l++) sd_ewald_add_class(spheres + SMALL, sizes->octave + l);
    for (int m = 0; m < 2 && spheres[SMALL].count > 0.0; m++) {
      sd_ewald e;
      sd_ewald_level level;
      memset(&level, 0, sizeof(level));
      if (lv_split(&own, spheres, width, times[m], tolerance, &e, &level) != SD_OK) continue;
      level.from = ldexp(spheres[LARGE].largest, -k - 1);
      const double cost = sd_ewald_levels_cost(&e, &level);
      if (!(cost < least)) continue;
      least = cost;
      memcpy(first, &e, sizeof(e));
      memcpy(second, &level, sizeof(level));
    }
  }
  return least < INFINITY ? SD_OK : SD_ENOMEMORY;
}

/* One level and two are compared as Gaussians, whose costs are known well; two also sum the
 * velocities of the few large spheres as well as those of all. */
sd_status sd_ewald_levels_choose(const sd_ewald_box *box, const sd_ewald_sizes *sizes, int width,
                                 double tolerance, sd_ewald *first, sd_ewald_level *second)
{
  const sd_ewald_box own = *box;
  sd_ewald one, small;
  sd_ewald_level level;
  memset(second, 0, sizeof(*second));
  sd_status status = sd_ewald_choose(&own, sizes, width, tolerance, first);
  if (status == SD_ENOTFINITE || !(first->count > 0.0)) return status;
  if (sd_ewald_levels_best(&own, sizes, width, first->tolerance, &small, &level) != SD_OK)
    return status;
  const sd_status alone = sd_ewald_gaussian(&own, &sizes->all, width, first->tolerance, &one);
  const double least = alone == SD_OK ? 0.8 * sd_ewald_cost(&one) : INFINITY;
  if (!(sd_ewald_levels_cost(&small, &level) < least)) return status;
  memcpy(first, &small, sizeof(small));
  memcpy(second, &level, sizeof(level));
  return SD_OK;
}
