#include "sd_radial.h"

#include <math.h>
#include <string.h>

#include "sd_constants.h"

static double screen(double xi, double a_ref, double k2)
{
  const double x = k2 / (4.0 * xi * xi);
  return (1.0 + x - a_ref * a_ref * k2 / 3.0) * exp(-x);
}

double sd_ewald_screen(const sd_ewald *e, double k2)
{
  return screen(e->xi, e->a_ref, k2);
}

/* H grows with xi as long as xi a_ref < sqrt(3)/2, so the difference is never negative. */
double sd_ewald_wave_screen(const sd_ewald *e, double k2)
{
  const double H = screen(e->xi, e->a_ref, k2);
  return e->large.from > 0.0 ? H - screen(e->large.xi, e->a_ref, k2) : H;
}

double sd_ewald_b(const sd_ewald *e, double a)
{
  return (a - e->a_ref) * (a + e->a_ref) / 6.0;
}

/* j_l(x)/x^l for l = 0, 1, 2. Below 1.5 the closed forms cancel; the series
 *   sum_k (-x^2/2)^k / (k! (2l + 2k + 1)!!)
 * then needs a dozen terms. */
static void bessel(double x, double *j)
{
  if (x < 1.5) {
    for (int l = 0; l < 3; l++) {
      double term = l == 0 ? 1.0 : l == 1 ? 1.0 / 3.0 : 1.0 / 15.0, sum = term;
      for (int k = 1; k < 16; k++) {
        term *= -0.5 * x * x / (k * (2.0 * l + 2.0 * k + 1.0));
        sum += term;
      }
      j[l] = sum;
    }
    return;
  }
  j[0] = sin(x) / x;
  j[1] = (j[0] - cos(x)) / (x * x);
  j[2] = (3.0 * j[1] - j[0]) / (x * x);
}

/* The integrands are smooth, even in k and fall like exp(-k^2/4 xi^2): equal steps (trapezoidal
 * rule) converge faster than any power. With the step dk the functions repeat with period 2 pi/dk
 * in r, so dk keeps the next copy, screened beyond 6.8/xi, away from r. The largest k makes
 * exp(-x) = 1e-20. */
void sd_radial(const sd_ewald *e, double r, double *value)
{
  const double most = 2.0 * e->xi * sqrt(46.0);
  const int steps = (int) ceil(most * (r + 8.0 / e->xi) / SD_PI);
  const double dk = most / steps;
  for (int f = 0; f < SD_RADIALS; f++) value[f] = 0.0;
  for (int s = 0; s <= steps; s++) {
    const double k = s * dk, k2 = k * k, weight = (s == 0 ? 0.5 : 1.0) * dk / (2.0 * SD_PI * SD_PI);
    const double H = weight * sd_ewald_screen(e, k2);
    double j[3];
    bessel(k * r, j);
    const double across = H * (j[0] - j[1]), along = H * k2 * j[2], turn = 0.5 * H * k2 * j[1];
    value[SD_I0] += across;
    value[SD_I1] += across * k2;
    value[SD_I2] += across * k2 * k2;
    value[SD_J0] += along;
    value[SD_J1] += along * k2;
    value[SD_J2] += along * k2 * k2;
    value[SD_K0] += turn;
    value[SD_K1] += turn * k2;
  }
}

/* From Chebyshev series to powers: T_0 = 1, T_1 = t, T_k = 2 t T_k-1 - T_k-2. */
static void powers(const double *series, int degree, double *coefficient)
{
  double before[SD_RADIAL_TERMS] = {1.0}, now[SD_RADIAL_TERMS] = {0.0, 1.0};
  memset(coefficient, 0, sizeof(double) * SD_RADIAL_TERMS);
  for (int k = 0; k <= degree; k++) {
    const double *T = k == 0 ? before : now;
    for (int m = 0; m <= k; m++) coefficient[m] += series[k] * T[m];
    if (k == 0) continue;
    double next[SD_RADIAL_TERMS] = {0.0};
    for (int m = 0; m <= k && m + 1 < SD_RADIAL_TERMS; m++) next[m + 1] = 2.0 * now[m];
    for (int m = 0; m < k; m++) next[m] -= before[m];
    memcpy(before, now, sizeof(now));
    memcpy(now, next, sizeof(next));
  }
}

/* What the functions are multiplied with in a product: powers of the largest b (of the radius with
 * torques), and the lengths that J and K have lost. 0: not in it. */
