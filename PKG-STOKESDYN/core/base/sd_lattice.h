/* Images of a periodic box. */
#ifndef SD_LATTICE_H
#define SD_LATTICE_H

#include "sd_extern_c.h"

SD_BEGIN_C

/* Makes the separation d the shortest of its images in a box with the edges (h0 0 0), (h5 h1 0),
 * (h4 h3 h2) (the order of LAMMPS: xx yy zz yz xz xy), of which those with periodic = 1 repeat. In
 * a skew box this need not be LAMMPS's minimum image. Whatever d is, 1e300 or not a number, it
 * comes back at once. */
void sd_closest_image(const double h[6], const int periodic[3], double d[3]);

SD_END_C
#endif
