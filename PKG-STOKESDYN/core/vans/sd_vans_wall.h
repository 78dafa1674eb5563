/* Friction of the side walls from a table: the substitution of sd_vans_wall_friction costs five logarithms in every slice
 * and step, but f is a smooth
 * function of Re except where the number of rounds changes. So: every binade of Re in equal parts, in each a polynomial
 * through Chebyshev
 * points, kept if it gives f to 1e-11 and the number of rounds is one and the same; else the substitution itself. */
#ifndef SD_VANS_WALL_H
#define SD_VANS_WALL_H

#include "sd_vans.h"

#include <string.h>

enum {
  SD_VANS_WALL_BITS = 5, /* 32 parts a binade */
  SD_VANS_WALL_DEGREE = 5,
  SD_VANS_WALL_LOWEST = -34, /* Re = 2^-34 .. 2^40 */
  SD_VANS_WALL_HIGHEST = 40,
  SD_VANS_WALL_TABLE = (SD_VANS_WALL_HIGHEST - SD_VANS_WALL_LOWEST) << SD_VANS_WALL_BITS
};

typedef struct {
  double coefficient[SD_VANS_WALL_DEGREE + 1]; /* of t = (Re - middle) scale in [-1, 1] */
  double middle, scale;                        /* scale 0: no polynomial here */
} sd_vans_wall_segment;

/* table [SD_VANS_WALL_TABLE], filled */
void sd_vans_wall_table(sd_vans_rules rules, sd_vans_wall_segment *table);

static inline double sd_vans_wall_polynomial(const sd_vans_wall_segment *s, double Re)
{
  const double t = (Re - s->middle) * s->scale, t2 = t * t;
  const double *c = s->coefficient;
  return (c[0] + c[1] * t) + t2 * ((c[2] + c[3] * t) + t2 * (c[4] + c[5] * t));
}

/* Exponent and leading bits of the mantissa are the place in the table. Re >= 0. */
static inline double sd_vans_wall_lookup(const sd_vans_wall_segment *table, sd_vans_rules rules,
                                         double Re)
{
  uint64_t bits;
  memcpy(&bits, &Re, sizeof bits);
  const uint64_t k = (bits >> (52 - SD_VANS_WALL_BITS)) -
      ((uint64_t) (1023 + SD_VANS_WALL_LOWEST)
       << SD_VANS_WALL_BITS); /* huge if Re is below the table */
  if (k >= SD_VANS_WALL_TABLE || table[k].scale == 0.0) return sd_vans_wall_friction(rules, Re, 0);
  return sd_vans_wall_polynomial(&table[k], Re);
}

#endif
