#include "sd_slab_wave.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_image_wave.h"
#include "sd_window.h"

/* --- windows --- */

/* w^(0) sinh(r)/r over sinh(beta)/beta, r^2 = beta^2 + (k P/2)^2 in spacings */
sd_slab_window sd_slab_window_at(const sd_slab *slab, double k)
{
  const sd_ewald *e = &slab->ewald;
  const double half = 0.5 * e->points * slab->spacing, beta = e->beta;
  const double r = hypot(beta, k * half);
  const double zero = sd_window_transform(e->points, beta, 0.0);
  const double slope = (1.0 / tanh(r) - 1.0 / r) / r * half * half * k; /* d ln W/dk */
  return (sd_slab_window){
      .W = zero * (sinh(r) / r) / (sinh(beta) / beta),
      .shift = k * slope - e->a_ref * e->a_ref * k * k / 3.0,
  };
}

/* --- two walls --- */

/* sinh K - K = K^3/6 (1 + K^2/20 (1 + K^2/42 (...))), and e^K - 1 - K, without their
 * cancellation */
static long double sinh_less(long double K)
{
  if (K > 0.5L) return sinhl(K) - K;
  const long double K2 = K * K;
  long double sum = 1.0L;
  for (int n = 7; n >= 2; n--) sum = 1.0L + K2 / ((2 * n) * (2 * n + 1.0L)) * sum;
  return K * K2 / 6.0L * sum;
}

static long double exp_less(long double K)
{
  if (K > 0.5L) return expl(K) - 1.0L - K;
  long double sum = 1.0L;
  for (int n = 18; n >= 3; n--) sum = 1.0L + K / n * sum;
  return 0.5L * K * K * sum;
}

sd_slab_stops sd_slab_stops_at(double k, double height)
{
  const long double K = (long double) k * height, E = expl(-K);
  const long double even = K > 20.0L ? 1.0L - E * E - 2.0L * K * E : 2.0L * E * sinh_less(K);
  const long double odd = -expm1l(-2.0L * K) + 2.0L * K * E;
  const long double less = K > 20.0L ? 1.0L - E * (1.0L + K) : E * exp_less(K);
  return (sd_slab_stops){
      .even = {(double) (less / even), (double) (E * K / even),
               (double) ((1.0L + E * (1.0L - K)) / even)},
      .odd = {(double) ((1.0L + E * (1.0L + K)) / odd), (double) (-E * K / odd),
              (double) ((-expm1l(-K) + E * K) / odd)},
      .E = (double) E,
      .t = (double) (-1.0L / expm1l(-2.0L * K)),
  };
}

/* --- the corner --- */

void sd_slab_corner_free(sd_slab_corner *c)
{
  free(c->q);
  free(c->window);
  free(c->gamma);
  free(c->taper);
  free(c->cosine);
  free(c->sine);
  free(c->work);
  memset(c, 0, sizeof(*c));
}

static double *wave_numbers(size_t count)
{
  return malloc(sizeof(double) * (count + 1));
}

static double sum_of_heights(const sd_slab_corner *c, int m)
{
  return 2.0 * c->slab->first + m * c->slab->spacing;
}

/* Waves, and windows there, without the one that has no partner */
static void fill_waves(sd_slab_corner *c)
{
  const sd_slab *s = c->slab;
  const sd_ewald *e = &s->ewald;
  for (int n = 0; n <= c->waves; n++) {
    const double q = 2.0 * SD_PI * n / c->period, theta = q * s->spacing;
    const double w = sd_window_transform(e->points, e->beta, theta);
    c->q[n] = q;
    c->window[n] = (n == 0 ? 1.0 : 2.0) / (w * w * c->period); /* both signs of q */
    c->gamma[n] =
        s->spacing * sd_window_slope(e->points, e->beta, theta) + e->a_ref * e->a_ref * q / 3.0;
  }
}

/* Steep enough to end where windows do, and smooth enough for what they make of it. */
static void fill_sums(sd_slab_corner *c)
{
  const sd_slab *s = c->slab;
  const double more = s->ewald.points * s->spacing, range = s->ewald.images.range;
  const long row = c->waves + 1;
  for (int m = 0; m < c->sums; m++) {
    const double Z = sum_of_heights(c, m), part = (Z - range) / more;
    c->taper[m] = part <= 0.0 ? 1.0 : 0.5 * erfc(2.5 * (2.0 * part - 1.0));
    for (int n = 0; n < row; n++) {
      c->cosine[m * row + n] = cos(c->q[n] * Z);
      c->sine[m * row + n] = sin(c->q[n] * Z);
    }
  }
}

