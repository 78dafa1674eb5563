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

/* Of phi over all distances s: the mean of s^2 */
static long double mean_square(int points, double beta)
{
  const double theta = 1e-6;
  return -sd_window_slope(points, beta, theta) / theta;
}

/* phi at all points of the sphere with v, times a constant or a parabola in s, the distance to the point, nearly 1: the
 * sums of phi, or of phi, phi s and phi s^2, are the integrals of these then.
 * With p and q, s and s^2 less what is not orthogonal, it has the parts 1, p and q that these sums give; the bend has
 * s^2 less its mean, so that the sum of phi stays. */
static void even_window(int points, double beta, int order, double bend, long double v, long double *phi)
{
  const long double whole = sd_window_transform(points, beta, 0.0), first = 0.5L * (1.0L - v - points);
  long double sum[5] = {0.0L};
  for (int k = 0; k < points; k++) {
    phi[k] = window_at(points, beta, k, v);
    for (int m = 0; m < 5; m++) sum[m] += phi[k] * powl(first + k, m);
  }
  const long double a = sum[1] / sum[0], p2 = sum[2] - a * sum[1];
  const long double b = (sum[3] - 2.0L * a * sum[2] + a * a * sum[1]) / p2, g = p2 / sum[0];
  const long double c1 = -(a + b), c0 = a * b - g;
  const long double q2 = sum[4] + c1 * sum[3] + c0 * sum[2];
  const long double bent = bend * cosl(2.0L * SD_PI * first) * whole / sum[0];
  const long double of_p = -a * whole / p2, of_q = (mean_square(points, beta) + c0) * whole / q2;
  for (int k = 0; k < points; k++) {
    const long double s = first + k;
    phi[k] *= whole / sum[0] + (order == 0 ? 0.0L : of_p * (s - a) + of_q * (s * s + c1 * s + c0)) +
        bent * (s * s - sum[2] / sum[0]);
  }
}

/* Up to the highest degree that any point needs: beyond it all are below a part of the tolerance, which
 * second derivatives leave small. */
void sd_window_fit(int points, double beta, int order, double bend, double tolerance, sd_window *w)
{
  enum { NODES = SD_WINDOW_TERMS + 8 };
  long double phi[NODES][SD_WINDOW_MOST_POINTS], series[SD_WINDOW_MOST_POINTS][NODES];
  memset(w, 0, sizeof(*w));
  w->points = points;
  for (int s = 0; s < NODES; s++) even_window(points, beta, order, bend, sd_chebyshev_node(s, NODES), phi[s]);
  for (int k = 0; k < points; k++) {
    long double sample[NODES];
    for (int s = 0; s < NODES; s++) sample[s] = phi[s][k];
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
