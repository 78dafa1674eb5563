#include "sd_image_wave.h"

#include <math.h>
#include <string.h>

#include "sd_chebyshev.h"
#include "sd_constants.h"

double sd_image_exponent(const sd_ewald_images *images, double k2)
{
  if (!(images->band > 0.0)) return k2 / (4.0 * images->xi * images->xi);
  const double left = images->band * images->band - k2;
  return left > 0.0 ? images->range * k2 / (images->band + sqrt(left)) : INFINITY;
}

/* --- radial functions --- */

/* Waves in the middles of equal steps: the sum converges faster than any power (sd_radial.c). */
enum { WAVES = 256, ORDERS = 5 };

/* j_n(x)/x^n. Below 4 the recurrence cancels; the series sum_k (-x^2/2)^k/(k! (2n + 2k + 1)!!) loses
 * less than a digit there. */
static void iw_bessel(double x, double *j)
{
  const double x2 = x * x;
  if (x < 4.0) {
    double first = 1.0;
    for (int n = 0; n < ORDERS; n++) {
      first /= 2.0 * n + 1.0;
      double term = first;
      j[n] = term;
      for (int k = 1; k < 30; k++) {
        term *= -0.5 * x2 / (k * (2.0 * n + 2.0 * k + 1.0));
        j[n] += term;
      }
    }
    return;
  }
  j[0] = sin(x) / x;
  j[1] = (j[0] - cos(x)) / x2;
  for (int n = 1; n + 1 < ORDERS; n++) j[n + 1] = ((2.0 * n + 1.0) * j[n] - j[n - 1]) / x2;
}

/* lap^s of G = I 1 + J R R and of (1/R d/dR)^n L, s = 0, 1, 2 */
typedef struct {
  double I[3], J[3], L[3][ORDERS];
} iw_filtered;

/* L = 2/pi int exp(-x) j_0 dk, each lap is -k^2, each 1/R d/dR makes -k^2 j_n+1/(kR)^n+1 of j_n/(kR)^n; and
 * I = 4/pi int H (j_0 - j_1/(kR)) dk, J R^2 = 4/pi int H j_2 dk. */
static iw_filtered filtered_at(const sd_ewald *e, double r)
{
  const sd_ewald_images *im = &e->images;
  const double end = im->band > 0.0 ? im->band : 2.0 * sqrt(60.0) * im->xi, step = end / WAVES;
  iw_filtered f;
  memset(&f, 0, sizeof(f));
  for (int m = 0; m < WAVES; m++) {
    const double k = (m + 0.5) * step, k2 = k * k, x = sd_image_exponent(im, k2);
    const double of_L = 2.0 / SD_PI * step * exp(-x);
    const double of_G = 2.0 * of_L * (1.0 + x - e->a_ref * e->a_ref * k2 / 3.0);
    double j[ORDERS], power = 1.0;
    iw_bessel(k * r, j);
    for (int s = 0; s < 3; s++, power *= -k2) {
      f.I[s] += of_G * power * (j[0] - j[1]);
      f.J[s] += of_G * power * k2 * j[2];
      double turn = power;
      for (int n = 0; n < ORDERS; n++, turn *= -k2) f.L[s][n] += of_L * turn * j[n];
    }
  }
  return f;
}

/* (1) with the ends of both spheres, sorted by f, R and z, by heights and by b: with L_s[n] of lap^s L,
 * r = a_ref^2/6,
 *   T[n] = derivatives that come with heights, of one end: 4 (r, 1/2 + r lap, lap + r lap lap) L[n]
 *   Q[n] = of both ends: 8 (r^2, r + r^2 lap, 1 + 2 r lap + r^2 lap lap) L[n] */
