/* The error of an Ewald sum to expect, as its tolerance is meant, of forces that are independent and about as large as
 * a: the part of each pair beyond the range, the waves beyond the grid, and those that the window mistakes. A formula
 * with integrals over k and r; sizes as for sd_ewald_choose. */
#ifndef PREDICTED_H
#define PREDICTED_H

#include "sd_constants.h"
#include "sd_ewald_levels.h"
#include "sd_radial.h"
#include "sd_window.h"

#include <math.h>
#include <stdlib.h>

/* Means of b and b^2 over the spheres on which velocities are wanted, and over those that forces act
 * on, which count as F^2 ~ a^2. */
typedef struct {
  double target[3], source[3];
} moments;

/* The sixth moment of the radii is that of a lognormal distribution with the second and fourth, if
 * the largest sphere allows it. */
static moments moments_of(const sd_ewald *e, const sd_ewald_class *targets,
                          const sd_ewald_class *sources)
{
  const double t2 = targets->squares / targets->count, t4 = targets->fourths / targets->count;
  const double a2 = sources->squares / sources->count, a4 = sources->fourths / sources->count;
  const double ref = e->a_ref * e->a_ref, spread = a4 / (a2 * a2);
  const double a6 =
      fmin(a2 * a2 * a2 * spread * spread * spread, sources->largest * sources->largest * a4);
  moments m = {{1.0, (t2 - ref) / 6.0, (t4 - 2.0 * ref * t2 + ref * ref) / 36.0},
               {1.0, (a4 - ref * a2) / (6.0 * a2),
                (a6 - 2.0 * ref * a4 + ref * ref * a2) / (36.0 * a2)}};
  return m;
}

/* Mean of (x_0 + x_1 (b_i + b_j) + x_2 b_i b_j) (y_0 + ...) over targets i and sources j */
static double mean_product(const moments *m, const double *x, const double *y)
{
  const double *t = m->target, *s = m->source;
  double sum = 0.0;
  for (int p = 0; p < 2; p++) /* powers of b_i and b_j in x and y */
    for (int q = 0; q < 2; q++)
      for (int k = 0; k < 2; k++)
        for (int l = 0; l < 2; l++) sum += x[p + q] * y[k + l] * t[p + k] * s[q + l];
  return sum;
}

/* Mean of (1 - b k2)^2 */
static double mean_square(const double *moment, double k2)
{
  return 1.0 - 2.0 * moment[1] * k2 + moment[2] * k2 * k2;
}

/* Near part, of sources of number density 1: int 4 pi r^2 [A^2 + (2AB + B^2)/3] dr of what lies beyond the range, A and
 * B the coefficients of 1 and hh. The tensor is that of spheres apart. */
static double near_error(const sd_ewald *e, const moments *m)
{
  enum { STEPS = 48 };
  const double span = 3.0 / e->xi, dr = span / STEPS, ref = e->a_ref * e->a_ref;
  double sum = 0.0;
  for (int s = 0; s <= STEPS; s++) {
    const double r = e->range + s * dr, y = 1.0 / (8.0 * SD_PI * r), r2 = r * r;
    const double weight = (s == 0 || s == STEPS ? 1.0 : s % 2 ? 4.0 : 2.0) * dr / 3.0;
    double D[SD_RADIALS];
    sd_radial(e, r, D);
    const double A[3] = {y * (1.0 + 2.0 * ref / (3.0 * r2)) - D[SD_I0], 2.0 * y / r2 + D[SD_I1],
                         -D[SD_I2]};
    const double B[3] = {y * (1.0 - 2.0 * ref / r2) - r2 * D[SD_J0], -6.0 * y / r2 + r2 * D[SD_J1],
                         -r2 * D[SD_J2]};
    sum += weight * 4.0 * SD_PI * r2 *
           (mean_product(m, A, A) + (2.0 * mean_product(m, A, B) + mean_product(m, B, B)) / 3.0);
  }
  return sum;
}

/* One direction of the grid: pairs add up as squares, what a sphere does to itself as it is.
 *   cut        waves beyond the grid, k > pi/h
 *   aliased    waves k + 2 pi m/h, m = +-1, +-2, that the window takes for k; own [2]: by |m| */
typedef struct {
  double cut, cut_own, aliased, own[2];
} wave_errors;

/* At one k along the direction; weight holds rho drho dk/(4 pi^2) of the cylinder around it and 2/3
 * of the mean over directions. */
