#include "sd_window.h"

#include <math.h>
#include <string.h>

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

/* long double: a second derivative multiplies the rounding of the highest terms by the fourth power
 * of the degree. */
void sd_window_fit(int points, double beta, double tolerance, sd_window *w)
{
  enum { NODES = SD_WINDOW_TERMS + 8 };
  const long double unit = 1.0L / bessel_i0(beta), pi = acosl(-1.0L);
  long double node[NODES], series[SD_EWALD_MOST_POINTS][NODES];
  memset(w, 0, sizeof(*w));
  w->points = points;
  for (int s = 0; s < NODES; s++) node[s] = cosl(pi * (s + 0.5L) / NODES);
  for (int k = 0; k < points; k++) {
    long double sample[NODES];
    for (int s = 0; s < NODES; s++) sample[s] = unit * window_at(points, beta, k, node[s]);
    for (int m = 0; m < NODES; m++) {
      long double sum = 0.0L;
      for (int s = 0; s < NODES; s++) sum += sample[s] * cosl(pi * m * (s + 0.5L) / NODES);
      series[k][m] = sum * (m == 0 ? 1.0L : 2.0L) / NODES;
      if (m < SD_WINDOW_TERMS && m > w->degree && fabsl(series[k][m]) > 1e-4L * tolerance)
        w->degree = m;
    }
  }
  /* Chebyshev's T_m in powers of v */
  long double before[SD_WINDOW_TERMS] = {0.0L}, now[SD_WINDOW_TERMS] = {1.0L};
  long double power[SD_WINDOW_TERMS][SD_EWALD_MOST_POINTS] = {{0.0L}};
  for (int m = 0; m <= w->degree; m++) {
    for (int p = 0; p <= m; p++)
      for (int k = 0; k < points; k++) power[p][k] += series[k][m] * now[p];
    long double next[SD_WINDOW_TERMS] = {0.0L};
    for (int p = 0; p < SD_WINDOW_TERMS - 1; p++) next[p + 1] = (m == 0 ? 1.0L : 2.0L) * now[p];
    for (int p = 0; p < SD_WINDOW_TERMS; p++) next[p] -= before[p];
    memcpy(before, now, sizeof(now));
    memcpy(now, next, sizeof(next));
  }
  for (int m = 0; m <= w->degree; m++)
    for (int k = 0; k < points; k++) w->coefficient[m][k] = (double) power[m][k];
}

/* P sinh(root)/(I_0(beta) root), root^2 = beta^2 - (theta P/2)^2 */
double sd_window_transform(int points, double beta, double theta)
{
  const double half = 0.5 * theta * points, square = beta * beta - half * half;
  const double root = sqrt(fabs(square)), unit = points / (double) bessel_i0(beta);
  if (root < 1e-6) return unit;
  return unit * (square > 0.0 ? sinh(root) : sin(root)) / root;
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
