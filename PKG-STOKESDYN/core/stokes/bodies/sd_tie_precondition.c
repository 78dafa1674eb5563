/* The factor of sd_tie_factor.h applied to a vector. */
#include "sd_tie_factor.h"

#include <string.h>

static void weigh_shared(const sd_tie_border *b, double *all)
{
  for (int k = 0; k < b->shares; k++)
    for (int d = 0; d < 6; d++) all[6 * (long) b->shared[k] + d] *= b->weight[b->shared[k]];
}

/* This rank's bodies to the factors that they are in, where bodies that are not at its border are 0 */
static void send_lent(const sd_tie_border *b, const double *all)
{
  memset(b->sent, 0, sizeof(double) * 6 * (size_t) b->lents);
  for (long k = 0; k < b->lents; k++)
    if (b->lent[k] >= 0) memcpy(b->sent + 6 * k, all + 6 * (long) b->lent[k], 6 * sizeof(double));
}

static void add_lent(const sd_tie_border *b, double *all)
{
  for (long k = 0; k < b->lents; k++)
    for (int d = 0; d < 6 && b->lent[k] >= 0; d++) all[6 * (long) b->lent[k] + d] += b->sent[6 * k + d];
}

/* What all ranks together do to bodies at borders: forth and back are each rank's own. */
static sd_status meet_at_borders(const sd_bodies *A)
{
  const sd_tie *t = A->tie;
  const sd_tie_border *b = &t->border;
  const sd_world *world = &t->L->world;
  double *others = t->all + 6 * (long) sd_bodies_count(A);
  weigh_shared(b, t->all);
  send_lent(b, t->all);
  sd_status status = world->exchange(world->ctx, b->sent, b->lend, others, b->borrow);
  if (status != SD_OK) return status;
  sd_block_cholesky_middle(&t->factor, t->all);
  for (int k = 0; k < b->aways; k++) memset(t->all + 6 * (long) b->away[k], 0, 6 * sizeof(double));
  status = world->exchange(world->ctx, others, b->borrow, b->sent, b->lend);
  add_lent(b, t->all);
  weigh_shared(b, t->all);
  return status;
}

sd_status sd_tie_precondition(const sd_bodies *A, const double *r, double *z)
{
  const sd_tie *t = A->tie;
  const long size = 6 * (long) sd_bodies_count(A);
  sd_status status = SD_OK;
  for (long j = 0; j < size; j++) t->all[j] = t->scale[j] * r[j];
  if (sd_tie_is_layered(A)) {
    memset(t->all + size, 0, sizeof(double) * 6 * (size_t) t->border.others);
    sd_block_cholesky_forth(&t->factor, t->all);
    status = meet_at_borders(A);
    sd_block_cholesky_back(&t->factor, t->all);
  } else
    sd_block_cholesky_apply(&t->factor, t->all);
  for (long j = 0; j < size; j++) z[j] = t->scale[j] * t->all[j];
  return status;
}
