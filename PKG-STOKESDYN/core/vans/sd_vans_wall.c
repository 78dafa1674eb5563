#include "sd_vans.h"

#include <math.h>

/* With y = sqrt(f) and L(y) = A ln(Re y) + 0.32, A = 2/ln 10, the law is G = y L - 1 = 0, with the
 * slope G' = L + A and G'' = A/y > 0. Halley's step, 2 G G'/(2 G'^2 - G G''), has the one logarithm
 * and the one division of Newton's, and from near by a step of relative size s leaves an error
 * below s^3: with the root of the time step before, one step is enough. From the right of the
 * solution the steps go left to it; max(1/Re, 1/0.32) lies there, for it has L >= 0.32 and
 * y L >= 1. Where L + A <= 0 no step leads to it. */
static double root_of_law(double Re, double y)
{
  const double A = 2.0 / 2.302585092994046;
  for (int k = 0; k < 50; k++) {
    const double L = A * log(Re * y) + 0.32, slope = L + A, G = y * L - 1.0;
    const double step = 2.0 * y * G * slope / (2.0 * y * slope * slope - G * A);
    if (!(slope > 0.0 && step < y)) {
      y = fmax(1.0 / Re, 1.0 / 0.32);
      continue;
    }
    y -= step;
    if (fabs(step) <= 3e-5 * y) break;
  }
  return y;
}

/* In the arithmetic of the original, step by step: below Re of about 1 the substitution wanders,
 * and another rounding there is another answer. */
static double substitution(double Re)
{
  double f = 1.0 / (0.32 * 0.32);
  for (int k = 1; k <= 100; k++) {
    const double root = 2.0 * log(Re * sqrt(f)) + 0.32, next = 1.0 / (root * root);
    const double change = fabs(next - f) / f;
    f = next;
    if (change < 1e-2) return f;
  }
  return 0.0;
}

double sd_vans_wall_friction(sd_vans_rules rules, double Re, double *root)
{
  if (!(Re > 1e-10)) Re = 1e-10;
  if (rules == SD_VANS_YADE) return substitution(Re);
  *root = root_of_law(Re, *root);
  return *root * *root;
}
