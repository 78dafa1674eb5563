#include "sd_ewald.h"

#include <math.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_ewald_cost.h"
#include "sd_ewald_rule_internal.h"
#include "sd_ewald_splitting_internal.h"
#include "sd_window.h"

static const double TIGHTEST = 1e-13, LOOSEST = 1e-1;

double sd_ewald_six_digits(double value)
{
  if (!(value > 0.0)) return 0.0;
  const double unit = pow(10.0, floor(log10(value)) - 5.0);
  return rint(value / unit) * unit;
}

static int sound(const sd_ewald_box *b, const sd_ewald_class *s, double tolerance)
{
  int ok = tolerance > 0.0 && isfinite(tolerance);
  ok = ok && isfinite(s->count) && isfinite(s->squares) && isfinite(s->fourths) &&
       isfinite(s->largest);
  for (int d = 0; d < 3; d++)
    ok = ok && isfinite(b->origin[d]) && isfinite(b->tilt[d]) && isfinite(b->edge[d]) &&
         b->edge[d] > 0.0;
  return ok && isfinite(sd_ewald_volume(b)) && sd_ewald_volume(b) > 0.0;
}

/* xi times the largest radius where the parts need not be positive */
static const double LARGEST = 1.5;

static splitting splitting_for(fall how, const sd_ewald_class *s, int width, double most)
{
  const double rms = sd_ewald_six_digits(sqrt(s->squares / s->count));
  const int equal = fabs(rms / s->largest - 1.0) < 1e-5;
  return (splitting){.fall = how, .spheres = *s, .width = width, .equal = equal,
                     .slopes = !equal || width == 6, .a_ref = equal ? s->largest : rms, .most = most};
}

/* Range of the near part that costs least, as measured: 86 spheres within it at 1e-3, and more at
 * tight tolerances, since the grid gets finer while a near pair costs about the same; in an open box
 * with its padded grid 2.5 times as many. It need not reach the first images, nor beyond an open
 * box. (A range that is just an edge would by rounding hold one image of a sphere and not the
 * opposite one.) What an open box's grid is finer by makes it longer, so that there are as many points
 * of the grid as without. */
static double natural_range(const sd_ewald_box *box, const splitting *by, double digits)
{
  const double more = pow(digits / 3.0, by->fall == BAND ? 1.0 : 1.6);
  const double many = 86.0 * fmax(1.0, more) * (box->periodic ? 1.0 : 2.5);
  const double range = cbrt(3.0 * many * sd_ewald_volume(box) / (4.0 * SD_PI * by->spheres.count));
  if (by->farthest > 0.0) return fmin(by->times * range, by->farthest);
  if (box->periodic) return fmin(range, 0.97 * sd_ewald_narrowest(box));
  return fmin(sd_splitting_finer(by) * range, hypot(box->edge[0], hypot(box->edge[1], box->edge[2])));
}

/* Spheres that overlap are within the range. */
static double least_range(const sd_ewald *e, const splitting *by, double y)
{
  return fmax(y * fmax(e->a_ref / 0.8, e->largest / by->most), 2.0 * e->largest);
}

/* What two walls do to a wave together falls like exp(-k gap), and the grid must have the waves where that
 * is not small. Found by errors in narrow slits, where without it they were 5 times the tolerance. */
static double range_in_gap(const sd_ewald_box *box, const splitting *by, double t, double y)
{
  const double spacing = 3.0 * by->gap / (log(1.0 / t) + 3.0), largest = by->spheres.largest;
  const double range = sd_splitting_band_spacings(box, by, t) / sd_splitting_finer(by) * spacing;
  return fmax(range, fmax(y * largest / by->most, 2.0 * largest));
}

/* Part of the tolerance that may be the error of the common flow; other errors are random and smaller then. */
static const double COMMON = 0.9;

/* xi, a_ref, range, the window, and the largest spacing of the grid. What is lost tightens the tolerance,
 * which in turn moves xi; *near: the tolerance of the range and of the spacing. */
