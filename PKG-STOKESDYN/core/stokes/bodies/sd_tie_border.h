/* Bodies of two ranks that films bind to each other, in the factors of sd_tie_factor.h.
 *
 * All that have a sphere near one of another rank are at the border. A rank first eliminates those of
 * its own that are not, of which no other rank knows. What that leaves of its bodies at the border, it
 * tells each rank that has these in its factor as well. */
#ifndef SD_TIE_BORDER_H
#define SD_TIE_BORDER_H

#include "sd_tied.h"

/* What other ranks know of a sphere: whose it is, row and number of the body there; from the centre
 * of the body to it; scales of the body */
enum {
  SD_PLACE_RANK,
  SD_PLACE_ROW,
  SD_PLACE_BODY,
  SD_PLACE_ARM,
  SD_PLACE_SCALE = SD_PLACE_ARM + 3,
  SD_PLACE = SD_PLACE_SCALE + 6
};

/* All bodies at the border, A->tie->others among them, are put off in the factor. */
void sd_tie_border_put_off(const sd_bodies *A);
/* When all else is eliminated: blocks of the others come from the ranks that own them. place
 * [SD_PLACE copies]; ranks [bodies] out: how many have each body of this rank; mine: that of this rank
 * so far, with which others go no further. On all ranks together, which must agree on the status: SD_OK;
 * SD_ENOMEMORY; mine or that of another; that of a function of sd_world */
sd_status sd_tie_border_share(const sd_bodies *A, const double *place, double *ranks, sd_status mine);

/* What all ranks together do to bodies at the border, A->tie->all: forth and back are each rank's own
 * (sd_tie_factor.h). rows [6 spheres]: scratch. SD_OK or that of a function of sd_world. */
sd_status sd_tie_border_meet(const sd_bodies *A, double *rows);

#endif
