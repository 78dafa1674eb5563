/* Preconditioners of conjugate gradients: approximations P of the inverse of the mobility matrix M.
 *
 * All are made of the matrix with unit diagonal, C = D^1/2 M D^1/2 (sd_unit.h), whose blocks depend
 * on positions, radii and the law only: P = D^1/2 (approximation of C^-1) D^1/2. A preconditioner
 * changes the number of iterations, never the answer. */
#ifndef SD_PRECONDITION_H
#define SD_PRECONDITION_H

#include "sd_ewald.h"
#include "sd_product.h"
#include "sd_solve.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a preconditioner is made of. */
typedef struct {
  sd_law law;
  /* [n] those with radius 0 take no part */
  sd_spheres spheres;
  /* Unknowns of a sphere, width: 3 (force), with rotation 6 (force and torque) */
  int n, width;
  /* Clump k is of the spheres member[first[k]] ... member[first[k + 1] - 1]; no sphere is in two.
   * */
  int clumps;
  const long *first;
  const int *member;
  /* The periodic box, of the long waves (sd_waves.h) alone. NULL: open space */
  const sd_ewald_box *box;
  /* Reach of the sparse factor (sd_sparse.h), and of the one that couples blocks. 0: the blocks are
   * not coupled, and never moved. */
  double rho;
  /* P is the sum of `parts` terms, and this is term `part`: what apply returns is to be summed. */
  int part, parts;
  /* Over all ranks, parts or not, so that they agree on failures; NULL: one rank, one part. */
  sd_sum *sum;
  void *sum_ctx;
} sd_precondition_case;

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

/* The status of this rank, or another failure if another rank has failed. */
sd_status sd_precondition_agree(const sd_precondition_case *c, sd_status mine);

#ifdef __cplusplus
}
#endif
#endif