static void split(sd_ewald *e, const splitting *by, double *near)
{
  e->largest = by->spheres.largest;
  e->a_ref = by->a_ref;
  double t = sd_splitting_tightened(by, e->tolerance, 0.0), y = 0.0;
  *near = t;
  for (int k = 0; k < 6; k++) {
    y = sd_splitting_y(&e->box, by, *near);
    e->range = fmax(natural_range(&e->box, by, log10(1.0 / *near)), least_range(e, by, y));
    if (by->gap > 0.0) e->range = fmin(e->range, range_in_gap(&e->box, by, *near, y));
    e->xi = y / e->range;
    if (k == 5) break;
    t = sd_splitting_tightened(by, e->tolerance, e->xi * y);
    *near = fmin(t, sd_splitting_beyond(e, by, *near));
  }
  e->points = sd_splitting_points_of(by, e->tolerance, e->xi * y, t) + by->tall;
  e->beta = sd_splitting_beta(by, e->points);
  e->spacing = sd_splitting_spacing(e, by, *near, y);
  while (by->fall == BAND && e->points < SD_WINDOW_MOST_POINTS && sd_splitting_common_flow(e) > COMMON * e->tolerance)
    e->beta = sd_splitting_beta(by, ++e->points);
  e->reach = e->range;
}

/* Points of the transform of a periodic direction, a multiple of 4 as open ones are: for 42, 50, 54, 70, 90, 98 and
 * 150 points FFTW takes 1.2 to 2 times as long, a point, as for the next such number. */
static int points_of_period(double cells)
{
  return 2 * sd_ewald_transformable(0.5 * cells);
}

sd_status sd_ewald_lay_grid(const sd_ewald_box *box, double h, int points, double *spacing, int *grid)
{
  double all = 1.0;
  *spacing = h;
  for (int d = 0; d < 3; d++) {
    const double cells = sd_ewald_edge_length(box, d) / h;
    if (!(cells < 1e6)) return SD_ENOMEMORY;
    if (box->periodic)
      grid[d] = points_of_period(fmax(cells, points + 2));
    else
      grid[d] = sd_ewald_transformable(ceil(cells) + points + 1);
    all *= grid[d];
  }
  return all < 2147483648.0 ? SD_OK : SD_ENOMEMORY;
}

/* All bytes are set, since the engine compares them. */
static void start(sd_ewald *e, const sd_ewald_box *box, double count, double tolerance)
{
  memset(e, 0, sizeof(*e));
  memcpy(&e->box, box, sizeof(*box));
  e->count = count;
  e->tolerance = tolerance;
}

/* Numbers of grid points are few: what the next of them is finer than asked for shortens the range, of unlike spheres
 * less than in proportion. */
static void end_at_band(sd_ewald *e, const splitting *by, double near)
{
  double h = e->box.periodic ? 0.0 : e->spacing, y = sd_splitting_y(&e->box, by, near);
  for (int d = 0; d < 3 && e->box.periodic; d++)
    h = fmax(h, sd_ewald_edge_length(&e->box, d) / e->grid[d]);
  const double shorter = fmin(1.0, h / e->spacing) * e->range, spacings = sd_splitting_band_spacings(&e->box, by, near);
  e->range = fmax(shorter, least_range(e, by, y));
  for (int k = 0; k < 3; k++) {
    e->xi = y / e->range;
    near = fmin(near, sd_splitting_beyond(e, by, near));
    y = sd_splitting_y(&e->box, by, near);
    e->range = fmax(shorter * (sd_splitting_band_spacings(&e->box, by, near) / spacings), least_range(e, by, y));
  }
  e->reach = e->range;
  e->band = 2.0 * y * y / e->range;
  e->xi = sd_splitting_xi(e);
  e->sized = 1;
}

/* Windows of unlike spheres are differentiated twice, for sources and for targets: what their ends mistake grows as the
 * fourth power of how much finer than asked for a grid is: in small boxes, and across oblique ones. */
static void widen_windows(sd_ewald *e, const splitting *by)
{
  double finest = e->spacing, k[3][3];
  int fewest = e->grid[0];
  sd_ewald_reciprocal(&e->box, k);
  for (int d = 0; d < 3; d++) {
    finest = fmin(finest, 2.0 * SD_PI / hypot(k[d][0], hypot(k[d][1], k[d][2])) / e->grid[d]);
    fewest = e->grid[d] < fewest ? e->grid[d] : fewest;
  }
  const int more = e->points + (int) rint(4.0 * log10(e->spacing / finest)), room = fewest - 2;
  const int most = room < SD_WINDOW_MOST_POINTS ? room : SD_WINDOW_MOST_POINTS;
  e->points = more < most ? more : most;
  e->beta = sd_splitting_beta(by, e->points);
}

