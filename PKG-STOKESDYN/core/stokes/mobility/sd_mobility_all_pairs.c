/* All pairs. The spheres of all ranks stand in one order on every rank; each rank computes an equal
 * share of the pairs, wherever its own spheres are, and the shares are summed:
 *
 *   F of this rank --spread--> F of all --share--> a part of u of all --collect--> u of this
 * rank */
#include "sd_mobility.h"

#include <stdlib.h>

#include "sd_room.h"

typedef struct {
  sd_packed packed;
  sd_world world;
  int width, n_all;
  /* F and u of all, when there are other ranks or another order: 2 [width n_all] */
  double *all;
  size_t room;
} all_pairs;

static sd_status ap_place(void *state, const sd_mobility_scene *s)
{
  all_pairs *e = state;
  const size_t doubles = 2 * (size_t) s->how.width * (size_t) s->n_all;
  e->world = s->world;
  e->width = s->how.width;
  e->n_all = s->n_all;
  if (s->world.spread && !sd_reserve(&e->all, sizeof(double), doubles, &e->room))
    return SD_ENOMEMORY;
  const int loose = s->how.tolerance >= SD_PRODUCT_SINGLE * (1.0 - 1e-9);
  return (loose ? sd_packed_all_single : sd_packed_all)(&e->packed, SD_ISA_BEST, &s->how.law, &s->spheres, s->n_all,
                                                        s->how.width);
}

static sd_status ap_apply(void *state, const double *F, double *u)
{
  all_pairs *e = state;
  const sd_world *w = &e->world;
  const int me = sd_world_me(w), ranks = sd_world_ranks(w);
  if (!w->spread) {
    sd_packed_share(&e->packed, me, ranks, F, u);
    return SD_OK;
  }
  double *F_all = e->all, *u_all = e->all + (size_t) e->width * (size_t) e->n_all;
  const sd_status status = w->spread(w->ctx, F, F_all, e->width);
  if (status != SD_OK) return status;
  sd_packed_share(&e->packed, me, ranks, F_all, u_all);
  return w->collect(w->ctx, u_all, u, e->width);
}

static void ap_release(void *state)
{
  all_pairs *e = state;
  sd_packed_free(&e->packed);
  free(e->all);
}

const sd_mobility_engine sd_mobility_all_pairs = {
    .name = "all pairs",
    .state = sizeof(all_pairs),
    .view = SD_VIEW_ALL,
    .place = ap_place,
    .apply = ap_apply,
    .free = ap_release,
};
