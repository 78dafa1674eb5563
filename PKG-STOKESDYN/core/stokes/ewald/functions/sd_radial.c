#include "sd_radial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_chebyshev.h"
#include "sd_constants.h"

static double screen(double xi, double a_ref, double k2)
{
  const double x = k2 / (4.0 * xi * xi);
  return (1.0 + x - a_ref * a_ref * k2 / 3.0) * exp(-x);
}

/* H = 1 - this k^2 + ... */
static double bend_of_band(const sd_ewald *e)
{
  return (e->sized ? 2.0 : 1.0) * e->a_ref * e->a_ref / 6.0;
}

/* x without the difference of large numbers */
static double screen_of_band(const sd_ewald *e, double k2)
{
  const double left = e->band * e->band - k2;
  if (!(left > 0.0)) return 0.0;
  const double x = k2 * e->band / (2.0 * e->xi * e->xi) / (e->band + sqrt(left));
  return (1.0 + x - bend_of_band(e) * k2) * exp(-x);
}

/* H grows with xi as long as xi a_ref < sqrt(3)/2, so the difference is never negative. */
double sd_ewald_wave_screen(const sd_ewald *e, double k2)
{
  if (e->band > 0.0) return screen_of_band(e, k2);
  const double H = screen(e->xi, e->a_ref, k2);
  return e->taken > 0.0 ? H - screen(e->taken, e->a_ref, k2) : H;
}

/* Laplacian: lap f = 3 f[1] + R^2 f[2], and (1/R d/dR)^n (R^2 g) = R^2 g[n] + 2n g[n - 1] */
static void laplacian(double R2, const double *f, int terms, double *lap)
{
  for (int n = 0; n < terms; n++) lap[n] = (3.0 + 2.0 * n) * f[n + 1] + R2 * f[n + 2];
}

/* erf(xi R)/R, the first `terms`. With E = 2 xi/sqrt(pi) exp(-q), q = (xi R)^2,
 *   R^2 L[n + 1] = (-2 xi^2)^n E - (2n + 1) L[n],
 * which cancels where q is small. There downwards, from the series of the last,
 *   L[n] = (-2 xi^2)^n E sum_k (2q)^k/((2n + 1) (2n + 3) ... (2n + 2k + 1)) */
static void filtered_inverse(double xi, double R2, int terms, double *L)
{
  const double q = xi * xi * R2, root = sqrt(R2), step = -2.0 * xi * xi;
  double unit = q > 42.0 ? 0.0 : 2.0 * xi / sqrt(SD_PI) * exp(-q);
  if (q > 2.5) {
    L[0] = (q > 42.0 ? 1.0 : erf(xi * root)) / root;
    for (int n = 0; n + 1 < terms; n++, unit *= step)
      L[n + 1] = (unit - (2.0 * n + 1.0) * L[n]) / R2;
    return;
  }
  const int last = terms - 1;
  double term = 1.0 / (2.0 * last + 1.0), sum = term;
  for (int k = 1; k < 200 && term > 1e-17 * sum; k++) {
    term *= 2.0 * q / (2.0 * (last + k) + 1.0);
    sum += term;
  }
  for (int n = 0; n < last; n++) unit *= step;
  L[last] = unit * sum;
  for (int n = last - 1; n >= 0; n--) {
    unit /= step;
    L[n] = (unit - R2 * L[n + 1]) / (2.0 * n + 1.0);
  }
}

/* Its Laplacian, -4 pi times a Gaussian */
static void filtered_delta(double xi, double R2, int terms, double *g)
{
  const double q = xi * xi * R2;
  g[0] = q > 42.0 ? 0.0 : -4.0 * xi * xi * xi / sqrt(SD_PI) * exp(-q);
  for (int n = 1; n < terms; n++) g[n] = -2.0 * xi * xi * g[n - 1];
}

sd_filtered sd_filtered_at(const sd_filter *filter, double R2, int terms, int laplacians)
{
  sd_filtered f = {.filter = *filter, .R2 = R2};
  filtered_inverse(filter->xi, R2, terms, f.L[0]);
  filtered_delta(filter->xi, R2, laplacians ? SD_FILTERED_TERMS : 1, f.L[1]);
  if (laplacians) {
    laplacian(R2, f.L[1], 5, f.L[2]);
    laplacian(R2, f.L[2], 3, f.L[3]);
  }
  return f;
}

/* The biharmonic function whose gradient is R L has H = (1 + x) exp(-x), and the Laplacian 2 L_H,
 * L_H = L - lap L/(4 xi^2): G = (2 L + R^2 L[1]) 1 - L[1] R R. From then on, and for the part of
 * a_ref, lap (2 L 1 - ...) = 2 (lap L 1 - grad grad L). */