static sd_status level_of(sd_ewald *e, const splitting *by)
{
  double near;
  split(e, by, &near);
  const sd_status status = sd_ewald_lay_grid(&e->box, e->spacing, e->points, &e->spacing, e->grid);
  if (status == SD_OK && by->fall == BAND && !by->equal && e->box.periodic) widen_windows(e, by);
  if (status == SD_OK && by->fall == BAND) end_at_band(e, by, near);
  if (status == SD_OK && by->fall == BAND) sd_splitting_fit_planes(e, by);
  return status;
}

static sd_status one_level(sd_ewald *e, fall how, const sd_ewald_class *s, int width, double most)
{
  splitting by = splitting_for(how, s, width, most);
  by.open = !e->box.periodic;
  by.at_wall = e->images.wall.sign != 0;
  const sd_status status = level_of(e, &by);
  if (status != SD_OK || !sd_splitting_five_may_do(e, &by)) return status;
  sd_ewald five;
  memcpy(&five, e, sizeof(five)); /* all bytes: the engine compares them */
  by.five = 1;
  if (level_of(&five, &by) == SD_OK && sd_splitting_five_do(&five)) memcpy(e, &five, sizeof(five));
  return SD_OK;
}

sd_status sd_ewald_gaussian(const sd_ewald_box *box, const sd_ewald_class *s, int width,
                            double tolerance, sd_ewald *out)
{
  start(out, box, s->count, tolerance);
  return one_level(out, GAUSSIAN, s, width, LARGEST);
}

sd_status sd_ewald_gaussian_at(const sd_ewald_box *box, const sd_ewald_class *s, int width,
                               double times, double tolerance, sd_ewald *out)
{
  splitting by = splitting_for(GAUSSIAN, s, width, LARGEST);
  by.equal = 0; /* also if they are: there are others */
  start(out, box, s->count, tolerance);
  double t = tolerance, y = sd_splitting_gaussian_y(box, t);
  for (int k = 0; k < 6; k++) {
    t = sd_splitting_tightened(&by, tolerance, times / s->largest * y);
    y = sd_splitting_gaussian_y(box, t);
    times = fmin(times, 0.5 * y);
  }
  out->largest = s->largest;
  out->a_ref = by.a_ref;
  out->xi = times / s->largest;
  out->range = out->reach = y / out->xi;
  out->points = sd_splitting_points(t);
  out->beta = 2.42 * out->points;
  return sd_ewald_lay_grid(box, sd_splitting_gaussian_spacing(out->xi, y), out->points, &out->spacing, out->grid);
}

sd_status sd_ewald_prepare(const sd_ewald_box *box, const sd_ewald_class *all, double tolerance,
                           sd_ewald *out, int *some)
{
  const sd_ewald_box own = *box;
  *some = 0;
  if (!sound(&own, all, tolerance)) {
    start(out, &own, 0.0, 0.0);
    return SD_ENOTFINITE;
  }
  *some = all->count > 0.0 && all->largest > 0.0;
  start(out, &own, *some ? all->count : 0.0, fmin(fmax(tolerance, TIGHTEST), LOOSEST));
  return SD_OK;
}

/* Is single precision enough for a splitting and its spheres? The tolerance may be off by its last digits.
 * Coordinates have steps of range/2^30 then (sd_ewald_kernels.h): a millionth of a radius at most, which
 * spheres in touch feel. Floats hold squares of lengths, and of their inverses, from 1e-38 to 1e38. Of the flow that
 * all spheres of an open box have in common, N a/L and more, they lose some 4e-7. */
static int floats_do(const sd_ewald *e, const sd_ewald_class *s)
{
  const double shortest = 1e-15, longest = 1e13, lost = 4e-7, rms = sqrt(s->squares / s->count);
  const double flow = e->box.periodic ? 0.0 : s->count * rms / cbrt(sd_ewald_volume(&e->box));
  return e->tolerance >= SD_EWALD_SINGLE * (1.0 - 1e-9) && lost * flow <= 0.5 * e->tolerance && e->range <= 1e3 * rms &&
      e->range >= shortest && e->range <= longest;
}

