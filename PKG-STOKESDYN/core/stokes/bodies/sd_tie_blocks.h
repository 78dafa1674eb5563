/* The blocks of the H of sd_tie.h, in units of the drags of the bodies, for its factor (sd_tie_factor.h). */
#ifndef SD_TIE_BLOCKS_H
#define SD_TIE_BLOCKS_H

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

/* From the centre of its body to a sphere of this rank, or to a copy: of those alone place [SD_PLACE
 * copies] is read */
const double *sd_tie_arm(const sd_bodies *A, const double *place, int sphere);
/* H_ii, diagonal [36 bodies], and A->tie->scale. A body that nobody is near to is taken out by a scale of
 * 0, and so is what is given of one's velocity. */
void sd_tie_find_diagonal(const sd_bodies *A, double *diagonal);
/* scaled [36] += H_ij of pair k of A->tie->L; the square of its norm. 0, and nothing is added, where that
 * norm is known to be below `weak` */
double sd_tie_find_block(const sd_bodies *A, const double *place, long k, double weak, double scaled[36]);

#endif