void sd_filtered_stokeslet(const sd_filtered *f, int s, double *I, double *J)
{
  const double x = 0.25 / (f->filter.xi * f->filter.xi);
  const double ref = f->filter.a_ref * f->filter.a_ref / 3.0;
  const double *here = f->L[s], *above = f->L[s + 1];
  if (s == 0) {
    *I = 2.0 * here[0] + f->R2 * here[1];
    *J = -here[1];
  } else {
    const double *below = f->L[s - 1];
    *I = 2.0 * (here[0] - x * above[0] - below[1] + x * here[1]);
    *J = -2.0 * (below[2] - x * here[2]);
  }
  *I += 2.0 * ref * (above[0] - here[1]);
  *J -= 2.0 * ref * here[2];
}

/* --- waves that end at a band --- */

/* j_l(x)/x^l for l = 0, 1, 2. Below 1.5 the closed forms cancel; the series
 *   sum_k (-x^2/2)^k / (k! (2l + 2k + 1)!!)
 * then needs a dozen terms. */
static void bessel(double x, double *j)
{
  if (x < 1.5) {
    for (int l = 0; l < 3; l++) {
      double term = l == 0 ? 1.0 : l == 1 ? 1.0 / 3.0 : 1.0 / 15.0;
      j[l] = term;
      for (int k = 1; k < 16; k++) {
        term *= -0.5 * x * x / (k * (2.0 * l + 2.0 * k + 1.0));
        j[l] += term;
      }
    }
    return;
  }
  j[0] = sin(x) / x;
  j[1] = (j[0] - cos(x)) / (x * x);
  j[2] = (3.0 * j[1] - j[0]) / (x * x);
}

/* Waves in the middles of equal steps. H is even and smooth, so that the sum converges faster than any
 * power, but for its end, where it is about exp(-K R) and falls to 0. So many at least: with the step dk
 * functions of r repeat with the period 2 pi/dk, which is kept some ranges beyond r. */
enum { WAVES = 256 };

static double wave_of_band(const sd_ewald *e, int s, int waves)
{
  return (s + 0.5) * e->band / waves;
}

static void radial_of_band(const sd_ewald *e, double r, double *value)
{
  const int waves = (int) fmax(WAVES, ceil(e->band * (r + 8.0 * e->range) / (2.0 * SD_PI)));
  const double unit = e->band / waves / (2.0 * SD_PI * SD_PI);
  for (int f = 0; f < SD_RADIALS; f++) value[f] = 0.0;
  for (int s = 0; s < waves; s++) {
    const double k = wave_of_band(e, s, waves), k2 = k * k;
    double power = unit * screen_of_band(e, k2), j[3];
    bessel(k * r, j);
    for (int n = 0; n < 3; n++, power *= k2) {
      value[SD_I0 + 2 * n] += power * (j[0] - j[1]);
      value[SD_J0 + 2 * n] += power * k2 * j[2];
      if (n < 2) value[SD_K0 + n] += 0.5 * power * k2 * j[1];
    }
  }
}

/* Over all distances 1/(6 pi r) - I_0 - J_0/3 is 2/3 of that bend and I_1 + J_1/3 is 2/3; up to the range
 *   int 4 pi r^2 (I_n + J_n/3) dr = 4 R^2/(3 pi) int k^(2n - 1) H j_1(kR) dk */
static void tail_of_band(const sd_ewald *e, double *tail)
{
  const double R2 = e->range * e->range, unit = 4.0 / (3.0 * SD_PI) * R2 * e->range * e->band / WAVES;
  tail[0] = 2.0 / 3.0 * bend_of_band(e) - R2 / 3.0;
  tail[1] = -2.0 / 3.0;
  tail[2] = 0.0;
  for (int s = 0; s < WAVES; s++) {
    const double k = wave_of_band(e, s, WAVES), k2 = k * k;
    double power = unit * screen_of_band(e, k2), j[3];
    bessel(k * e->range, j);
    for (int n = 0; n < 3; n++, power *= k2) tail[n] += power * j[1];
  }
}

/* --- functions of the distance --- */

