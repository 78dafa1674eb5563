#include "sd_window.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_chebyshev.h"
#include "sd_constants.h"

/* I_0, the modified Bessel function, by its power series: all terms are positive. */
static long double bessel_i0(long double x)
{
  long double sum = 1.0L, term = 1.0L;
  for (int k = 1; k < 500 && term > 1e-21L * sum; k++) {
    term *= x * x / (4.0L * k * k);
    sum += term;
  }
  return sum;
}

/* phi at point k of the sphere with v */
static long double window_at(int points, double beta, int k, long double v)
{
  const long double tau = 2.0L * (k + 1 - 0.5L * (v + 1.0L)) / points - 1.0L;
  return bessel_i0(beta * sqrtl(fmaxl(0.0L, 1.0L - tau * tau)));
}

/* What the points of a sphere with v add up to, over their mean: nearly 1, and divided out */
static long double unevenness(int points, double beta, long double v)
{
  long double sum = 0.0L;
  for (int k = 0; k < points; k++) sum += window_at(points, beta, k, v);
  return sum / (bessel_i0(beta) * sd_window_transform(points, beta, 0.0));
}

/* Up to the highest degree that any point needs: beyond it all are below a part of the tolerance, which
 * second derivatives leave small. */
void sd_window_fit(int points, double beta, double tolerance, sd_window *w)
{
  enum { NODES = SD_WINDOW_TERMS + 8 };
  long double series[SD_WINDOW_MOST_POINTS][NODES], unit[NODES];
  memset(w, 0, sizeof(*w));
  w->points = points;
  for (int s = 0; s < NODES; s++)
    unit[s] = 1.0L / (bessel_i0(beta) * unevenness(points, beta, sd_chebyshev_node(s, NODES)));
  for (int k = 0; k < points; k++) {
    long double sample[NODES];
    for (int s = 0; s < NODES; s++) sample[s] = unit[s] * window_at(points, beta, k, sd_chebyshev_node(s, NODES));
    sd_chebyshev_series(sample, NODES, series[k]);
    for (int m = w->degree + 1; m < SD_WINDOW_TERMS; m++)
      if (fabsl(series[k][m]) > 1e-4L * tolerance) w->degree = m;
  }
  for (int k = 0; k < points; k++) {
    double power[SD_WINDOW_TERMS];
    sd_chebyshev_powers(series[k], w->degree, power);
    for (int m = 0; m <= w->degree; m++) w->coefficient[m][k] = power[m];
  }
}

/* P sinh(root)/(I_0(beta) root), root^2 = beta^2 - (theta P/2)^2 */
double sd_window_transform(int points, double beta, double theta)
{
  const double half = 0.5 * theta * points, square = beta * beta - half * half;
  const double root = sqrt(fabs(square)), unit = points / (double) bessel_i0(beta);
  if (root < 1e-6) return unit;
  return unit * (square > 0.0 ? sinh(root) : sin(root)) / root;
}

double *sd_window_inverse(int points, double beta, int n)
{
  double *inverse = malloc(sizeof(double) * (size_t) n);
  for (int m = 0; m < n && inverse; m++)
    inverse[m] = m == n - 1 ? 0.0 : 1.0 / sd_window_transform(points, beta, SD_PI * m / (n - 1));
  return inverse;
}

/* root < 0.1: (coth(root) - 1/root)/root by its series */
double sd_window_slope(int points, double beta, double theta)
{
  const double half = 0.5 * points, square = beta * beta - half * half * theta * theta;
  const double root = sqrt(fabs(square));
  const double factor = root < 0.1 ? 1.0 / 3.0 - square / 45.0
      : square > 0.0               ? (1.0 / tanh(root) - 1.0 / root) / root
                                   : (1.0 / root - 1.0 / tan(root)) / root;
  return -half * half * theta * factor;
}
