/* The spheres of an Ewald sum, by their radii. */
#ifndef SD_EWALD_SIZES_H
#define SD_EWALD_SIZES_H

#include "sd_extern_c.h"

SD_BEGIN_C

/* Classes of radii */
enum { SD_EWALD_OCTAVES = 10 };

/* The spheres that take part, of all ranks: how many, sums of a^2 and a^4, the largest a; length.
 * The rule reads them rounded to six digits, since sums over ranks differ in the last ones. */
typedef struct {
  double count, squares, fourths, largest;
} sd_ewald_class;

/* All of them; and by octaves, which only sd_ewald_levels.h reads: k has those from
 * largest/2^(k + 1) to largest/2^k, that one not included except in octave 0, and the last all that
 * are smaller. */
typedef struct {
  sd_ewald_class all, octave[SD_EWALD_OCTAVES];
} sd_ewald_sizes;

/* So many more spheres; all.largest is known already. */
void sd_ewald_count(sd_ewald_sizes *s, double a, int alike);
void sd_ewald_add_class(sd_ewald_class *sum, const sd_ewald_class *s);

SD_END_C
#endif
