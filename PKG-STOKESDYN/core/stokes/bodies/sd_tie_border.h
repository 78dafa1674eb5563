/* Bodies of two ranks that films bind to each other, in the factors of sd_tie_factor.h.
 *
 * A rank first eliminates those of its own that are not at a border. What that leaves of the others it
 * tells the ranks that have these in their factors. */
#ifndef SD_TIE_BORDER_H
#define SD_TIE_BORDER_H

#include "sd_tied.h"

/* Ranks tell each other which bodies of another each has in its factor: other -> lent, lend,
 * borrow of its border.
 * mine: that of this rank so far, with which others go no further. On all ranks together, which agree on
 * the status: SD_OK; SD_ENOMEMORY; mine or that of another; that of a function of sd_world */
sd_status sd_tie_border_lend(const sd_bodies *A, sd_status mine);
/* When all else is eliminated: blocks of the others, from the ranks that own them, into the factor. A body
 * of which nothing comes, since by rounding it is at no border there, gets the unit matrix. Likewise; what
 * the factor said of these blocks is each rank's own. */
sd_status sd_tie_border_share(const sd_bodies *A);

#endif