sd_status sd_ewald_choose(const sd_ewald_box *box, const sd_ewald_sizes *sizes, int width,
                          double tolerance, sd_ewald *out)
{
  int some;
  const sd_status status = sd_ewald_prepare(box, &sizes->all, tolerance, out, &some);
  if (!some) return status;
  const sd_status chosen = one_level(out, BAND, &sizes->all, width, LARGEST);
  out->single = floats_do(out, &sizes->all);
  return chosen;
}

sd_status sd_ewald_choose_positive(const sd_ewald_box *box, const sd_ewald_sizes *sizes, int width,
                                   double tolerance, double bound, sd_ewald *out)
{
  int some;
  const sd_status status = sd_ewald_prepare(box, &sizes->all, tolerance, out, &some);
  if (!some) return status;
  out->positive = bound;
  return one_level(out, BAND, &sizes->all, width, bound);
}

/* Heights above the wall multiply what grid and near part leave out of images. Part of the tolerance
 * and, where the spheres reach higher than some ranges, a smoother part of the images, up to a range
 * that is larger in proportion and a little more, keep the whole error below it. There near images
 * are few; in a layer they are as many as near spheres. */
static const double AT_WALL = 0.125, AT_HIGH_WALL = 0.5, HIGH = 3.0, SMOOTHER = 0.7, FARTHER = 1.5;

/* The mean square of heights between r and 1 times the highest is larger by 1 + r + r^2 than that from the wall up. A
 * thin layer far above it, under equal forces, had 4.3 tolerances. */
static double at_wall_of(const sd_ewald_box *box, const sd_wall *wall)
{
  const double edge = box->edge[wall->axis], from = wall->sign * (box->origin[wall->axis] - wall->at);
  const double lowest = fmax(0.0, wall->sign > 0 ? from : from - edge), r = lowest / (lowest + edge);
  return AT_WALL * pow(1.0 + r + r * r, -2.0);
}

sd_status sd_ewald_choose_at_wall(const sd_ewald_box *box, const sd_wall *wall,
                                  const sd_ewald_sizes *sizes, double tolerance, sd_ewald *out)
{
  int some;
  sd_status status = sd_ewald_prepare(box, &sizes->all, tolerance, out, &some);
  if (!some) return status;
  const double asked = out->tolerance;
  out->images.wall = *wall;
  out->tolerance = fmax(TIGHTEST, at_wall_of(box, wall) * asked);
  status = one_level(out, GAUSSIAN, &sizes->all, 3, LARGEST);
  out->images = (sd_ewald_images){*wall, out->xi, out->range, 0.0};
  if (status == SD_OK && box->edge[wall->axis] > HIGH * out->range) {
    out->tolerance = fmax(TIGHTEST, AT_HIGH_WALL * asked);
    status = one_level(out, GAUSSIAN, &sizes->all, 3, LARGEST);
    out->images = (sd_ewald_images){*wall, SMOOTHER * out->xi, FARTHER * out->range, 0.0};
  }
  out->tolerance = asked;
  out->reach = fmax(out->reach, out->images.range);
  return status;
}

/* Where the gap keeps the range short H needs a smaller reference radius, and windows are differentiated
 * also for equal spheres. */
static sd_status level_in_slab(sd_ewald *e, splitting *by)
{
  double near;
  split(e, by, &near);
  const double y = sd_splitting_y(&e->box, by, near);
  if (e->range < (1.0 - 1e-9) * y * by->a_ref / 0.8) {
    by->slopes = 1;
    by->a_ref = sd_ewald_six_digits(0.8 * e->range / y);
    split(e, by, &near);
  }
  const sd_status status = sd_ewald_lay_grid(&e->box, e->spacing, e->points, &e->spacing, e->grid);
  if (status == SD_OK && !by->equal) widen_windows(e, by);
  if (status == SD_OK) end_at_band(e, by, near);
  return status;
}

/* Across the slab as fine as along it. Windows reach half their width beyond the centres at either end,
 * rounded up, and the first copy of the spheres is beyond the range. */
