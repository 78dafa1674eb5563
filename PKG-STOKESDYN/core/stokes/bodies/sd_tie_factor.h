/* What ties bodies together, and the incomplete factor of their H: it preconditions the conjugate
 * gradients of sd_tie.h. */
#ifndef SD_TIE_FACTOR_H
#define SD_TIE_FACTOR_H

#include "sd_block_cholesky.h"
#include "sd_bodies_rigid.h"
#include "sd_lubrication.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Vectors have 6 numbers a body: the free spheres in the order of loner, then the clumps:
 * velocities in space axes, U at the centroid. Zero-initialise, set L; sd_tie_free in the end. */
typedef struct sd_tie {
  sd_lubrication *L;
  /* of the bodies of all ranks */
  sd_block_cholesky factor;
  /* what the model resists beside the drags (sd_tie_approach.h): by pairs of L; by spheres, L_ii
   * and its own together */
  float (*spring)[3];
  double *stiff;
  /* products with L since sd_tie_make */
  long products;
  /* by bodies: which of all it is; 1 over the roots of the diagonal of H_0, 0: nobody is near */
  int *number;
  double *scale;
  /* scratch: by bodies of all ranks, by bodies, by rows, by ghosts */
  double *all, *vectors, *rows, *ghosts;
  size_t most_springs, most_stiff, most_vectors, most_rows, most_ghosts;
} sd_tie;

static inline long sd_tie_bodies(const sd_bodies *A)
{
  return (long) A->lone + A->clumps;
}

/* A clump of several ranks is counted on the one that has its first sphere. */
static inline int sd_tie_ours(const sd_bodies *A, int b)
{
  return A->member[A->first[b]] < A->n;
}

/* Of all ranks: the incomplete factor of H. SD_OK; SD_ENOMEMORY; SD_ESINGULAR; SD_ENOTFINITE; that
 * of a function of the caller */
sd_status sd_tie_factor(const sd_bodies *A);
/* z = P^-1 r, by numbers of bodies; 0 for those that nobody is near to */
sd_status sd_tie_precondition(const sd_bodies *A, const double *r, double *z);

#ifdef __cplusplus
}
#endif
#endif
