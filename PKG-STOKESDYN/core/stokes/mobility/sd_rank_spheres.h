/* The spheres of a rank as the engines by Ewald sums hold them: where they stand, which have a radius,
 * and what is kept of the forces on ghosts. */
#ifndef SD_RANK_SPHERES_H
#define SD_RANK_SPHERES_H

#include "sd_ewald_pairs.h"
#include "sd_product.h"
#include "sd_status.h"
#include "sd_world.h"

SD_BEGIN_C

/* Zero-initialise; sd_rank_spheres_free in the end. */
typedef struct {
  /* numbers of a sphere; this rank's spheres, with ghosts */
  int width, n, n_all;
  /* centres where they are, or in stand */
  sd_spheres spheres;
  /* [own] this rank's spheres with radius, in order of the near part's targets */
  int *sphere, own;
  size_t sphere_room;
  /* [3 n_all] centres off the walls; filled by the engine */
  double *stand;
  size_t stand_room;
  /* [width (n_all - n)] */
  double *ghosts;
  size_t ghost_room;
} sd_rank_spheres;

/* Room for so many spheres; walls: they stand in r->stand. SD_OK or SD_ENOMEMORY */
sd_status sd_rank_spheres_take(sd_rank_spheres *r, const sd_spheres *spheres, int width, int n,
                               int n_all, int walls);
/* When the pairs of the near part stand */
void sd_rank_spheres_list(sd_rank_spheres *r, const sd_ewald_pairs *pairs);
/* r->ghosts = F of the ghosts; SD_OK or as world->refresh */
sd_status sd_rank_spheres_refresh(sd_rank_spheres *r, const sd_world *world, const double *F);
void sd_rank_spheres_free(sd_rank_spheres *r);

SD_END_C
#endif