sd_status sd_slab_corner_create(sd_slab_corner *c, const sd_slab *slab)
{
  const double h = slab->spacing, range = slab->ewald.images.range;
  const int points = slab->ewald.points;
  sd_slab_corner_free(c);
  c->slab = slab;
  c->sums = (int) ceil((range - 2.0 * slab->first) / h) + 1 + points;
  c->waves =
      (int) ceil((range + 2.0 * fabs(slab->first)) / h) + points + 4; /* of twice as many planes */
  c->period = 2.0 * c->waves * h;
  c->waves--;
  const size_t row = (size_t) c->waves + 1, all = row * (size_t) c->sums;
  c->q = wave_numbers(row);
  c->window = wave_numbers(row);
  c->gamma = wave_numbers(row);
  c->taper = wave_numbers((size_t) c->sums);
  c->cosine = wave_numbers(all);
  c->sine = wave_numbers(all);
  c->work = wave_numbers(11 * row);
  if (!c->q || !c->window || !c->gamma || !c->taper || !c->cosine || !c->sine || !c->work) {
    sd_slab_corner_free(c);
    return SD_ENOMEMORY;
  }
  fill_waves(c);
  fill_sums(c);
  return SD_OK;
}

/* Sums over q, q and -q together, of (i q)^d (i gamma)^g e^{iqZ}, d = 0, 1, 2, g = 0, 1, 2, and of what acts
 * on t and on z without gamma: coefficients of cos q Z where d + g is even, of sin q Z where it is odd */
enum { LAMBDA = 9, GTT = LAMBDA, GZZ, SERIES };

static void fill_series(sd_slab_corner *c, double k)
{
  const sd_ewald *e = &c->slab->ewald;
  const double ref = e->a_ref * e->a_ref / 3.0;
  const long row = c->waves + 1;
  for (int n = 0; n < row; n++) {
    const double q = c->q[n], gamma = c->gamma[n], K2 = k * k + q * q;
    const double x = sd_image_exponent(&e->images, K2), filter = exp(-x) * c->window[n];
    const double H = filter > 0.0 ? (1.0 + x - ref * K2) * filter : 0.0;
    const double of_q[3] = {1.0, q, q * q}, of_gamma[3] = {1.0, gamma, gamma * gamma};
    for (int d = 0; d < 3; d++)
      for (int g = 0; g < 3; g++) {
        const int turns = (d + g) % 4; /* i^(d + g): 1, i, -1, -i; i sin = -(q odd) */
        const double value = filter / (2.0 * K2) * of_q[d] * of_gamma[g];
        c->work[(3 * d + g) * row + n] = turns == 0 ? value : -value;
        if (turns == 3) c->work[(3 * d + g) * row + n] = value;
      }
    c->work[GTT * row + n] = H / K2;
    c->work[GZZ * row + n] = k * k * H / (K2 * K2);
  }
}

static void sum_series(const sd_slab_corner *c, int m, double *sum)
{
  const long row = c->waves + 1;
  for (int f = 0; f < SERIES; f++) {
    const int odd = f < LAMBDA && (f / 3 + f % 3) % 2;
    const double *wave = (odd ? c->sine : c->cosine) + m * row, *of = c->work + f * row;
    sum[f] = 0.0;
    for (int n = 0; n < row; n++) sum[f] += of[n] * wave[n];
  }
}

/* Less what the period repeats of unfiltered images, in closed form: S e_-, S e_+ there */
static void take_repeats(const sd_slab_corner *c, const sd_slab_window *w, double k, double Z,
                         double *sum)
{
  const double L = c->period;
  const double unit = 1.0 / (4.0 * k * w->W * w->W * -expm1(-k * L));
  const double down = unit * exp(-k * (L + Z)), up = unit * exp(-k * (L - Z));
  const double step = k * L / -expm1(-k * L), shift = w->shift / k; /* c */
  const double of_k[3] = {1.0, k, k * k}, of_shift[3] = {1.0, shift, shift * shift};
  for (int d = 0; d < 3; d++)
    for (int g = 0; g < 3; g++)
      sum[3 * d + g] -= of_k[d] * of_shift[g] * ((d % 2 ? -down : down) + (g % 2 ? -up : up));
  const double s = 2.0 * w->shift;
  sum[GTT] -= 2.0 * (down + up);
  sum[GZZ] -= down * (1.0 + k * Z + s + step) + up * (1.0 - k * Z + s + step);
}

