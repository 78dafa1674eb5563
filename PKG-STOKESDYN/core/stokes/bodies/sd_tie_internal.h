/* The two halves of sd_tie.h: conjugate gradients (sd_tie.c), and what preconditions them
 * (sd_tie_factor.c). */
#ifndef SD_TIE_INTERNAL_H
#define SD_TIE_INTERNAL_H

#include "sd_bodies_internal.h"
#include "sd_tie.h"

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

#endif
