#include "sd_vans.h"

#include <math.h>
#include <string.h>

enum { ORDER = SD_VANS_FRICTION_TERMS };

static const double SMOOTH = 0.32; /* of the laws of smooth walls */

/* ln(1 + s) */
static const double LOG[ORDER] = {0.0, 1.0, -1.0 / 2.0, 1.0 / 3.0};

/* What the terms below n add to n q_n r_0 = n r_n - sum k q_k r_(n-k), the series q = ln r. */
static double lower_terms(int n, const double *q, const double *r)
{
  double sum = 0.0;
  for (int k = 1; k < n; k++) sum += k * q[k] * r[n - k];
  return sum / n;
}

/* The series of r^-2 from those of r and q = ln r:  n f_n = -2 sum k q_k f_(n-k). It reaches as far
 * as the next term is below 1e-14 f_0, about (K s)^4 with K from f_2 = K^2 f_0 or f_3 = K^3 f_0. */
static void inverse_square(const double *r, const double *q, sd_vans_friction *near)
{
  double *f = near->f;
  f[0] = 1.0 / (r[0] * r[0]);
  for (int n = 1; n < ORDER; n++) {
    f[n] = 0.0;
    for (int k = 1; k <= n; k++) f[n] -= 2.0 * k / n * q[k] * f[n - k];
  }
  const double K = fmax(sqrt(fabs(f[2]) / f[0]), cbrt(fabs(f[3]) / f[0]));
  near->reach = fmin(near->reach, 3e-4 / K);
}

/* With y = sqrt(f) and L(y) = A ln(Re y) + 0.32, A = 2/ln 10, the law is G = y L - 1 = 0, with the
 * slope G' = L + A and G'' = A/y > 0. Halley's step, 2 G G'/(2 G'^2 - G G''), has the one logarithm
 * and the one division of Newton's, and from near by a step of relative size s leaves an error
 * below s^3. From the right of the solution the steps go left to it; max(1/Re, 1/0.32) lies there,
 * for it has L >= 0.32 and y L >= 1. Where L + A <= 0 no step leads to it. */
static double root_of_law(double Re, double y)
{
  const double A = 2.0 / 2.302585092994046;
  for (int k = 0; k < 50; k++) {
    const double L = A * log(Re * y) + SMOOTH, slope = L + A, G = y * L - 1.0;
    const double step = 2.0 * y * G * slope / (2.0 * y * slope * slope - G * A);
    if (!(slope > 0.0 && step < y)) {
      y = fmax(1.0 / Re, 1.0 / SMOOTH);
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
    const double lower = lower_terms(n, q, L);
    L[n] = A * (LOG[n] * L0 + lower) / (L0 + A);
    q[n] = (L[n] - lower) / L0;
  }
  near->reach = 1e-3;
  inverse_square(L, q, near);
}

/* How far in s a step of the substitution, by which ln f of slope `before` becomes one of `slope`,
 * surely ends as it does here: with |change| on this side of 1 %, a factor of 2 to spare. */
static double reach_of_end(double change, double slope, double before)
{
  return 0.5 * fabs(fabs(change) - 1e-2) / fabs((1.0 + change) * (slope - before));
}

/* r_(m+1) = 2 ln(Re sqrt(f_m)) + 0.32, f_m = 1/r_m^2, in the arithmetic of the original step by
 * step: for Re of 0.6 to 5 the substitution wanders, and another rounding may be another answer.
 * The series holds as far as every step ends as it does at Re, and nowhere where r is near 0. */
static void substitution(double Re, sd_vans_friction *near)
{
  double f = 1.0 / (SMOOTH * SMOOTH), r[ORDER] = {SMOOTH}, q[ORDER] = {0};
  near->reach = 1e-3;
  for (int m = 1; m <= 100; m++) {
    const double before = q[1];
    r[0] = 2.0 * log(Re * sqrt(f)) + SMOOTH;
    const double next = 1.0 / (r[0] * r[0]), change = (next - f) / f;
    for (int n = 1; n < ORDER; n++) r[n] = 2.0 * (LOG[n] - q[n]);
    for (int n = 1; n < ORDER; n++) q[n] = (r[n] - lower_terms(n, q, r)) / r[0];
    near->reach = fmin(near->reach, reach_of_end(change, -2.0 * q[1], -2.0 * before));
    if (fabs(r[0]) < 0.5) near->reach = 0.0;
    f = next;
    if (fabs(change) >= 1e-2) continue;
    inverse_square(r, q, near);
    near->f[0] = f;
    return;
  }
  memset(near->f, 0, sizeof near->f);
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
               B = pow(10.0, -0.5 * SMOOTH) / Re;
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
    substitution(Re, near);
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