static sd_status lay_planes(sd_ewald *e, int across, double span)
{
  double h = 0.0, all = 1.0;
  for (int d = 0; d < 3; d++)
    if (d != across) h = fmax(h, sd_ewald_edge_length(&e->box, d) / e->grid[d]);
  const double cells = (span + fmax(e->range, (e->points + 2) * h)) / h;
  if (!(cells < 1e6)) return SD_ENOMEMORY;
  e->grid[across] = points_of_period(cells);
  e->box.edge[across] = h * e->grid[across];
  e->spacing = h;
  e->slab = (sd_ewald_slab){across, (int) ceil(span / h + e->points) + 2};
  for (int d = 0; d < 3; d++) all *= e->grid[d];
  return all < 2147483648.0 ? SD_OK : SD_ENOMEMORY;
}

/* Nothing makes up for what the range of images cuts off, so that it is longer than that of the free part, and
 * more where it is not much shorter than the gap. Found by errors; see sd_slab.h. */
static const double IMAGES_FARTHER = 1.3, IMAGES_IN_NARROW = 1.5;

static void split_images(sd_ewald *e, const splitting *by)
{
  e->images.band = e->band;
  e->images.range = (sd_splitting_narrow(e, by) ? IMAGES_IN_NARROW : IMAGES_FARTHER) * e->range;
  e->reach = e->images.range;
}

/* In a tall cell the mean flow makes spheres a hundred times as fast as alone, and what windows mistake of it is
 * more than elsewhere: they have one point more. */
static const double TALL = 3.0;

/* The range over the cell's edges: where it is nearly an edge, errors of unlike spheres that are all pushed along
 * were above the tolerance. */
static const double WIDEST = 0.65;

static sd_status try_in_slab(sd_ewald *e, splitting by, int across, double span)
{
  by.tall = span > TALL * by.farthest / WIDEST;
  sd_status status = level_in_slab(e, &by);
  if (status == SD_OK) status = lay_planes(e, across, span);
  split_images(e, &by);
  return status;
}

/* Ranges from 2^(-5/4) to 2^(7/4) times that of a cube are tried: in a thin slab the grid has many points for
 * each sphere, and a longer range makes it coarser. */
sd_status sd_ewald_choose_in_slab(const sd_ewald_box *box, int across, double span, double gap,
                                  const sd_ewald_sizes *sizes, double tolerance, sd_ewald *out)
{
  sd_ewald_box tall = *box;
  int some;
  tall.periodic = 1;
  tall.edge[across] = span + 2.0 * sizes->all.largest;
  if (!(tall.edge[across] > 0.0)) tall.edge[across] = 1.0; /* no spheres */
  sd_status status = sd_ewald_prepare(&tall, &sizes->all, tolerance, out, &some);
  if (!some) return status;
  splitting by = splitting_for(BAND, &sizes->all, 3, LARGEST);
  by.farthest = WIDEST * fmin(tall.edge[(across + 1) % 3], tall.edge[(across + 2) % 3]);
  by.gap = isfinite(gap) ? gap : 0.0;
  sd_ewald from;
  double least = INFINITY;
  memcpy(&from, out, sizeof(from));
  status = SD_ENOMEMORY;
  for (int k = -5; k <= 7; k++) {
    sd_ewald one;
    memcpy(&one, &from, sizeof(one)); /* all bytes: the engine compares them */
    by.times = pow(2.0, 0.25 * k);
    if (try_in_slab(&one, by, across, span) != SD_OK) continue;
    const double cost = sd_ewald_slab_cost(&one, span, by.gap > 0.0 ? 2 : 1);
    if (!(cost < 0.999 * least)) continue;
    least = cost;
    status = SD_OK;
    memcpy(out, &one, sizeof(one));
  }
  if (status == SD_OK) sd_splitting_fit_planes(out, &by);
  return status;
}

int sd_ewald_same_tables(const sd_ewald *made, const sd_ewald *wanted)
{
  sd_ewald there = *made;
  for (int d = 0; d < 3 && !made->box.periodic; d++)
    if (!made->images.wall.sign || made->images.wall.axis != d)
      there.box.origin[d] = wanted->box.origin[d];
  return !memcmp(&there, wanted, sizeof(there));
}
