#include "sd_precondition.h"

#include "sd_blocks.h"
#include "sd_sparse.h"
#include "sd_waves.h"

/* Without a block every sphere is by itself. */
static sd_status make_none(void *P, const sd_precondition_case *c)
{
  static const long first[1] = {0};
  sd_precondition_case spheres = *c;
  spheres.clumps = 0;
  spheres.first = first;
  return sd_blocks_make(P, &spheres);
}

static sd_status move_none(void *P, const sd_precondition_case *c)
{
  sd_blocks_free(P);
  return make_none(P, c);
}

static sd_status make_blocks(void *P, const sd_precondition_case *c)
{
  return sd_blocks_make(P, c);
}

static sd_status move_blocks(void *P, const sd_precondition_case *c)
{
  return sd_blocks_move(P, c);
}

static void free_blocks(void *P)
{
  sd_blocks_free(P);
}

/* The factor is of matrix C, which knows no viscosity; where spheres have moved a little it is
 * still near, and the choice of sd_choice.h says when it is worn. */
static sd_status make_sparse(void *P, const sd_precondition_case *c)
{
  const sd_status status = sd_sparse_create(P, &c->law, &c->spheres, c->n, c->width, c->rho,
                                            c->part, c->parts);
  const sd_status agreed = sd_precondition_agree(c, status);
  if (agreed != SD_OK) sd_sparse_free(P);
  return agreed;
}

static sd_status move_sparse(void *P, const sd_precondition_case *c)
{
  sd_sparse_scale(P, &c->spheres);
  return SD_OK;
}

static void free_sparse(void *P)
{
  sd_sparse_free(P);
}

static sd_status make_waves(void *P, const sd_precondition_case *c)
{
  return sd_waves_make(P, c);
}

/* Factor and waves belong to the places at set-up. New ones for the waves alone would make P
 * indefinite. */
static sd_status move_waves(void *P, const sd_precondition_case *c)
{
  (void) P;
  (void) c;
  return SD_OK;
}

static void free_waves(void *P)
{
  sd_waves_free(P);
}

const sd_precondition_kind sd_precondition_none = {
    "none", sizeof(sd_blocks), make_none, move_none, sd_blocks_apply, free_blocks};
const sd_precondition_kind sd_precondition_blocks = {
    "clump", sizeof(sd_blocks), make_blocks, move_blocks, sd_blocks_apply, free_blocks};
const sd_precondition_kind sd_precondition_sparse = {
    "sparse", sizeof(sd_sparse), make_sparse, move_sparse, sd_sparse_apply, free_sparse};
const sd_precondition_kind sd_precondition_waves = {
    "waves", sizeof(sd_waves), make_waves, move_waves, sd_waves_apply, free_waves};
