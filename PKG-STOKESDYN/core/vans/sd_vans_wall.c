#include "sd_vans_internal.h"
#include "sd_vans_yade.h"

#include <math.h>

enum { ORDER = SD_VANS_FRICTION_TERMS };

/* With y = sqrt(f) and L(y) = A ln(Re y) + 0.32, A = 2/ln 10, the law is G = y L - 1 = 0, with the
 * slope G' = L + A and G'' = A/y > 0. Halley's step, 2 G G'/(2 G'^2 - G G''), has the one logarithm
 * and the one division of Newton's, and from near by a step of relative size s leaves an error
 * below s^3. From the right of the solution the steps go left to it; max(1/Re, 1/0.32) lies there,
 * for it has L >= 0.32 and y L >= 1. Where L + A <= 0 no step leads to it. */
static double root_of_law(double Re, double y)
{
  const double A = 2.0 / 2.302585092994046;
  for (int k = 0; k < 50; k++) {
    const double L = A * log(Re * y) + SD_VANS_SMOOTH, slope = L + A, G = y * L - 1.0;
    const double step = 2.0 * y * G * slope / (2.0 * y * slope * slope - G * A);
    if (!(slope > 0.0 && step < y)) {
      y = fmax(1.0 / Re, 1.0 / SD_VANS_SMOOTH);
      continue;
    }
    y -= step;
    if (fabs(step) <= 3e-5 * y) break;
  }
  return y;
}

/* About the root, L = 1/y has the series of  L = A ln(Re (1 + s)/L) + 0.32. */
static void series_of_law(double L0, sd_vans_friction *near)
{
  const double A = 2.0 / 2.302585092994046;
  double L[ORDER] = {L0}, q[ORDER] = {0};
  for (int n = 1; n < ORDER; n++) {
    const double lower = sd_vans_lower_terms(n, q, L);
    L[n] = A * (sd_vans_log_series[n] * L0 + lower) / (L0 + A);
    q[n] = (L[n] - lower) / L0;
  }
  near->reach = 1e-3;
  sd_vans_inverse_square(L, q, near);
}

/* f = 24/Re, between parallel walls: 24/Re (1 - s + s^2 - s^3), the next term below 1e-13. */
static void laminar(double Re, sd_vans_friction *near)
{
  near->f[0] = 24.0 / Re;
  for (int n = 1; n < ORDER; n++) near->f[n] = -near->f[n - 1];
  near->reach = 5e-4;
}

/* r = 1/sqrt(f):  g(r) = r + 2 log10(k + B r/Re) = 0, rising and concave, so that Newton's steps
 * from the left of the root stay there. Laminar below Re 100, whatever the roughness. */
static void rough(double Re, sd_vans_friction *near)
{
  const double A = 2.0 / 2.302585092994046, k = near->roughness / 14.8,
               B = pow(10.0, -0.5 * SD_VANS_SMOOTH) / Re;
  double r = 1e-3;
  for (int n = 0; n < 60 && Re >= 100.0; n++) {
    const double inside = k + B * r, step = (r + A * log(inside)) / (1.0 + A * B / inside);
    r = fmax(r - step, 1e-3);
    if (fabs(step) <= 1e-14 * r) break;
  }
  laminar(Re, near);
  near->reach = 0.0;
  if (Re >= 100.0) near->f[0] = fmax(near->f[0], 1.0 / (r * r));
}

double sd_vans_wall_friction_anew(sd_vans_rules rules, double Re, sd_vans_friction *near)
{
  if (!(Re > SD_VANS_LEAST_RE)) Re = SD_VANS_LEAST_RE;
  near->inverse = 1.0 / Re;
  if (rules == SD_VANS_YADE)
    sd_vans_yade_friction(Re, near);
  else if (near->roughness > 0.0)
    rough(Re, near);
  else if (Re < SD_VANS_WALL_TRANSITION)
    laminar(Re, near);
  else
    series_of_law(1.0 / root_of_law(Re, sqrt(near->f[0])), near);
  /* no series crosses the transition */
  if (rules != SD_VANS_YADE)
    near->reach = fmin(near->reach, fabs(SD_VANS_WALL_TRANSITION / Re - 1.0));
  return near->f[0];
}