static void weights(const sd_ewald *e, int width, double *weight)
{
  const double R = e->range, b = fmax(fabs(sd_ewald_b(e, e->largest)), e->a_ref * e->a_ref / 6.0);
  const int equal = e->largest == e->a_ref, turns = width == 6;
  const double a = turns ? e->largest : 0.0;
  for (int l = 0; l < 2; l++) {
    const double length = l == 0 ? 1.0 : R * R;
    weight[SD_I0 + l] = length;
    weight[SD_I1 + l] = length * fmax(equal ? 0.0 : 2.0 * b, 0.25 * a * a);
    weight[SD_I2 + l] = equal ? 0.0 : length * b * b;
  }
  weight[SD_K0] = a * R;
  weight[SD_K1] = equal ? 0.0 : a * R * b;
}

int sd_radial_fit(const sd_ewald *e, int width, double *coefficient)
{
  enum { NODES = 64 };
  double sample[NODES][SD_RADIALS], series[SD_RADIALS][NODES], weight[SD_RADIALS], bare[SD_RADIALS];
  weights(e, width, weight);
  sd_radial(e, 0.0, bare);
  for (int s = 0; s < NODES; s++)
    sd_radial(e, e->range * sqrt(0.5 * (1.0 + cos(SD_PI * (s + 0.5) / NODES))), sample[s]);
  int degree = 1;
  for (int f = 0; f < SD_RADIALS; f++) {
    for (int k = 0; k < NODES; k++) {
      double sum = 0.0;
      for (int s = 0; s < NODES; s++) sum += sample[s][f] * cos(SD_PI * k * (s + 0.5) / NODES);
      series[f][k] = sum * (k == 0 ? 1.0 : 2.0) / NODES;
    }
    double rest = 0.0;
    int k = NODES - 1;
    for (; k > degree; k--) {
      rest += weight[f] * fabs(series[f][k]);
      if (rest > 0.1 * e->tolerance * bare[SD_I0]) break;
    }
    if (k > degree) degree = k;
  }
  if (degree > SD_RADIAL_TERMS - 1) degree = SD_RADIAL_TERMS - 1;
  for (int f = 0; f < SD_RADIALS; f++)
    powers(series[f], degree, coefficient + f * SD_RADIAL_TERMS);
  return degree;
}

/* I_n + J_n/3 = 1/(3 pi^2) int k^2n H j_0 dk, in closed form with q = xi^2 r^2, E = exp(-q),
 * z = xi^3 E/pi^1.5, c = a_ref^2/3:
 *   n = 0   1/(6 pi) [ erf(xi r)/r + xi E/sqrt(pi) - 4 c xi^3 E/sqrt(pi) ]
 *   n = 1   z/3 [ 5 - 2q ] - c xi^2 z (4 - 8q/3)
 *   n = 2   xi^2 z (14 - 16q + 8q^2/3) - c xi^4 z (40 - 160q/3 + 32q^2/3)
 * and the pair's tensor has 1/(6 pi r), whatever the radii. Integrated over 4 pi r^2 from the range
 * on, by Simpson's rule: there is nothing beyond 8/xi more. */
static void remainder_at(const sd_ewald *e, double r, double *f)
{
  const double xi = e->xi, q = xi * xi * r * r, E = exp(-q), c = e->a_ref * e->a_ref / 3.0;
  const double root = sqrt(SD_PI), z = xi * xi * xi * E / (SD_PI * root);
  f[0] = (erfc(xi * r) / r - xi * E / root * (1.0 - 4.0 * c * xi * xi)) / (6.0 * SD_PI);
  f[1] = -(z / 3.0 * (5.0 - 2.0 * q) - c * xi * xi * z * (4.0 - 8.0 * q / 3.0));
  f[2] = -xi * xi * z *
         (14.0 - 16.0 * q + 8.0 * q * q / 3.0 -
          c * xi * xi * (40.0 - 160.0 * q / 3.0 + 32.0 * q * q / 3.0));
}

void sd_radial_tail(const sd_ewald *e, double *tail)
{
  enum { STEPS = 400 };
  const double dr = 8.0 / e->xi / STEPS;
  for (int n = 0; n < 3; n++) tail[n] = 0.0;
  for (int s = 0; s <= STEPS; s++) {
    const double r = e->range + s * dr;
    const double weight = (s == 0 || s == STEPS ? 1.0 : s % 2 ? 4.0 : 2.0) * dr / 3.0;
    double f[3];
    remainder_at(e, r, f);
    for (int n = 0; n < 3; n++) tail[n] += weight * 4.0 * SD_PI * r * r * f[n];
  }
}
