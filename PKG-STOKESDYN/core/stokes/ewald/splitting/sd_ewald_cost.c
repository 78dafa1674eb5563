#include "sd_ewald_cost.h"

#include <math.h>

#include "sd_constants.h"
#include "sd_sphere.h"

/* Near pairs have a polynomial to evaluate beside the tensor; a sphere spreads three forces to
 * points^3 of the grid and gathers three velocities from them; a grid point goes through three
 * transforms forth and three back. */
static const double NEAR_PAIR = 5.8, WINDOW_POINT = 3.0, GRID_POINT = 40.0;

double sd_ewald_near_pairs(const sd_ewald *e, double targets, double sources, double range)
{
  const double ball = sd_sphere_volume(range);
  const double share = ball / sd_ewald_volume(&e->box); /* more than 1: images */
  return targets * sources * (e->box.periodic ? share : fmin(1.0, share));
}

static double ec_windows(double spheres, int points)
{
  return WINDOW_POINT * spheres * points * points * points;
}

static double transforms(const sd_ewald *e, const int *n)
{
  /* An open box is padded to eight times as many points; of the transforms along its lines 7 in 12
   * have something to transform. */
  return GRID_POINT * (e->box.periodic ? 1.0 : 8.0 * 7.0 / 12.0) * n[0] * n[1] * (double) n[2];
}

/* Above a wall fields go along the first direction a second time, and have twelve kernels more. */
static const double WALL_GRID = 1.8, IMAGE_PAIR = 8.0;

/* Of the ball around an image what is beyond the wall: over all heights 3/16 range of a whole one */
static double image_pairs(const sd_ewald *e)
{
  const double height = fmax(e->box.edge[e->images.wall.axis], 0.5 * e->images.range);
  return 0.1875 * e->images.range / height * sd_ewald_near_pairs(e, e->count, e->count, e->images.range);
}

double sd_ewald_grid_cost(const sd_ewald *e)
{
  return ec_windows(e->count, e->points) + transforms(e, e->grid);
}

double sd_ewald_cost(const sd_ewald *e)
{
  const double near = NEAR_PAIR * sd_ewald_near_pairs(e, e->count, e->count, e->range);
  const double cost = near + sd_ewald_grid_cost(e);
  return e->images.wall.sign
      ? cost + (WALL_GRID - 1.0) * transforms(e, e->grid) + IMAGE_PAIR * image_pairs(e)
      : cost;
}

/* In a slab: a near image that is computed; a point of a plane that holds something, with columns, and of
 * the others, which are transformed across the slab alone. Measured with bench_slab on a machine that
 * others used. */
static const double SLAB_IMAGE = 9.0, SLAB_POINT = 80.0, SLAB_EMPTY = 20.0;

/* How many spheres are within a range of one, at heights spread over the span? sign -1: of its image in a
 * wall one radius below the lowest */
static double slab_neighbours(const sd_ewald *e, double span, double range, int sign)
{
  enum { STEPS = 24 };
  const int d = e->slab.across;
  const double S = e->box.edge[(d + 1) % 3] * e->box.edge[(d + 2) % 3];
  double area = 0.0;
  for (int i = 0; i < STEPS; i++)
    for (int j = 0; j < STEPS; j++) {
      const double g = e->largest + (i + 0.5) / STEPS * span, h = e->largest + (j + 0.5) / STEPS * span;
      area += SD_PI * fmax(0.0, range * range - (g - sign * h) * (g - sign * h));
    }
  return e->count / S * area / (STEPS * STEPS);
}

double sd_ewald_slab_cost(const sd_ewald *e, double span, int walls)
{
  const int d = e->slab.across;
  const double lateral = (double) e->grid[(d + 1) % 3] * e->grid[(d + 2) % 3];
  const double near = NEAR_PAIR * slab_neighbours(e, span, e->range, 1) +
      walls * SLAB_IMAGE * slab_neighbours(e, span, e->images.range, -1);
  return e->count * near + ec_windows(e->count, e->points) +
      lateral * (SLAB_POINT * e->slab.planes + SLAB_EMPTY * (e->grid[d] - e->slab.planes));
}
