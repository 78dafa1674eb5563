/* The incomplete factor of the H of sd_tie.h, which preconditions its conjugate gradients.
 *
 * Each rank eliminates its bodies that have no film with one of another rank. What is left, S, is of the
 * bodies at the border. Of S each rank has the factor of its own bodies and of those of other ranks that
 * have films with its own (additive Schwarz), to which each adds what its elimination has left of its own
 * (sd_tie_border.h):
 *
 *   P^-1 = C^-T [ 1 of those eliminated; W (sum over ranks  R^T S_R^-1 R) W of those left ] C^-1
 *   S_R: the rows and columns of S of these bodies;   W = 1/sqrt(m) of a body that m ranks have
 *
 * Between two ranks all S_R are S, and P is as good as one factor of all: there are as many products with
 * films as on one rank (test_tie_ranks.c). Among more, S_R ends behind the next rank's border: a melt of
 * shells takes as many or a fifth more on four ranks, spheres chained by stiff pairs up to 1.8 times as many.
 * Bodies of different W move against each other where they should move as one, so that those with a stiff
 * pair have at least W = 1/sqrt(2), which is that of all others but where more than two ranks meet. Without
 * weights a scene without stiff pairs takes 1.3 times as many on four ranks.
 * If all bodies of a rank were eliminated with those next to them, so that nobody told what is left, the melt
 * would take 1.4 times as many on two ranks and 1.8 times on four.
 * Memory and messages are those of a rank's bodies and its surface. */
#ifndef SD_TIE_FACTOR_H
#define SD_TIE_FACTOR_H

#include "sd_tied.h"

/* Where A->tie->L stands; blocks [36 bodies]: scratch. On all ranks together, which agree on failures.
 * Status as of sd_tie_make. */
sd_status sd_tie_factor(const sd_bodies *A, double *blocks);
/* z = P^-1 r, by bodies; 0 for those that nobody is near to, and held ones. rows [6 spheres]:
 * scratch. SD_OK; that of a function of sd_world */
sd_status sd_tie_precondition(const sd_bodies *A, const double *r, double *rows, double *z);

#endif