void sd_slab_corner_at(sd_slab_corner *c, double k, double *value, long stride)
{
  const sd_slab_window w = sd_slab_window_at(c->slab, k);
  const long apart = stride / SD_CORNERS;
  const double r = w.shift;
  fill_series(c, k);
  for (int m = 0; m < c->sums; m++, value += stride) {
    const double Z = sum_of_heights(c, m);
    double sum[SERIES], v[SD_CORNERS];
    sum_series(c, m, sum);
    take_repeats(c, &w, k, Z, sum);
    const double *L0 = sum, *L1 = sum + 3, *L2 = sum + 6;
    const double e = exp(-k * Z) / (4.0 * k * w.W * w.W), cross = k * r * Z + r * r;
    const double both = k * Z + 2.0 * r; /* c + x of (2), sd_slab_wave.h; c x = k^2 z z' + cross */
    v[SD_CORNER_LL] =
        sum[GZZ] - sum[GTT] - 2.0 * k * k * (Z * L0[1] + L0[2]) + e * (1.0 - both + 2.0 * cross);
    v[SD_CORNER_LZ] = -2.0 * k * (Z * L1[1] + L1[2]) - 2.0 * e * cross;
    v[SD_CORNER_ZZ] = -sum[GZZ] - 2.0 * (Z * L2[1] + L2[2]) + e * (1.0 + both + 2.0 * cross);
    v[SD_CORNER_T] = -sum[GTT] + 2.0 * e;
    v[SD_CORNER_ZZ_LL] = -2.0 * k * k * (L0[0] - e);
    v[SD_CORNER_ZZ_LZ] = -2.0 * k * (L1[0] + k * e);
    v[SD_CORNER_ZZ_ZZ] = -2.0 * (L2[0] - k * k * e);
    v[SD_CORNER_DIFFERENCE] = k * (L0[0] - e);
    for (int f = 0; f < SD_CORNERS; f++) value[f * apart] = c->taper[m] * v[f];
  }
}

/* The second moment of a window */
static double moment_of_window(const sd_slab *s)
{
  const double beta = s->ewald.beta, half = 0.5 * s->ewald.points * s->spacing;
  return half * half * (1.0 / tanh(beta) - 1.0 / beta) / beta;
}

void sd_slab_corner_of_mean(sd_slab_corner *c, double *along, double *across, double *beta)
{
  const sd_ewald *e = &c->slab->ewald;
  const double ref = e->a_ref * e->a_ref / 3.0, L = c->period;
  const double w0 = sd_window_transform(e->points, e->beta, 0.0), over = 1.0 / (w0 * w0);
  const double moment = moment_of_window(c->slab);
  const long row = c->waves + 1;
  for (int m = 0; m < c->sums; m++) {
    const double Z = sum_of_heights(c, m);
    double P = 0.0, Z0 = 0.0, Z1 = 0.0, Z2 = 0.0;
    for (int n = 0; n < row; n++) {
      const double q2 = c->q[n] * c->q[n], x = sd_image_exponent(&e->images, q2);
      const double filter = exp(-x) * c->window[n], cosine = filter * c->cosine[m * row + n];
      if (n > 0 && filter > 0.0) P += (1.0 + x - ref * q2) / q2 * cosine;
      Z0 -= 0.5 * cosine;
      Z1 += 0.5 * c->gamma[n] * filter * c->sine[m * row + n];
      Z2 += 0.5 * c->gamma[n] * c->gamma[n] * cosine;
    }
    const double repeats = L / 12.0 + (Z * Z - 2.0 * moment) / (2.0 * L) + ref / L;
    along[m] = c->taper[m] * (-(P - repeats * over) - 0.5 * Z * over);
    across[m] = c->taper[m] * -2.0 * (Z * Z1 + Z2);
    beta[m] = c->taper[m] * -2.0 * Z0;
  }
}
