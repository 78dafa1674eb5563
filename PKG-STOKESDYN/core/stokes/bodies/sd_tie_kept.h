/* May the factor of sd_tie_factor.h stay, which was made of another H?
 *
 * As a preconditioner it will do while it is near to H in every direction. What is stiff, and what changes
 * much, are translations. Of each body their block in H_ii is compared with that of then,
 *
 *   tr(B_then^-1 B) + tr(B^-1 B_then) - 6  =  sum over eigenvalues x of B_then^-1 B  of  x + 1/x - 2,
 *
 * which is 0 where nothing has changed and counts what has become soft as what has become stiff. The factor
 * stays while that is at most `limit` for all bodies but one in a thousand, each of which costs conjugate
 * gradients a direction. */
#ifndef SD_TIE_KEPT_H
#define SD_TIE_KEPT_H

#include "sd_tied.h"

/* blocks [36 bodies]: those of sd_tie_find_diagonal as the bodies stand now; there is room for made_of.
 * sd_tie_kept: *stays, on all ranks alike; mine: the status of this rank, with which nothing stays; SD_OK or
 * that of sum. sd_tie_note: the factor is being made of them. */
sd_status sd_tie_kept(const sd_bodies *A, const double *blocks, sd_status mine, int *stays);
void sd_tie_note(const sd_bodies *A, const double *blocks);

#endif