void sd_image_wave(const sd_ewald *e, double distance, double (*P)[3])
{
  const iw_filtered f = filtered_at(e, distance);
  const double r = e->a_ref * e->a_ref / 6.0;
  double T[ORDERS][3], Q[ORDERS][3];
  for (int n = 2; n < ORDERS; n++) {
    const double L = f.L[0][n], L1 = f.L[1][n], L2 = f.L[2][n];
    const double one[3] = {r * L, 0.5 * L + r * L1, L1 + r * L2};
    const double both[3] = {r * r * L, r * L + r * r * L1, L + 2.0 * r * L1 + r * r * L2};
    for (int s = 0; s < 3; s++) {
      T[n][s] = 4.0 * one[s];
      Q[n][s] = 8.0 * both[s];
    }
  }
  for (int s = 0; s < 3; s++) {
    P[0][s] = Q[2][s] - f.I[s];
    P[1][s] = 2.0 * f.L[s][1];
    P[2][s] = T[2][s] + Q[3][s];
    P[3][s] = 2.0 * (f.I[s] + Q[2][s]);
    P[4][s] = Q[3][s] - f.J[s];
    P[5][s] = 2.0 * f.L[s][2];
    P[6][s] = T[3][s] + Q[4][s];
    P[7][s] = f.J[s] + T[2][s] + 2.0 * Q[3][s];
    P[8][s] = s ? 0.0 : f.L[0][2];
    P[9][s] = s ? 0.0 : f.L[0][3];
  }
}

/* --- polynomials --- */

/* What the functions are multiplied with in a product at most: gh <= z^2/4, and lengths up to the range */
static void iw_weights(const sd_ewald *e, double (*weight)[3])
{
  static const double of[SD_IMAGE_FUNCTIONS] = {1.0, 0.25, 1.0, 1.0, 1.0, 0.25, 1.0, 1.0, 2.0, 2.0};
  static const int power[SD_IMAGE_FUNCTIONS] = {0, 1, 1, 0, 1, 2, 2, 1, 1, 2};
  const double range2 = e->images.range * e->images.range;
  const double b = fmax(fabs(sd_ewald_b(e, e->largest)), e->a_ref * e->a_ref / 6.0);
  const int alike = e->largest == e->a_ref;
  for (int f = 0; f < SD_IMAGE_FUNCTIONS; f++) {
    const double unit = of[f] * pow(range2, power[f]);
    weight[f][0] = f < SD_IMAGE_SYMMETRIC ? unit : alike ? 0.0 : unit * e->largest * e->largest / 6.0;
    weight[f][1] = f < SD_IMAGE_SYMMETRIC && !alike ? 2.0 * b * unit : 0.0;
    weight[f][2] = f < SD_IMAGE_SYMMETRIC && !alike ? b * b * unit : 0.0;
  }
}

int sd_image_fit(const sd_ewald *e, double (*coefficient)[3][SD_RADIAL_TERMS])
{
  enum { NODES = SD_CHEBYSHEV_MOST, ALL = 3 * SD_IMAGE_FUNCTIONS };
  long double sample[SD_IMAGE_FUNCTIONS][3][NODES], series[ALL][NODES];
  double weight[SD_IMAGE_FUNCTIONS][3], P[SD_IMAGE_FUNCTIONS][3];
  for (int s = 0; s < NODES; s++) {
    const double t = (double) sd_chebyshev_node(s, NODES);
    sd_image_wave(e, e->images.range * sqrt(0.5 * (1.0 + t)), P);
    for (int f = 0; f < ALL; f++) sample[f / 3][f % 3][s] = P[f / 3][f % 3];
  }
  iw_weights(e, weight);
  const double unit = filtered_at(e, 0.0).I[0];
  int degree = 1;
  for (int f = 0; f < ALL; f++) {
    sd_chebyshev_series(sample[f / 3][f % 3], NODES, series[f]);
    double rest = 0.0;
    int k = NODES - 1;
    for (; k > degree; k--) {
      rest += weight[f / 3][f % 3] * fabs((double) series[f][k]);
      if (rest > 0.1 * e->tolerance * unit) break;
    }
    degree = k;
  }
  if (degree > SD_RADIAL_TERMS - 1) degree = SD_RADIAL_TERMS - 1;
  memset(coefficient, 0, SD_IMAGE_FUNCTIONS * sizeof(*coefficient));
  for (int f = 0; f < ALL; f++)
    sd_chebyshev_powers(series[f], degree, coefficient[f / 3][f % 3]);
  return degree;
}
