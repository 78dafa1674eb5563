#include "sd_vans_wall.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

double sd_vans_wall_friction(sd_vans_rules rules, double Re, int *rounds)
{
  double f = 1.0 / (0.32 * 0.32);
  if (!(Re > 1e-10)) Re = 1e-10;
  for (int k = 1; k <= 100; k++) {
    const double root =
                     2.0 * (rules == SD_VANS_YADE ? log(Re * sqrt(f)) : log10(Re * sqrt(f))) + 0.32,
                 next = 1.0 / (root * root);
    const double change = fabs(next - f) / f;
    f = next;
    if (rounds) *rounds = k;
    if (change < 1e-2) return f;
  }
  return 0.0;
}

enum { SEGMENTS = 1 << SD_VANS_WALL_BITS, DEGREE = SD_VANS_WALL_DEGREE };

static void fit(sd_vans_rules rules, double lo, double hi, sd_vans_wall_segment *s)
{
  double t[DEGREE + 1], divided[DEGREE + 1];
  int rounds, rounds_low, rounds_high;
  sd_vans_wall_friction(rules, lo, &rounds_low);
  sd_vans_wall_friction(rules, hi, &rounds_high);
  int smooth = rounds_low == rounds_high;
  s->middle = 0.5 * (lo + hi);
  s->scale = 2.0 / (hi - lo);
  for (int k = 0; k <= DEGREE; k++) {
    t[k] = cos(PI * (k + 0.5) / (DEGREE + 1));
    divided[k] = sd_vans_wall_friction(rules, s->middle + t[k] / s->scale, &rounds);
    smooth = smooth && rounds == rounds_low;
  }
  /* Newton's divided differences, then to powers of t. */
  for (int order = 1; order <= DEGREE; order++)
    for (int k = DEGREE; k >= order; k--)
      divided[k] = (divided[k] - divided[k - 1]) / (t[k] - t[k - order]);
  for (int k = 0; k <= DEGREE; k++) s->coefficient[k] = 0.0;
  for (int k = DEGREE; k >= 0; k--) {
    for (int m = DEGREE; m > 0; m--)
      s->coefficient[m] = s->coefficient[m - 1] - t[k] * s->coefficient[m];
    s->coefficient[0] = divided[k] - t[k] * s->coefficient[0];
  }
  for (int k = 0; k <= 2 * DEGREE && smooth; k++) {
    const double Re = lo + (hi - lo) * k / (2.0 * DEGREE), f = sd_vans_wall_friction(rules, Re, 0);
    smooth = fabs(sd_vans_wall_polynomial(s, Re) - f) <= 1e-11 * f;
  }
  if (!smooth) s->scale = 0.0;
}

void sd_vans_wall_table(sd_vans_rules rules, sd_vans_wall_segment *table)
{
  for (int k = 0; k < SD_VANS_WALL_TABLE; k++) {
    const int exponent = SD_VANS_WALL_LOWEST + k / SEGMENTS;
    const double binade = ldexp(1.0, exponent);
    fit(rules, binade * (1.0 + (double) (k % SEGMENTS) / SEGMENTS),
        binade * (1.0 + (double) (k % SEGMENTS + 1) / SEGMENTS), &table[k]);
    if (exponent >= -5 && exponent < 5)
      table[k].scale =
          0.0; /* the substitution wanders there: steps closer than the points that look for them */
  }
}