static void add_wave(const sd_ewald *e, const moments *m, double k, double k2, double h,
                     double weight, wave_errors *w)
{
  const double H = sd_ewald_wave_screen(e, k2), amplitude = H / k2;
  if (fabs(k) * h > SD_PI) {
    w->cut += weight * amplitude * amplitude * mean_square(m->target, k2) * mean_square(m->source, k2);
    w->cut_own += weight * amplitude * mean_square(m->source, k2);
    return;
  }
  const double deep = sd_window_transform(e->points, e->beta, k * h), across2 = k2 - k * k;
  for (int l = -2; l <= 2; l++) {
    const double alias = k + 2.0 * SD_PI * l / h, alias2 = across2 + alias * alias;
    if (l == 0) continue;
    const double G = sd_window_transform(e->points, e->beta, alias * h) / deep;
    w->aliased += 2.0 * weight * amplitude * amplitude * G * G * mean_square(m->target, k2) *
                  mean_square(m->source, alias2);
    w->own[abs(l) - 1] += 0.5 * weight * amplitude * G *
                          (1.0 - m->source[1] * (k2 + alias2) + m->source[2] * k2 * alias2);
  }
}

static wave_errors along_direction(const sd_ewald *e, const moments *m, double h, double least)
{
  enum { STEPS = 64 };
  const double most = 2.0 * e->xi * sqrt(2.3 * 16.0 + 4.0), dk = 2.0 * most / STEPS;
  wave_errors w = {0};
  for (int s = 0; s < STEPS; s++)
    for (int t = 0; t < STEPS / 2; t++) {
      const double k = -most + (s + 0.5) * dk, rho = (t + 0.5) * dk, k2 = k * k + rho * rho;
      if (k2 > least * least)
        add_wave(e, m, k, k2, h, 2.0 / 3.0 * rho * dk * dk / (4.0 * SD_PI * SD_PI), &w);
    }
  return w;
}

/* Square of the error of the wave part of n spheres a volume */
static double wave_error(const sd_ewald *e, const moments *m, double n)
{
  /* as many waves are within it as the box leaves out: the one of k = 0 */
  const double least = cbrt(3.0 / (4.0 * SD_PI) / sd_ewald_volume(&e->box)) * 2.0 * SD_PI;
  double square = 0.0, cut_own = 0.0;
  for (int d = 0; d < 3; d++) {
    const double length = d == 0   ? e->box.edge[0]
                          : d == 1 ? hypot(e->box.edge[1], e->box.tilt[0])
                                   : hypot(e->box.edge[2], hypot(e->box.tilt[1], e->box.tilt[2]));
    const double h = e->box.periodic ? length / e->grid[d] : e->spacing;
    const wave_errors w = along_direction(e, m, h, least);
    square += n * (w.cut + w.aliased) + 8.0 * (w.own[0] * w.own[0] + w.own[1] * w.own[1]);
    cut_own += w.cut_own;
  }
  return square + cut_own * cut_own;
}

/* What sources do to targets, over the share that these have among all: F = 6 pi a times a bare
 * velocity of 1. */
static double share_of(const sd_ewald *e, double all, const sd_ewald_class *targets,
                       const sd_ewald_class *sources, int waves)
{
  if (!(targets->count > 0.0) || !(sources->count > 0.0)) return 0.0;
  const moments m = moments_of(e, targets, sources);
  const double n = sources->count / sd_ewald_volume(&e->box);
  const double square = waves ? wave_error(e, &m, n) : n * near_error(e, &m);
  return square * sources->squares / sources->count * targets->count / all;
}

static void divide(double from, const sd_ewald_sizes *s, sd_ewald_class *small, sd_ewald_class *large)
{
  for (int k = 0; k < SD_EWALD_OCTAVES; k++) {
    const sd_ewald_class *o = s->octave + k;
    sd_ewald_class *to = ldexp(s->all.largest, -k - 1) < from ? small : large;
    to->count += o->count;
    to->squares += o->squares;
    to->fourths += o->fourths;
    to->largest = fmax(to->largest, o->largest);
  }
}

/* second NULL, or without spheres: of one level */
static double predicted_error(const sd_ewald *first, const sd_ewald_level *second, const sd_ewald_sizes *s)
{
  if (!(first->count > 0.0)) return 0.0;
  const double n = s->all.count;
  double square;
  if (second && second->from > 0.0) {
    const sd_ewald *coarse = &second->split;
    sd_ewald_class small = {0}, large = {0};
    divide(second->from, s, &small, &large);
    square = share_of(first, n, &small, &small, 0) + share_of(first, n, &small, &small, 1) +
             share_of(coarse, n, &s->all, &large, 0) + share_of(coarse, n, &large, &small, 0) +
             share_of(coarse, n, &s->all, &s->all, 1);
  } else {
    square = share_of(first, n, &s->all, &s->all, 0) + share_of(first, n, &s->all, &s->all, 1);
  }
  return 6.0 * SD_PI * sqrt(square);
}

#endif
