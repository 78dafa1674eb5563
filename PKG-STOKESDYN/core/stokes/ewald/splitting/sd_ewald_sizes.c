#include "sd_ewald_sizes.h"

#include <math.h>

void sd_ewald_add_class(sd_ewald_class *sum, const sd_ewald_class *s)
{
  sum->count += s->count;
  sum->squares += s->squares;
  sum->fourths += s->fourths;
  sum->largest = fmax(sum->largest, s->largest);
}

/* Of spheres up to the radius `largest`, which octave is one of radius a > 0? */
static int octave_of(double largest, double a)
{
  int k = 0;
  while (k + 1 < SD_EWALD_OCTAVES && a < ldexp(largest, -k - 1)) k++;
  return k;
}

void sd_ewald_count(sd_ewald_sizes *s, double a, int alike)
{
  const double a2 = a * a;
  const sd_ewald_class some = {alike, alike * a2, alike * a2 * a2, a};
  sd_ewald_add_class(&s->all, &some);
  sd_ewald_add_class(s->octave + octave_of(s->all.largest, a), &some);
}
