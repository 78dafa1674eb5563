/* The incomplete factor of the H of sd_tie.h, which preconditions its conjugate gradients.
 *
 * Each rank eliminates its bodies that have no film with one of another rank, weak ones apart. What is
 * left, S, is of the bodies at borders. Of two spheres with a film across a border one is above the other
 * (t->above). Of S each rank has the factor of its own bodies with a pair above, and of the others in
 * these pairs, of which their ranks tell it what their elimination has left (sd_tie_border.h). Where the
 * borders of some rank meet, so that bodies which its elimination has coupled would be in no factor
 * together, each rank has all bodies of its borders, its own and the others (additive Schwarz), among more
 * than two ranks also those whose pairs across them are weak:
 *
 *   P^-1 = C^-T [ 1 of those eliminated; W (sum over ranks  R^T S_R^-1 R) W of those left ] C^-1
 *   S_R: the rows and columns of S of these bodies;   W = 1/sqrt(m) of a body that is in m factors
 *
 * Of slabs borders are apart: each body is in one factor, all S_R together are S, and P is as good as one
 * factor of all: there are as many products with films as on one rank (test_tie_ranks.c), and so there are
 * between two ranks, of which each S_R is S where borders meet. Among more, S_R ends behind the next
 * rank's border: a melt of shells takes as many or a fifth more on four ranks, spheres chained by stiff
 * pairs up to 1.9 times as many. Bodies of different W move against each other where they should move as
 * one, so that those with a stiff pair have at least W = 1/sqrt(2), which is that of all others but where
 * more than two ranks meet. Without weights a scene without stiff pairs takes 1.3 times as many on four
 * ranks. If all bodies of a rank were eliminated with those next to them, so that nobody told what is
 * left, the melt would take 1.4 times as many on two ranks and 1.8 times on four. Memory and messages are
 * those of a rank's bodies and its surface. */
#ifndef SD_TIE_FACTOR_H
#define SD_TIE_FACTOR_H

#include "sd_tied.h"

/* Where A->tie->L stands, or the one of before (A->tie->keep); blocks [36 bodies]: scratch. On all ranks
 * together, which agree on failures. Status as of sd_tie_make. */
sd_status sd_tie_factor(const sd_bodies *A, double *blocks);
/* z = P^-1 r, by bodies; 0 for those that nobody is near to, and held ones. SD_OK; that of a function of
 * sd_world */
sd_status sd_tie_precondition(const sd_bodies *A, const double *r, double *z);

#endif
