/* Preconditioners of conjugate gradients: approximations P of the inverse of the mobility matrix M.
 *
 * All are made of the matrix with unit diagonal, C = D^1/2 M D^1/2 (sd_unit.h), whose blocks depend
 * on positions, radii and the law only: P = D^1/2 (approximation of C^-1) D^1/2. A preconditioner
 * changes the number of iterations, never the answer. */
#ifndef SD_PRECONDITION_H
#define SD_PRECONDITION_H

#include "sd_precondition_case.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A kind of preconditioner: functions on a struct of its own, `size` bytes of zeros in the
 * beginning.
 * make and move are called on all ranks, and fail on all if they fail on one: SD_ENOMEMORY,
 * SD_EINDEFINITE, SD_ENOTFINITE, that of the sum. What could not be made is empty; what could not
 * be moved, or is to be made again, wants to be freed. */
typedef struct {
  const char *name;
  size_t size;
  sd_status (*make)(void *P, const sd_precondition_case *c);
  /* The same spheres and clumps, elsewhere: keeps what is still good. */
  sd_status (*move)(void *P, const sd_precondition_case *c);
  /* Ready once made */
  sd_precondition *apply;
  void (*free)(void *P);
} sd_precondition_kind;

extern const sd_precondition_kind
    /* P = D: conjugate gradients as they are without */
    sd_precondition_none,
    /* the inverse of each clump, and what clumps do to one another as wholes (sd_blocks.h) */
    sd_precondition_blocks,
    /* a sparse factor of the inverse (sd_sparse.h) */
    sd_precondition_sparse,
    /* periodic boxes: the longest waves, and the inverse of each clump if there are any
     * (sd_waves.h). It stays good while spheres move less than a radius or so; `move` keeps it as
     * it is, and wants the same spheres in the same order on every rank */
    sd_precondition_waves;

#ifdef __cplusplus
}
#endif
#endif
