#include "sd_ewald_splitting_internal.h"

#include <math.h>
#include <string.h>

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
  const double Ka = largest_wave(by, xi_y), overlap = fmax(1.0, 0.2 * Ka);
  return fmax(1.0, (1.0 + 0.4 * digits) * pow(Ka, 2.2) * overlap * overlap);
}

double sd_splitting_tightened(const splitting *by, double tolerance, double xi_y)
{
  const double part = by->fall == BAND ? 0.1 : 0.05;
  const double loss = by->equal ? 0.0 : part * pow(largest_wave(by, xi_y), 3.0);
  return tolerance / fmax(1.0, loss) / loss_by_torques(by, tolerance, xi_y);
}

/* Part of the tolerance that may be left beyond the range; windows have the rest */
static const double BEYOND = 0.62;

/* The share of spheres that are large, if those are as large as the largest: the fourth moment knows it. */
static double share_of_large(const sd_ewald_class *s)
{
  return s->fourths / (s->count * pow(s->largest, 4.0));
}

/* Where few spheres are large, the pairs of them that are just beyond the range may be more than they are on average
 * over all places, and what these leave is larger by this: by three deviations and one pair. */
static double more_of_few(const sd_ewald *e, const splitting *by, double K)
{
  const double large = share_of_large(&by->spheres) * by->spheres.count;
  const double pairs = large * large * 2.0 * SD_PI * e->range * e->range / (K * sd_ewald_volume(&e->box));
  return sqrt(1.0 + 3.0 * sqrt(2.0 / pairs) + 2.0 / pairs);
}

/* What I_0 1 + J_0 hh of sd_radial.h leave beyond the range r = R, over targets and sources of number density 1: the
 * rms over places is sqrt(R) times this. In H what x gives at the saddle of the integral over k a_ref^2 k^2/3 takes
 * away, and where spheres are so dense that K a_ref is beyond 3.5, more than that. Numbers found by integration for KR
 * from 8 to 40. */
static double beyond_of_alike(double KR, double Ka)
{
  return (0.196 + 0.0101 * KR) * hypot(0.25, 1.0 - Ka * Ka / (7.5 + 0.12 * KR)) * KR * exp(-KR);
}

/* b_i b_j (I_2 + J_2 hh) has k^4 more than I_0, and (b_i + b_j) (I_1 + J_1 hh) has k^2 more. At r = R the saddle is at
 * imaginary waves of the order of K^2 R, not K, so that these are larger by powers of K^2 R, and add up where b > 0.
 * As above they are sqrt(R) times
 *   3e-4 q^2 KR exp(-KR) (1 - (K a_ref)^2/23) times the rms of b_i b_j + c (b_i + b_j), q = K^2 (KR - 3)^2, c = 63/q,
 * the numbers found by integration for KR from 8 to 36. */
static double unlike_in(double KR, double K, double Ka)
{
  return 3e-4 * pow(K * (KR - 3.0), 4.0) * KR * exp(-KR) * hypot(0.2, 1.0 - Ka * Ka / 23.0);
}

static double c_of(double KR, double K)
{
  return 63.0 * pow(K * (KR - 3.0), -2.0);
}

/* The rms over targets i, where j is the largest sphere, times its radius over the rms of all. A source counts as
 * F^2/a^2 in what errors are measured with: of all forces those are worst that act on the largest spheres alone, as
 * weights nearly do where few are large; few: more_of_few, of targets that are large. */
static double rms_of_unlike(const splitting *by, double c, double few)
{
  const sd_ewald_class *s = &by->spheres;
  const double most = s->largest * s->largest, ref = by->a_ref * by->a_ref, b = (most - ref) / 6.0;
  const double a2 = s->squares / s->count, a4 = s->fourths / s->count;
  const double mean = (a2 - ref) / 6.0, square = (a4 - 2.0 * ref * a2 + ref * ref) / 36.0, slope = few * (b + c);
  return sqrt(fmax(0.0, slope * slope * square + 2.0 * slope * c * b * mean + c * c * b * b) * most / a2);
}

/* A large sphere in a small box sees images of its own just beyond the range, where chance has nothing to do with it:
 * what one of them leaves is the above times sqrt(K/(2 pi R)), of forces across it 1.22 times as much, and more where
 * it falls faster than exp(-K r). Their sum, over the above. */
