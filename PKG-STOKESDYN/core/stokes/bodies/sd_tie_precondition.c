/* The factor of sd_tie_factor.h applied to a vector. */
#include "sd_tie_factor.h"

#include <string.h>

static void weigh_shared(const sd_tie *t)
{
  for (int k = 0; k < t->shares; k++)
    for (int d = 0; d < 6; d++) t->all[6 * (long) t->shared[k] + d] *= t->weight[t->shared[k]];
}

/* This rank's bodies to the factors that they are in, where bodies that are not at its border are 0 */
static void send_lent(const sd_tie *t)
{
  memset(t->sent, 0, sizeof(double) * 6 * (size_t) t->lents);
  for (long k = 0; k < t->lents; k++)
    if (t->lent[k] >= 0) memcpy(t->sent + 6 * k, t->all + 6 * (long) t->lent[k], 6 * sizeof(double));
}

static void add_lent(const sd_tie *t)
{
  for (long k = 0; k < t->lents; k++)
    for (int d = 0; d < 6 && t->lent[k] >= 0; d++) t->all[6 * (long) t->lent[k] + d] += t->sent[6 * k + d];
}

/* What all ranks together do to bodies at borders: forth and back are each rank's own. */
static sd_status meet_at_borders(const sd_bodies *A)
{
  const sd_tie *t = A->tie;
  const sd_world *world = &t->L->world;
  double *others = t->all + 6 * (long) sd_bodies_count(A);
  weigh_shared(t);
  send_lent(t);
  sd_status status = world->exchange(world->ctx, t->sent, t->lend, others, t->borrow);
  if (status != SD_OK) return status;
  sd_block_cholesky_middle(&t->factor, t->all);
  for (int k = 0; k < t->aways; k++) memset(t->all + 6 * (long) t->away[k], 0, 6 * sizeof(double));
  status = world->exchange(world->ctx, others, t->borrow, t->sent, t->lend);
  add_lent(t);
  weigh_shared(t);
  return status;
}

sd_status sd_tie_precondition(const sd_bodies *A, const double *r, double *z)
{
  const sd_tie *t = A->tie;
  const long size = 6 * (long) sd_bodies_count(A);
  sd_status status = SD_OK;
  for (long j = 0; j < size; j++) t->all[j] = t->scale[j] * r[j];
  if (sd_tie_is_layered(A)) {
    memset(t->all + size, 0, sizeof(double) * 6 * (size_t) t->others);
    sd_block_cholesky_forth(&t->factor, t->all);
    status = meet_at_borders(A);
    sd_block_cholesky_back(&t->factor, t->all);
  } else
    sd_block_cholesky_apply(&t->factor, t->all);
  for (long j = 0; j < size; j++) z[j] = t->scale[j] * t->all[j];
  return status;
}