/* I_n and J_n are of (-lap)^n G; K_n is half the curl of it, -grad (L_H + a_ref^2/3 lap L). */
void sd_radial(const sd_ewald *e, double r, double *value)
{
  if (e->band > 0.0) {
    radial_of_band(e, r, value);
    return;
  }
  const double unit = 1.0 / (8.0 * SD_PI);
  const double curl = e->a_ref * e->a_ref / 3.0 - 0.25 / (e->xi * e->xi);
  const sd_filtered f = sd_filtered_at(&(sd_filter){e->xi, e->a_ref}, r * r, 3, 1);
  for (int n = 0; n < 3; n++) {
    const double sign = n == 1 ? -unit : unit;
    double I, J;
    sd_filtered_stokeslet(&f, n, &I, &J);
    value[SD_I0 + 2 * n] = sign * I;
    value[SD_J0 + 2 * n] = sign * J;
    if (n < 2) value[SD_K0 + n] = -sign * (f.L[n][1] + curl * f.L[n + 1][1]);
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

/* Of one pair. Those of all neighbours add up as squares, to about three quarters of this times the root of their
 * number; where spheres are dense and xi a is large, a part of I_0(0) alone would be too much of 1/(6 pi a). */
static double polynomial_error(const sd_ewald *e)
{
  const double neighbours = 4.0 / 3.0 * SD_PI * pow(e->range, 3.0) * e->count / sd_ewald_volume(&e->box);
  double D[SD_RADIALS];
  sd_radial(e, 0.0, D);
  return e->tolerance * fmin(0.1 * D[SD_I0], 0.6 / (6.0 * SD_PI * e->a_ref * sqrt(fmax(1.0, neighbours))));
}

/* The pair's tensor has the mean 1/(6 pi r) over all directions, whatever the radii, less I_n + J_n/3.
 * Integrated over 4 pi r^2 from the range on, by Simpson's rule: there is nothing beyond 8/xi more. */
void sd_radial_tail(const sd_ewald *e, double *tail)
{
  enum { STEPS = 400 };
  if (e->band > 0.0) {
    tail_of_band(e, tail);
    return;
  }
  const double dr = 8.0 / e->xi / STEPS;
  for (int n = 0; n < 3; n++) tail[n] = 0.0;
  for (int s = 0; s <= STEPS; s++) {
    const double r = e->range + s * dr;
    const double weight = (s == 0 || s == STEPS ? 1.0 : s % 2 ? 4.0 : 2.0) * dr / 3.0;
    double D[SD_RADIALS];
    sd_radial(e, r, D);
    for (int n = 0; n < 3; n++) {
      const double mean = D[SD_I0 + 2 * n] + r * r / 3.0 * D[SD_J0 + 2 * n];
      tail[n] += weight * 4.0 * SD_PI * r * r * ((n == 0 ? 1.0 / (6.0 * SD_PI * r) : 0.0) - mean);
    }
  }
}

/* Over the ball of the range the mean of T_k, t = 2 (r/R)^2 - 1, r^2 dr goes as sqrt(1 + t) dt; and of (1 + t) T_k */
static double mean_of_term(int k)
{
  const double k2 = (double) k * k;
  return 0.375 * (1.5 / (2.25 - k2) + 0.5 / (0.25 - k2));
}

static double mean_of_raised_term(int k)
{
  return mean_of_term(k) + 0.5 * (mean_of_term(k + 1) + mean_of_term(abs(k - 1)));
}

/* Forces that are alike add up what polynomials mistake of I_n + J_n/3 in the mean over the ball: their constants make
 * up for the terms from `degree` on that are left out. No wave k = 0 holds the tail of an open box: there they have
 * the mean of it, too, with which all neighbours make up for those beyond them. */
static void keep_means(const sd_ewald *e, int degree, long double series[][SD_CHEBYSHEV_MOST], double *coefficient)
{
  const double R2 = e->range * e->range, ball = 4.0 / 3.0 * SD_PI * R2 * e->range;
  const int open = !e->box.periodic && e->band > 0.0 && e->positive == 0.0;
  double tail[3] = {0.0};
  if (open) sd_radial_tail(e, tail);
  for (int n = 0; n < 3; n++) {
    const long double *I = series[SD_I0 + 2 * n], *J = series[SD_J0 + 2 * n];
    double left = -tail[n] / ball;
    for (int k = degree + 1; k < SD_CHEBYSHEV_MOST - 1; k++)
      left += (double) I[k] * mean_of_term(k) + R2 / 6.0 * (double) J[k] * mean_of_raised_term(k);
    coefficient[(SD_I0 + 2 * n) * SD_RADIAL_TERMS] += left;
  }
}

int sd_radial_fit(const sd_ewald *e, int width, double *coefficient)
{
  enum { NODES = SD_CHEBYSHEV_MOST };
  long double sample[SD_RADIALS][NODES], series[SD_RADIALS][NODES];
  double weight[SD_RADIALS], D[SD_RADIALS];
  for (int s = 0; s < NODES; s++) {
    const double t = (double) sd_chebyshev_node(s, NODES);
    sd_radial(e, e->range * sqrt(0.5 * (1.0 + t)), D);
    for (int f = 0; f < SD_RADIALS; f++) sample[f][s] = D[f];
  }
  weights(e, width, weight);
  const double most = polynomial_error(e);
  int degree = 1;
  for (int f = 0; f < SD_RADIALS; f++) {
    sd_chebyshev_series(sample[f], NODES, series[f]);
    double rest = 0.0;
    int k = NODES - 1;
    for (; k > degree; k--) {
      rest += weight[f] * fabs((double) series[f][k]);
      if (rest > most) break;
    }
    degree = k;
  }
  const int terms = e->single ? SD_RADIAL_SINGLE_TERMS : SD_RADIAL_TERMS;
  if (degree > terms - 1) degree = terms - 1;
  memset(coefficient, 0, SD_RADIALS * SD_RADIAL_TERMS * sizeof(double));
  for (int f = 0; f < SD_RADIALS; f++)
    sd_chebyshev_powers(series[f], degree, coefficient + f * SD_RADIAL_TERMS);
  keep_means(e, degree, series, coefficient);
  return degree;
}
