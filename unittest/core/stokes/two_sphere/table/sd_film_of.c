#include "sd_film_of.h"

sd_film sd_film_of(const sd_pair_resistance *R, double a1, double a2, double distance)
{
  const sd_pair_resistance Q = sd_pair_resistance_relative(R, a1, a2, distance);
  return (sd_film){Q.XA[0], Q.XC[0], {Q.YC[0], Q.YC[1], Q.YC[2]}, 0.0};
}