static double of_own_images(const sd_ewald_box *box, double R, double K)
{
  const double *L = box->edge, *tilt = box->tilt;
  const int most = 1 + (int) fmin(3.0, R / sd_ewald_narrowest(box)), each = 2 * most + 1;
  double sum = 0.0;
  for (int m = 0; m < each * each * each && box->periodic; m++) {
    const int i = m % each - most, j = m / each % each - most, k = m / (each * each) - most;
    const double r = hypot(i * L[0] + j * tilt[0] + k * tilt[1], hypot(j * L[1] + k * tilt[2], k * L[2]));
    if (r > R) sum += exp(-K * (r - R));
  }
  return 1.22 * fmax(1.0, 0.055 * K * R) * sum * sqrt(K / (2.0 * SD_PI * R));
}

double sd_splitting_beyond(const sd_ewald *e, const splitting *by, double t)
{
  if (by->fall != BAND) return t;
  const double KR = 2.0 * pow(e->xi * e->range, 2.0), K = KR / e->range, Ka = K * e->a_ref;
  const double rms = sqrt(by->spheres.squares / by->spheres.count), n = e->count / sd_ewald_volume(&e->box);
  const double unit = 6.0 * SD_PI / (BEYOND * e->tolerance), all = rms * sqrt(n * e->range);
  double most = unit * all * beyond_of_alike(KR, Ka);
  if (!by->equal) {
    const double a = e->largest, b = (a * a - e->a_ref * e->a_ref) / 6.0, c = c_of(KR, K);
    const double alone = a * b * (b + 2.0 * c) * of_own_images(&e->box, e->range, K);
    const double weighed = fmax(alone, all * rms_of_unlike(by, c, more_of_few(e, by, K)));
    most = fmax(most, unit * unlike_in(KR, K, Ka) * weighed);
  }
  return t / most;
}

double sd_splitting_gaussian_y(const sd_ewald_box *box, double t)
{
  return sqrt(log(1.0 / (box->periodic ? t : 0.7 * t))); /* no mean makes up for the cut-off */
}

double sd_splitting_gaussian_spacing(double xi, double y)
{
  return SD_PI / (2.2 * xi * y);
}

/* Windows of unlike spheres that stand in one vector of floats (sd_splitting_five_may_do) */
enum { FEW_POINTS = 5 };

/* In an open box the range is half as long again as in a periodic one with as many spheres, and what windows mistake
 * of long waves grows with it and adds up under equal forces; a parabola (sd_window.h) makes it more. In slabs windows
 * have no parabola, and walls make more of it. A grid that is finer by this, for the same range and band, and a larger
 * beta leave half of it. Windows that are differentiated have a finer grid for that already, but in slabs. */
double sd_splitting_finer(const splitting *by)
{
  return by->farthest > 0.0 || (by->open && by->fall == BAND && !by->slopes) ? 1.05 : 1.0;
}

/* The range of a band in spacings, and its waves over the shortest of the grid. From errors that were
 * measured over ranges, bands and windows: those of a Gaussian with windows of as many points, whose range
 * is 1.61 spacings times the digits. Windows that are differentiated mistake more; in an open box no mean
 * makes up for the cut-off. */
double sd_splitting_band_spacings(const sd_ewald_box *box, const splitting *by, double t)
{
  const double digits = log10(1.0 / t), open = box->periodic ? 0.0 : 0.07;
  const double more = by->slopes && !equal_turn(by) ? (by->five ? 0.36 : 0.18) + 0.1 * digits : 0.0;
  return sd_splitting_finer(by) * (0.94 + (0.9 + 0.007 * digits) * digits + more + open);
}

double sd_splitting_spacing(const sd_ewald *e, const splitting *by, double t, double y)
{
  if (by->fall == GAUSSIAN) return sd_splitting_gaussian_spacing(e->xi, y);
  return e->range / sd_splitting_band_spacings(&e->box, by, t);
}

static double band_over_shortest(const splitting *by, double t)
{
  return ((by->five ? 0.93 : by->slopes ? 0.98 : 0.96) - 0.01 * log10(1.0 / t)) / sd_splitting_finer(by);
}

