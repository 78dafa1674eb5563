/* The other ranks, as the core knows them: functions that the caller gives. */
#ifndef SD_WORLD_H
#define SD_WORLD_H

#include "sd_status.h"

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
  /* numbers summed over the ranks, in place, with the same bits on every rank: each decides by them
   * alone whether to go on, and one that decided otherwise would leave the others waiting */
  sd_status (*sum)(void *ctx, double *values, int count);
  /* view ALL: rows [width n] of this rank -> all [width n_all], and back, summed over the ranks */
  sd_status (*spread)(void *ctx, const double *rows, double *all, int width);
  sd_status (*collect)(void *ctx, const double *all, double *rows, int width);
  /* numbers from each rank to each: send holds to[0] of them for rank 0, then to[1] for rank 1 ...;
   * receive gets from[0] of rank 0, then from[1] of rank 1 .... to, from [ranks] agree among the
   * ranks, and are 0 for the rank itself. */
  sd_status (*exchange)(void *ctx, const double *send, const int *to, double *receive,
                        const int *from);
  /* view NEAR: from [ranks] = how many numbers each rank has in its `to` [ranks] for this one. It is 0 but
   * of ranks that have ghosts of this one's spheres, or the other way round. NULL: not to be had */
  sd_status (*tell)(void *ctx, const int *to, int *from);
  /* view NEAR, refresh the other way: rows [width n] += those of their ghosts. NULL: not to be had */
  sd_status (*reduce)(void *ctx, const double *ghosts, double *rows, int width);
} sd_world;

static inline sd_status sd_world_sum(const sd_world *w, double *values, int count)
{
  return w->sum ? w->sum(w->ctx, values, count) : SD_OK;
}

/* The status of this rank, or that of another which has failed: ranks that went different ways would
 * wait for each other for ever. */
static inline sd_status sd_world_agree(const sd_world *w, sd_status mine)
{
  double failed[SD_ECALLBACK + 1] = {0.0};
  failed[mine] = 1.0;
  const sd_status summed = sd_world_sum(w, failed, SD_ECALLBACK + 1);
  if (summed != SD_OK || mine != SD_OK) return mine != SD_OK ? mine : summed;
  for (int code = SD_OK + 1; code <= SD_ECALLBACK; code++)
    if (failed[code] > 0.0) return (sd_status) code;
  return SD_OK;
}

static inline int sd_world_ranks(const sd_world *world)
{
  return world->ranks > 0 ? world->ranks : 1;
}

static inline int sd_world_me(const sd_world *world)
{
  return world->ranks > 0 ? world->me : 0;
}

#endif
