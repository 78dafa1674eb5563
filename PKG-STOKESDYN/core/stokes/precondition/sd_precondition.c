#include "sd_precondition.h"

#include "sd_blocks.h"
#include "sd_sparse.h"
#include "sd_waves.h"

/* Reach of the sparse factor: 42 blocks per sphere in a compact cloud */
static const double RHO = 3.0;

static sd_status make_blocks(void *P, const sd_precondition_case *c)
{
  return sd_blocks_make(P, c);
}

static void free_blocks(void *P)
{
  sd_blocks_free(P);
}

static sd_status make_sparse(void *P, const sd_precondition_case *c)
{
  const sd_status status =
      sd_sparse_create(P, &c->law, &c->spheres, c->n, c->width, RHO, c->part, c->parts);
  const sd_status agreed = sd_precondition_agree(c, status);
  if (agreed != SD_OK) sd_sparse_free(P);
  return agreed;
}

static void free_sparse(void *P)
{
  sd_sparse_free(P);
}

static sd_status make_waves(void *P, const sd_precondition_case *c)
{
  return sd_waves_make(P, c);
}

static void free_waves(void *P)
{
  sd_waves_free(P);
}

const sd_precondition_kind sd_precondition_blocks = {sizeof(sd_blocks), make_blocks,
                                                     sd_blocks_apply, free_blocks};
const sd_precondition_kind sd_precondition_sparse = {sizeof(sd_sparse), make_sparse,
                                                     sd_sparse_apply, free_sparse};
const sd_precondition_kind sd_precondition_waves = {sizeof(sd_waves), make_waves, sd_waves_apply,
                                                    free_waves};
