/* Preconditioners of conjugate gradients: approximations P of the inverse of the mobility matrix M.
 * None at all is P = D, the diagonal, which solvers take by themselves.
 *
 * All are made of the matrix with unit diagonal, C = D^1/2 M D^1/2, whose blocks depend
 * on positions, radii and the law only: P = D^1/2 (approximation of C^-1) D^1/2. A preconditioner
 * changes the number of iterations, never the answer.
 *
 * P is a function of the positions that it is made of, and of nothing that a run remembers besides:
 * whoever keeps those (sd_preconditioner.h) has the same P again on other ranks and after a
 * restart. Blocks have a root as well (sd_blocks.h). */
#ifndef SD_PRECONDITION_H
#define SD_PRECONDITION_H

#include "sd_ewald.h"
#include "sd_product.h"
#include "sd_solve.h"
#include "sd_world.h"

#include <stddef.h>

SD_BEGIN_C

/* What it is made of */
typedef struct {
  sd_law law;
  /* [n] those with radius 0 take no part */
  sd_spheres spheres;
  /* Unknowns of a sphere, width: 3 (force), with rotation 6 (force and torque) */
  int n, width;
  /* Clump k is of the spheres member[first[k]] ... member[first[k + 1] - 1]; no sphere is in
   * two. */
  int clumps;
  const long *first;
  const int *member;
  /* The periodic box, of the long waves (sd_waves.h) alone. NULL: open space */
  const sd_ewald_box *box;
  /* P is the sum of `parts` terms, and this is term `part`: what apply returns is to be summed. */
  int part, parts;
  /* sum: over all ranks, parts or not, so that they agree on failures */
  sd_world world;
} sd_precondition_case;

/* A kind of preconditioner: functions on a struct of its own, `size` bytes of zeros in the
 * beginning. make is called on all ranks, and fails on all if it fails on one: SD_ENOMEMORY,
 * SD_EINDEFINITE, SD_ENOTFINITE, that of the sum. What could not be made is empty. */
typedef struct {
  size_t size;
  sd_status (*make)(void *P, const sd_precondition_case *c);
  /* Ready once made */
  sd_precondition *apply;
  void (*free)(void *P);
} sd_precondition_kind;

extern const sd_precondition_kind
    /* the inverse of each clump (sd_blocks.h) */
    sd_precondition_blocks,
    /* a sparse factor of the inverse, of reach 3 (sd_sparse.h) */
    sd_precondition_sparse,
    /* periodic boxes: the longest waves, and the inverse of each clump if there are any
     * (sd_waves.h) */
    sd_precondition_waves;

SD_END_C
#endif
