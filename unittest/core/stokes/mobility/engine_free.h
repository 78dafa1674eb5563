/* The smallest engine: spheres do not see each other, u = 0. In the product it would be a file like this one in
 * core/stokes/mobility and its declaration in sd_mobility.h. */
#ifndef ENGINE_FREE_H
#define ENGINE_FREE_H

#include "sd_mobility.h"

#include <string.h>

typedef struct {
  size_t numbers;
} free_spheres;

static sd_status free_place(void *state, const sd_mobility_scene *s)
{
  ((free_spheres *) state)->numbers = (size_t) s->how.width * (size_t) s->n;
  return SD_OK;
}

static sd_status free_apply(void *state, const double *F, double *u)
{
  (void) F;
  memset(u, 0, sizeof(double) * ((free_spheres *) state)->numbers);
  return SD_OK;
}

static void free_release(void *state)
{
  (void) state;
}

static const sd_mobility_engine sd_mobility_free_spheres = {
    .name = "free spheres",
    .state = sizeof(free_spheres),
    .view = SD_VIEW_LIST,
    .place = free_place,
    .apply = free_apply,
    .free = free_release,
};

#endif
