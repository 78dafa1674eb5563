#include "sd_rank_spheres.h"

#include <stdlib.h>

#include "sd_room.h"

sd_status sd_rank_spheres_take(sd_rank_spheres *r, const sd_spheres *spheres, int width, int n, int n_all,
                               int walls)
{
  const size_t all = (size_t) n_all, ghosts = (size_t) width * (size_t) (n_all - n);
  r->width = width;
  r->n = n;
  r->n_all = n_all;
  r->spheres = *spheres;
  if (!sd_reserve(&r->sphere, sizeof(int), (size_t) n, &r->sphere_room) ||
      !sd_reserve(&r->ghosts, sizeof(double), ghosts, &r->ghost_room) ||
      (walls && !sd_reserve(&r->stand, 3 * sizeof(double), all, &r->stand_room)))
    return SD_ENOMEMORY;
  if (walls) r->spheres.x = r->stand;
  return SD_OK;
}

void sd_rank_spheres_list(sd_rank_spheres *r, const sd_ewald_pairs *pairs)
{
  r->own = pairs->n;
  for (int i = 0; i < r->own; i++) r->sphere[i] = pairs->sphere[pairs->target[i]];
}

sd_status sd_rank_spheres_refresh(sd_rank_spheres *r, const sd_world *world, const double *F)
{
  return world->refresh ? world->refresh(world->ctx, F, r->ghosts, r->width) : SD_OK;
}

void sd_rank_spheres_free(sd_rank_spheres *r)
{
  free(r->sphere);
  free(r->stand);
  free(r->ghosts);
}
