#include "sd_ewald_splitting_internal.h"

#include <math.h>

#include "sd_constants.h"
#include "sd_window.h"

/* Equal spheres with torques, and waves that end at a band: what torques add is known */
static int equal_turn(const splitting *by)
{
  return by->fall == BAND && by->equal && by->width == 6;
}

/* K a, K the last wave of a band */
static double largest_wave(const splitting *by, double xi_y)
{
  return 2.0 * xi_y * by->spheres.largest;
}

/* Torques have a power of k more than forces, so that what is beyond the range and what windows mistake
 * grows like (K a)^2. From errors of velocities over F/(6 pi a) and of spins over T/(8 pi a^3) at volume
 * fractions from 0.01 to 0.6. */
static double loss_by_torques(const splitting *by, double tolerance, double xi_y)
{
  const double digits = log10(1.0 / tolerance);
  if (by->width < 6) return 1.0;
  if (by->fall == GAUSSIAN) return 3.0;
  if (!by->equal) return 1.2 + 0.2 * digits;
  return fmax(1.0, (1.0 + 0.4 * digits) * pow(largest_wave(by, xi_y), 2.2));
}

double sd_splitting_tightened(const splitting *by, double tolerance, double xi_y)
{
  const double part = by->fall == BAND ? 0.1 : 0.05;
  const double loss = by->equal ? 0.0 : part * pow(largest_wave(by, xi_y), 3.0);
  return tolerance / fmax(1.0, loss) / loss_by_torques(by, tolerance, xi_y);
}

/* Rms of b of sd_radial.h over targets, times that over sources, which count as F^2 ~ a^2. For given means of a^2
 * and a^4 that of a^6 is largest with two sizes, one of them the largest. */
static double rms_of_b(const splitting *by)
{
  const sd_ewald_class *s = &by->spheres;
  const double most = s->largest * s->largest, ref = by->a_ref * by->a_ref;
  const double a2 = s->squares / s->count, a4 = s->fourths / s->count;
  const double a6 = most * a4 - (most * a2 - a4) * (most * a2 - a4) / (most - a2);
  const double targets = a4 - 2.0 * ref * a2 + ref * ref, sources = a6 - 2.0 * ref * a4 + ref * ref * a2;
  return sqrt(fmax(0.0, targets) * fmax(0.0, sources) / a2) / 36.0;
}

/* Part of the tolerance that unlike spheres may leave beyond the range; windows have the rest. */
static const double UNLIKE = 0.62;

/* Where few spheres are large, few pairs of them are just beyond the range, and what these leave may be larger than
 * its rms over all places: the chance is small that it is larger by this. The fourth moment says how many there are,
 * if all are as large as the largest. */
static double more_of_few(const sd_ewald *e, const splitting *by, double K)
{
  const double large = by->spheres.fourths / pow(by->spheres.largest, 4.0);
  const double pairs = large * large * 2.0 * SD_PI * e->range * e->range / (K * sd_ewald_volume(&e->box));
  return sqrt(1.0 + 2.0 / sqrt(pairs));
}

/* b_i b_j (I_2 + J_2 hh) of sd_radial.h has k^4 more than I_0. At r = R the integral over k has its saddle at
 * imaginary waves of the order of K^2 R, not K, so that this part is larger by (K^2 R)^4 b_i b_j; and in H what x
 * gives there a_ref^2 k^2/3 takes away. Its rms over targets and sources of number density 1 beyond the range is
 *   sqrt(R) 3e-4 K^4 (KR - 3)^4 KR exp(-KR) (1 - (K a_ref)^2/23) times the rms of b,
 * the numbers found by integration for KR from 11 to 40. */
double sd_splitting_unlike(const sd_ewald *e, const splitting *by, double t)
{
  if (by->fall != BAND || by->equal) return t;
  const double KR = 2.0 * pow(e->xi * e->range, 2.0), K = KR / e->range;
  const double bend = hypot(0.2, 1.0 - pow(K * e->a_ref, 2.0) / 23.0);
  const double beyond = 3e-4 * pow(K * (KR - 3.0), 4.0) * KR * exp(-KR) * bend * rms_of_b(by);
  const double n = e->count / sd_ewald_volume(&e->box), rms = sqrt(by->spheres.squares / by->spheres.count);
  return t * UNLIKE / more_of_few(e, by, K) * e->tolerance / (6.0 * SD_PI * rms * sqrt(n * e->range) * beyond);
}

double sd_splitting_gaussian_y(const sd_ewald_box *box, double t)
{
  return sqrt(log(1.0 / (box->periodic ? t : 0.7 * t))); /* no mean makes up for the cut-off */
}

double sd_splitting_gaussian_spacing(double xi, double y)
{
  return SD_PI / (2.2 * xi * y);
}

/* Windows of so few points have a larger beta in an open box for the sake of the common flow, and mistake short
 * waves more: the grid is finer. */
enum { FEW_POINTS = 5 };

static int few_points(const splitting *by, double digits)
{
  return by->equal && 2.0 + digits <= FEW_POINTS + 1e-9;
}

/* The range of a band in spacings, and its waves over the shortest of the grid. From errors that were
 * measured over ranges, bands and windows: those of a Gaussian with windows of as many points, whose range
 * is 1.61 spacings times the digits. Windows that are differentiated mistake more; in an open box no mean
 * makes up for the cut-off. */
