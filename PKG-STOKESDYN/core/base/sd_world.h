/* The other ranks, as the core knows them: functions that the caller gives. */
#ifndef SD_WORLD_H
#define SD_WORLD_H

#include "sd_status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What an engine of sd_mobility.h may ask of its caller. Rows have `width` numbers; each function
 * returns SD_OK or why it failed, and all ranks call it together. NULL: one rank, in open space,
 * where the answer is what was asked with. */
typedef struct {
  void *ctx;
  /* this rank among `ranks`; 0 of 0 is read as 0 of 1 */
  int me, ranks;
  /* view LIST, NEAR: rows [width n] of this rank's spheres -> ghosts [width (n_all - n)], the rows
   * of their ghosts */
  sd_status (*refresh)(void *ctx, const double *rows, double *ghosts, int width);
  /* numbers summed over the ranks, in place */
  sd_status (*sum)(void *ctx, double *values, int count);
  /* view ALL: rows [width n] of this rank -> all [width n_all], and back, summed over the ranks */
  sd_status (*spread)(void *ctx, const double *rows, double *all, int width);
  sd_status (*collect)(void *ctx, const double *all, double *rows, int width);
  /* numbers from each rank to each: send holds to[0] of them for rank 0, then to[1] for rank 1 ...;
   * receive gets from[0] of rank 0, then from[1] of rank 1 .... to, from [ranks] agree among the
   * ranks, and are 0 for the rank itself. */
  sd_status (*exchange)(void *ctx, const double *send, const int *to, double *receive,
                        const int *from);
} sd_world;

static inline int sd_world_ranks(const sd_world *world)
{
  return world->ranks > 0 ? world->ranks : 1;
}

static inline int sd_world_me(const sd_world *world)
{
  return world->ranks > 0 ? world->me : 0;
}

#ifdef __cplusplus
}
#endif
#endif