/* What is left at r goes like j_1(s)/s times exp(-K R'), s^2 = K^2 (r^2 - R'^2), R' of sd_radial.h. Up to s = 3 that
 * falls to a third, so that R' is a little less than the range: of equal spheres s^2 there is this. By integration it is
 * 10 with which the rms of what is left is least, for KR from 6 to 27 and K a up to 1.5, where it is 0.5 to 0.7 of that
 * with R' = R; less for larger K a, and 0 for 3. With 8 the rms is nearly the same, and less of it is alike. Noise keeps
 * R' = R, with which both parts are positive (sd_ewald_choose_positive). */
double sd_splitting_xi(const sd_ewald *e)
{
  const double KR = e->band * e->range, Ka = e->band * e->a_ref;
  const double s2 = e->a_ref == e->largest && e->positive == 0.0 ? 8.0 * fmax(0.0, 1.0 - pow(Ka / 3.0, 3.0)) : 0.0;
  return sqrt(0.5 * e->band / e->range) * pow(1.0 - s2 / (KR * KR), -0.25);
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
 * whose heights multiply it. Where few spheres are large and bear all the force, errors are not what the mean over all
 * spheres says. Not all that torques lose is the windows' fault. */
int sd_splitting_points_of(const splitting *by, double tolerance, double xi_y, double t)
{
  if (equal_turn(by)) {
    const double loss = fmax(1.0, 0.42 * pow(largest_wave(by, xi_y), 2.0));
    return whole_points(1.4 + 1.15 * log10(loss / tolerance));
  }
  if (by->five) return FEW_POINTS;
  const double slower = by->fall == BAND && !by->equal ? 0.08 * fmax(0.0, log10(1.0 / tolerance) - 5.0) : 0.0;
  const double heights = by->at_wall ? 0.9 * fmax(0.0, log10(1.0 / t) - 7.9) : 0.0;
  const double few = by->fall == BAND && !by->equal ? 0.35 * log10(1.0 / share_of_large(&by->spheres)) : 0.0;
  const double large = by->fall == BAND ? log10(fmax(1.0, largest_wave(by, xi_y) / 8.0)) : 0.0;
  return whole_points(2.0 + log10(1.0 / t) + slower + heights + few + large);
}

/* The jump at the ends of a window is 1/I_0(beta) = exp(-beta) sqrt(2 pi beta), and falls by a digit a point as the
 * tolerance does. Where windows are differentiated it must be smaller; twice for unlike radii. Above a wall of an open
 * box windows have more points, so that the jump is far below the tolerance; and what they mistake of short waves, which
 * a smaller beta makes less, is multiplied by heights: of equal spheres, which may stand on one plane, beta is so small
 * that the jump, too, still falls by a digit a point. */
double sd_splitting_beta(const splitting *by, int points)
{
  if (equal_turn(by)) return 2.3 * points;
  if (by->five) return 2.5 * points;
  if (by->at_wall) return by->equal ? fmax(2.05 * points, log(10.0) * points - 3.0) : 2.25 * points;
  if (by->fall == BAND && by->equal) return sd_splitting_finer(by) > 1.0 ? 2.3 * points : log(10.0) * points - 0.8;
  return (by->fall == BAND || by->slopes ? 2.42 : 2.25) * points;
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
  const int many_large = share_of_large(&by->spheres) > 0.1;
  return plain && many_large && !by->equal && by->width == 3 && e->points == FEW_POINTS + 1;
}

int sd_splitting_five_do(const sd_ewald *e)
{
  return e->tolerance >= (1.0 - 1e-9) * 1e-3 * fmax(1.0, pow(e->band * e->largest / 2.7, 3.0));
}

/* A flow that changes by a part of itself over a box reaches a sphere with an error that depends on where it stands on
 * the grid: the transform of the window at the wave of the grid over that at none, times its change from point to
 * point. (Of a flow that is the same everywhere there is none, nor, for equal spheres, of a parabola: sd_window.h.) The
 * spheres of an open box make a flow of 1.9 N a/L where equal forces act, N a/L of the order of hundreds. The number is
 * from errors of 5000 and 30 000 spheres under such forces with windows of 5 to 8 points. */
double sd_splitting_common_flow(const sd_ewald *e)
{
  if (e->box.periodic || e->a_ref == e->largest) return 0.0;
  const double edge = cbrt(sd_ewald_volume(&e->box)), over = e->beta / e->points;
  const double alias = sinh(e->beta) / e->beta * e->points * sqrt(SD_PI * SD_PI - over * over);
  return 17.0 / alias * e->count * e->a_ref * e->spacing / (edge * edge);
}

int sd_splitting_narrow(const sd_ewald *e, const splitting *by)
{
  const double most = 0.8;
  return by->gap > 0.0 && e->range > most * by->gap;
}

/* --- spheres on one plane --- */

/* sd_window_transform, times a constant */
static double wave_of_window(const sd_ewald *e, double theta)
{
  const double half = 0.5 * theta * e->points, square = e->beta * e->beta - half * half, root = sqrt(fabs(square));
  return root < 1e-6 ? 1.0 : (square > 0.0 ? sinh(root) : sin(root)) / root;
}

/* A sphere's window has the aliases theta - 2 pi and theta + 2 pi beside a wave theta = k h, at most where it stands on
 * a plane of the grid. A constant and a parabola take away what they are at theta = 0, and their second derivative. */
static double aliases(const sd_ewald *e, double theta)
{
  return wave_of_window(e, theta - 2.0 * SD_PI) + wave_of_window(e, theta + 2.0 * SD_PI);
}

static double bend_at(const sd_ewald *e, double theta, double (*f)(const sd_ewald *, double))
{
  const double step = 0.05;
  return (f(e, theta + step) - 2.0 * f(e, theta) + f(e, theta - step)) / (step * step);
}

static double bend_of_window(const sd_ewald *e, double theta)
{
  return bend_at(e, theta, wave_of_window);
}

/* Where N equal spheres under equal forces stand on one plane of area S, waves across it add up in all of them, and so
 * does what both windows mistake of these, w: over F/(6 pi eta a) it is at most N/S times
 *   12 a sum H/k^2 (aliases(kh) - c w(kh) - d w''(kh))/w(kh) dk,   k = dk, 2 dk ..., dk = 2 pi over the period
 * c so that the bracket is 0 at k = 0, and d that of a parabola, with which its second derivative is 0 there too, or
 * 0, and the bend more; H of sd_radial.h. If they are spread evenly over a thickness, (sin x)/x times as much, x half of
 * k times that. */
static double mistaken_of_layer(const sd_ewald *e, double bend, double thick, double h, double first, double dk)
{
  const double a = e->largest, K = e->band;
  const double w0 = wave_of_window(e, 0.0), w2 = bend_of_window(e, 0.0), w4 = bend_at(e, 0.0, bend_of_window);
  const double a0 = aliases(e, 0.0), a2 = bend_at(e, 0.0, aliases);
  const double parabola = e->slab.planes == 0 ? 1.0 : 0.0; /* sd_ewald_waves.c */
  const double d = parabola * (a2 * w0 - a0 * w2) / (w4 * w0 - w2 * w2) + bend, c = (a0 - d * w2) / w0;
  double sum = 0.0;
  for (double k = first; k < K; k += dk) {
    const double k2 = k * k, theta = k * h, w = wave_of_window(e, theta);
    const double x = 0.5 * K / (e->xi * e->xi) * k2 / (K + sqrt(K * K - k2)), H = (1.0 + x - a * a * k2 / 3.0) * exp(-x);
    const double half = 0.5 * k * thick, spread = half < 1e-6 ? 1.0 : sin(half) / half;
    sum += spread * H / k2 * (aliases(e, theta) - c * w - d * bend_of_window(e, theta)) / w * dk;
  }
  return 12.0 * a * sum;
}

/* That of planes along two edges of the box, with all spheres or as many as have room there without overlap: mistaken
 * [3] with no bend, and what a bend of 1 adds to it. Many waves are an integral. */
static void mistaken_of_planes(const sd_ewald *e, double *mistaken, double *by_bend)
{
  enum { MANY = 40 };
  const double densest = 1.0 / (sqrt(12.0) * e->largest * e->largest);
  double wave[3][3];
  sd_ewald_reciprocal(&e->box, wave);
  for (int d = 0; d < 3; d++) {
    const double q = hypot(wave[d][0], hypot(wave[d][1], wave[d][2])), period = 2.0 * SD_PI / q;
    const double spheres = fmin(densest, e->count * period / sd_ewald_volume(&e->box));
    const double h = e->box.periodic ? period / e->grid[d] : e->spacing;
    const int few = e->box.periodic && e->band < MANY * q;
    const double dk = few ? q : e->band / MANY, first = few ? q : 0.5 * dk;
    mistaken[d] = spheres * mistaken_of_layer(e, 0.0, 0.0, h, first, dk);
    by_bend[d] = spheres * mistaken_of_layer(e, 1.0, 0.0, h, first, dk) - mistaken[d];
  }
}

static double most_with(const double *mistaken, const double *by_bend, double bend)
{
  double most = 0.0;
  for (int d = 0; d < 3; d++) most = fmax(most, fabs(mistaken[d] + bend * by_bend[d]));
  return most;
}

/* Takes the bend for which the largest of the three errors is least. In two directions they are then opposite, or one
 * is 0; where all spacings are alike, all three are 0. A box so thin that no wave across it is kept adds nothing. */
static void bend_window(sd_ewald *e)
{
  double mistaken[3], by_bend[3];
  mistaken_of_planes(e, mistaken, by_bend);
  double least = most_with(mistaken, by_bend, 0.0);
  for (int k = 0; k < 9; k++) {
    const double both = by_bend[k / 3] + by_bend[k % 3];
    if (both == 0.0) continue;
    const double bend = -(mistaken[k / 3] + mistaken[k % 3]) / both, left = most_with(mistaken, by_bend, bend);
    if (!(left < least)) continue;
    least = left;
    e->bend = bend;
  }
}

static double most_on_planes(const sd_ewald *e)
{
  double mistaken[3], by_bend[3];
  mistaken_of_planes(e, mistaken, by_bend);
  return most_with(mistaken, by_bend, 0.0);
}

/* An open box stands close around its spheres, the largest's radius beyond them or more, so that its narrowest edge tells
 * whether they are on one plane. Across many spacings the bend is next to none: there the parabola is what counts, for
 * the flow that all spheres have in common. */
static void bend_window_across(sd_ewald *e)
{
  enum { MANY = 80 };
  const double *L = e->box.edge, thick = fmax(0.0, fmin(L[0], fmin(L[1], L[2])) - 2.0 * e->largest);
  if (thick > 0.5 * MANY * e->spacing) return;
  const double dk = e->band / MANY, plain = mistaken_of_layer(e, 0.0, thick, e->spacing, 0.5 * dk, dk);
  e->bend = -plain / (mistaken_of_layer(e, 1.0, thick, e->spacing, 0.5 * dk, dk) - plain);
}

/* Errors of random forces add to it. A smaller beta mistakes short waves less and long ones more, whose signs differ,
 * and more at the ends of the window, where it is 1/I_0(beta) = exp(-beta) sqrt(2 pi beta): of those with which this is
 * no more than at the tightest tolerances, the one that leaves least. */
static const double ON_A_PLANE = 0.5, AT_THE_ENDS = 0.25;

static void lower_beta(sd_ewald *e)
{
  double least = most_on_planes(e);
  if (least <= ON_A_PLANE * e->tolerance) return;
  sd_ewald other;
  memcpy(&other, e, sizeof(other));
  for (int k = 1; k < 3; k++) {
    other.beta *= 0.99;
    if (exp(-other.beta) * sqrt(2.0 * SD_PI * other.beta) > AT_THE_ENDS * e->tolerance) break;
    const double left = most_on_planes(&other);
    if (left >= least) continue;
    least = left;
    e->beta = other.beta;
  }
}

/* Two walls that are near multiply what a bend makes of waves that fall off across them. */
void sd_splitting_fit_planes(sd_ewald *e, const splitting *by)
{
  if (!by->equal || e->a_ref != e->largest) return;
  if (e->box.periodic && !sd_splitting_narrow(e, by))
    bend_window(e);
  else
    lower_beta(e);
  if (!e->box.periodic) bend_window_across(e);
}
