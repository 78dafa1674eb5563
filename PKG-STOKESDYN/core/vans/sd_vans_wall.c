#include "sd_vans.h"

#include <math.h>

/* With y = sqrt(f) and L(y) = A ln(Re y) + 0.32, A = 2/ln 10, the law is y L = 1. Of y L - 1 the
 * slope is L + A, and it is convex: Newton's steps from the right of the solution go left and
 * never beyond it, and max(1/Re, 1/0.32) lies on the right, for there L >= 0.32 and y L >= 1. Where
 * L + A <= 0 no step leads to it. From near by a step of relative size s leaves an error of order
 * s^2. */
static double newton(double Re, double y)
{
  const double A = 2.0 / 2.302585092994046;
  for (int k = 0; k < 50; k++) {
    const double L = A * log(Re * y) + 0.32, slope = L + A;
    if (!(slope > 0.0)) {
      y = fmax(1.0 / Re, 1.0 / 0.32);
      continue;
    }
    const double step = (y * L - 1.0) / slope;
    y -= step;
    if (fabs(step) <= 3e-7 * y) break;
  }
  return y;
}

static double substitution(double Re)
{
  double y = 1.0 / 0.32, f = y * y;
  for (int k = 1; k <= 100; k++) {
    y = 1.0 / fabs(2.0 * log(Re * y) + 0.32);
    const double change = fabs(y * y - f);
    if (change < 1e-2 * f) return y * y;
    f = y * y;
  }
  return 0.0;
}

double sd_vans_wall_friction(sd_vans_rules rules, double Re, double *root)
{
  if (!(Re > 1e-10)) Re = 1e-10;
  if (rules == SD_VANS_YADE) return substitution(Re);
  *root = newton(Re, *root);
  return *root * *root;
}
