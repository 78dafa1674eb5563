#include "sd_ewald_splitting_internal.h"

#include <math.h>

#include "sd_constants.h"

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

double sd_splitting_gaussian_y(const sd_ewald_box *box, double t)
{
  return sqrt(log(1.0 / (box->periodic ? t : 0.7 * t))); /* no mean makes up for the cut-off */
}

double sd_splitting_gaussian_spacing(double xi, double y)
{
  return SD_PI / (2.2 * xi * y);
}

/* The range of a band in spacings, and its waves over the shortest of the grid. From errors that were
 * measured over ranges, bands and windows: those of a Gaussian with windows of as many points, whose range
 * is 1.61 spacings times the digits. Windows that are differentiated mistake more; in an open box no mean
 * makes up for the cut-off. */
double sd_splitting_band_spacings(const sd_ewald_box *box, const splitting *by, double t)
{
  const double digits = log10(1.0 / t), open = box->periodic ? 0.0 : 0.07;
  const double more = by->slopes && !equal_turn(by) ? 0.18 + 0.1 * digits : 0.0;
  return 0.94 + (0.9 + 0.007 * digits) * digits + more + open;
}

double sd_splitting_spacing(const sd_ewald *e, const splitting *by, double t, double y)
{
  if (by->fall == GAUSSIAN) return sd_splitting_gaussian_spacing(e->xi, y);
  return e->range / sd_splitting_band_spacings(&e->box, by, t);
}

static double band_over_shortest(const splitting *by, double t)
{
  return (by->slopes ? 0.98 : 0.96) - 0.01 * log10(1.0 / t);
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
  return points < 4 ? 4 : points > SD_EWALD_MOST_POINTS ? SD_EWALD_MOST_POINTS : points;
}

int sd_splitting_points(double t)
{
  return whole_points(2.0 + log10(1.0 / t));
}

/* Not all that torques lose is the windows' fault. */
int sd_splitting_points_of(const splitting *by, double tolerance, double xi_y, double t)
{
  if (!equal_turn(by)) return sd_splitting_points(t);
  const double loss = fmax(1.0, 0.42 * pow(largest_wave(by, xi_y), 2.0));
  return whole_points(1.4 + 1.15 * log10(loss / tolerance));
}

/* Of the window over its points: where it is differentiated its jump at the ends must be smaller; twice for
 * unlike radii */
double sd_splitting_beta(const splitting *by)
{
  if (equal_turn(by)) return 2.3;
  return (by->fall == BAND ? by->equal : !by->slopes) ? 2.25 : 2.42;
}