double sd_splitting_band_spacings(const sd_ewald_box *box, const splitting *by, double t)
{
  const double digits = log10(1.0 / t), open = box->periodic ? 0.0 : few_points(by, digits) ? 0.2 : 0.07;
  const double more = by->slopes && !equal_turn(by) ? (by->five ? 0.36 : 0.18) + 0.1 * digits : 0.0;
  return 0.94 + (0.9 + 0.007 * digits) * digits + more + open;
}

double sd_splitting_spacing(const sd_ewald *e, const splitting *by, double t, double y)
{
  if (by->fall == GAUSSIAN) return sd_splitting_gaussian_spacing(e->xi, y);
  return e->range / sd_splitting_band_spacings(&e->box, by, t);
}

static double band_over_shortest(const splitting *by, double t)
{
  return (by->five ? 0.93 : by->slopes ? 0.98 : 0.96) - 0.01 * log10(1.0 / t);
}

/* H is like that of a Gaussian for long waves: y^2 is half of band times range. */
double sd_splitting_y(const sd_ewald_box *box, const splitting *by, double t)
{
  if (by->fall == GAUSSIAN) return sd_splitting_gaussian_y(box, t);
  return sqrt(0.5 * SD_PI * band_over_shortest(by, t) * sd_splitting_band_spacings(box, by, t));
}

static int whole_points(double least)
{
  const int points = (int) ceil(least - 1e-9);
  return points < 4 ? 4 : points > SD_WINDOW_MOST_POINTS ? SD_WINDOW_MOST_POINTS : points;
}

int sd_splitting_points(double t)
{
  return whole_points(2.0 + log10(1.0 / t));
}

/* A point takes a digit from what windows mistake, and a little less with the beta of unlike spheres and of images,
 * whose heights multiply it. Not all that torques lose is the windows' fault. */
int sd_splitting_points_of(const splitting *by, double tolerance, double xi_y, double t)
{
  if (equal_turn(by)) {
    const double loss = fmax(1.0, 0.42 * pow(largest_wave(by, xi_y), 2.0));
    return whole_points(1.4 + 1.15 * log10(loss / tolerance));
  }
  if (by->five) return FEW_POINTS;
  const double slower = by->fall == BAND && !by->equal ? 0.06 * fmax(0.0, log10(1.0 / tolerance) - 5.0) : 0.0;
  const double heights = by->at_wall ? 0.9 * fmax(0.0, log10(1.0 / t) - 7.9) : 0.0;
  return whole_points(2.0 + log10(1.0 / t) + slower + heights);
}

/* Of the window over its points: where it is differentiated its jump at the ends must be smaller; twice for
 * unlike radii. With the points that windows have for heights above a wall that jump is far below the tolerance,
 * and short waves, which heights multiply, are mistaken less with a smaller beta. */
double sd_splitting_beta(const sd_ewald *e, const splitting *by)
{
  if (equal_turn(by)) return 2.3;
  if (by->five) return 2.7;
  const double heights = by->at_wall ? 0.016 * fmax(0.0, e->points - 10.0) : 0.0;
  if (by->fall == BAND ? !by->equal : by->slopes) return 2.42 - heights;
  return by->fall == BAND && !e->box.periodic && e->points <= FEW_POINTS ? 2.35 : 2.25;
}

/* Windows of five points stand in one vector of floats, and those of six in two. The loss by large spheres above is for
 * any beta and range: with a larger beta, a longer range and a band that is less of the grid, five points leave 1e-3
 * up to K a = 2.7, and what is more grows like the loss. Of radii 1 : 3 to 1 : 6 and of two sizes, at volume fractions
 * from 0.05 to 0.4, errors were 0.40 to 0.87 of that; in oblique boxes forces that are all alike made them larger. */
int sd_splitting_five_may_do(const sd_ewald *e, const splitting *by)
{
  const sd_ewald_box *b = &e->box;
  const int upright = b->periodic && b->tilt[0] == 0.0 && b->tilt[1] == 0.0 && b->tilt[2] == 0.0;
  const int plain = upright && e->positive == 0.0 && by->fall == BAND;
  return plain && !by->equal && by->width == 3 && e->points == FEW_POINTS + 1;
}

int sd_splitting_five_do(const sd_ewald *e)
{
  return e->tolerance >= (1.0 - 1e-9) * 1e-3 * fmax(1.0, pow(e->band * e->largest / 2.7, 3.0));
}

/* A flow that is the same everywhere reaches a sphere with an error that depends on where it stands on the grid:
 * the transform of the window at the wave of the grid over that at none. In an open box spheres under random forces
 * move together, like sqrt(N) of them from a box away. The number is from errors of 20 000 to 10^6 spheres. */
double sd_splitting_common_flow(const sd_ewald *e)
{
  if (e->box.periodic) return 0.0;
  const double alias = sd_window_transform(e->points, e->beta, 2.0 * SD_PI) /
      sd_window_transform(e->points, e->beta, 0.0);
  return 9.1 * fabs(alias) * sqrt(e->count) * e->a_ref / cbrt(sd_ewald_volume(&e->box));
}
