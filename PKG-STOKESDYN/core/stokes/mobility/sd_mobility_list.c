/* Pairs by list. A rank computes the rows of its own spheres; forces of ghosts come from the ranks
 * that own them, before each product. */
#include "sd_mobility.h"

#include <stdlib.h>

#include "sd_room.h"

typedef struct {
  sd_packed packed;
  const sd_pairs *pairs;
  sd_world world;
  int width;
  /* [width (n_all - n)] F of the ghosts */
  double *ghosts;
  size_t room;
} list;

static sd_status li_place(void *state, const sd_mobility_scene *s)
{
  list *e = state;
  const size_t doubles = (size_t) s->how.width * (size_t) (s->n_all - s->n);
  e->pairs = s->pairs;
  e->world = s->world;
  e->width = s->how.width;
  if (!sd_reserve(&e->ghosts, sizeof(double), doubles, &e->room)) return SD_ENOMEMORY;
  return sd_packed_list(&e->packed, SD_ISA_BEST, &s->how.law, &s->spheres, s->n_all, s->how.width);
}

static sd_status li_apply(void *state, const double *F, double *u)
{
  list *e = state;
  const sd_world *w = &e->world;
  if (w->refresh) {
    const sd_status status = w->refresh(w->ctx, F, e->ghosts, e->width);
    if (status != SD_OK) return status;
  }
  sd_packed_pairs(&e->packed, e->pairs, F, w->refresh ? e->ghosts : NULL, u);
  return SD_OK;
}

static void li_release(void *state)
{
  list *e = state;
  sd_packed_free(&e->packed);
  free(e->ghosts);
}

const sd_mobility_engine sd_mobility_list = {
    .name = "pairs by list",
    .state = sizeof(list),
    .view = SD_VIEW_LIST,
    .place = li_place,
    .apply = li_apply,
    .free = li_release,
};
