/* A resistance of two spheres as a film, for the table of shells and for tests. */
#ifndef SD_FILM_OF_H
#define SD_FILM_OF_H

#include "sd_film.h"

/* R, which resists rigid motions or not, as it acts on the relative motion of a pair: a film that is
 * not clipped. Linear in R. */
sd_film sd_film_of(const sd_pair_resistance *R, double a1, double a2, double distance);

#endif
