/* The incomplete factor of the H of sd_tie.h, which preconditions its conjugate gradients.
 *
 * Each rank has the factor of its own bodies and of those of other ranks whose spheres are within
 * the range of films of its own (additive Schwarz):
 *
 *   P^-1 = W [ sum over ranks  R^T H_R^-1 R ] W,   H_R: the rows and columns of H of these bodies
 *
 * Stiff pairs chain bodies together, and a factor that ends at the last body of a rank would not
 * know how they move as one: products with L would have no end. With W = 1 a body that m ranks have
 * counts m times, which makes products twice as many as with one factor of all, on four ranks of
 * 100 spheres each, and half as many more on two (test_tie_ranks.c). W = 1/sqrt(m) takes that out,
 * and as many products are left as on one rank or a few more. But bodies of different W move against
 * each other where they should move as one, so that bodies with a stiff pair keep W = 1.
 * Memory and messages are those of a rank's bodies and its surface. */
#ifndef SD_TIE_FACTOR_H
#define SD_TIE_FACTOR_H

#include "sd_tied.h"

/* Where A->tie->L stands. On all ranks together, which agree on failures. Status as of sd_tie_make. */
sd_status sd_tie_factor(const sd_bodies *A);
/* z = P^-1 r, by bodies; 0 for those that nobody is near to, and held ones. SD_OK; that of a
 * function of sd_world */
sd_status sd_tie_precondition(const sd_bodies *A, const double *r, double *z);

#endif
