#include "sd_field.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_ewald_rule_internal.h"
#include "sd_field_internal.h"
#include "sd_room.h"
#include "sd_sphere.h"

void sd_field_free(sd_field *f)
{
  sd_ewald_waves_free(&f->waves);
  free(f->source);
  free(f->scratch);
  free(f->centre);
  sd_ewald_cells_free(&f->cells);
  memset(f, 0, sizeof(*f));
}

static double all_points(const sd_field_grid *g)
{
  return (double) g->n[0] * g->n[1] * g->n[2];
}

/* --- how it is summed --- */

/* In an open box near pairs and transforms of sources and points together cost about the same where
 * the range holds as many sources as it would for a product of sqrt(n points) spheres, whose rule is
 * known. Points have radius 0 and stand for half of them, so that the rule does not take all radii for
 * equal; a_ref 0 makes a point's window a plain one. A point does not average over a sphere as a
 * sphere does, so the same splitting leaves it a larger error: 0.5 makes up for that, and 0.3 where it is
 * small and windows count more. With torques the rule is stricter by 3, for the sake of angular
 * velocities, which points do not have. Waves fall as a Gaussian, whose errors at points these are. */
static sd_status choose_open(const sd_ewald_box *box, const sd_ewald_sizes *those, int width,
                             double points, double tolerance, sd_ewald *out)
{
  sd_ewald_sizes sizes = *those;
  sd_ewald_class *all = &sizes.all;
  const double n = all->count;
  all->count = fmax(1.0, sqrt(n * points));
  all->squares *= 0.5 * all->count / n;
  all->fourths *= 0.5 * all->count / n;
  if (!(all->largest > 0.0)) { /* point forces: the rule wants a size, and this one is none */
    all->largest = 1e-3 * cbrt(sd_ewald_volume(box) / all->count);
    all->squares = 0.5 * all->count * all->largest * all->largest;
    all->fourths = all->squares * all->largest * all->largest;
  }
  const double tighter = width == 6 ? 0.9 : tolerance > 5e-4 ? 0.5 : 0.3;
  int some;
  sd_status status = sd_ewald_prepare(box, all, tighter * tolerance, out, &some);
  if (some) status = sd_ewald_gaussian(box, all, width, out->tolerance, out);
  out->a_ref = 0.0;
  return status;
}

static sd_status choose(const sd_ewald_box *box, const sd_field_cloud *c, int width,
                        double points, double tolerance, sd_ewald *out)
{
  const sd_ewald_sizes sizes = {.all = c->all};
  if (!box->periodic) return choose_open(box, &sizes, width, points, tolerance, out);
  return sd_ewald_choose_at_points(box, &sizes, width, points, tolerance, out);
}

/* The open box that holds sources and grid: it lasts while they move a little. */
static void box_around(sd_ewald_box *box, const sd_field_cloud *c, const sd_field_grid *g)
{
  double lo[3], hi[3], largest = c->all.largest;
  for (int d = 0; d < 3; d++) {
    lo[d] = fmin(c->lo[d], g->lo[d]);
    hi[d] = fmax(c->hi[d], g->lo[d] + (g->n[d] - 1) * g->step[d]);
    if (!(hi[d] > lo[d])) /* one sphere and one point make no box */
      largest = fmax(largest, g->step[d]);
  }
  sd_ewald_box_around(box, -1, lo, hi, largest);
}

/* In pairs of the sum over all of them, as sd_ewald_cost.h weighs those of a product: a near pair
 * has polynomials to evaluate, a grid point goes through six transforms, padded in an open box. */
static double cost_of_split(const sd_ewald *e, double sources, double points)
{
  const double near_pair = 2.5, window_point = 1.5, grid_point = 40.0 * 8.0 * 7.0 / 12.0;
  const double ball = sd_sphere_volume(e->range);
  const double share = fmin(1.0, ball / sd_ewald_volume(&e->box));
  return near_pair * share * sources * points + window_point * sources * pow(e->points, 3) +
      grid_point * e->grid[0] * e->grid[1] * (double) e->grid[2];
}

void sd_field_measure(const sd_field_sources *s, sd_field_cloud *out)
{
  *out = (sd_field_cloud){.all.count = s->n};
  for (int d = 0; d < 3; d++) {
    out->lo[d] = INFINITY;
    out->hi[d] = -INFINITY;
  }
  for (long i = 0; i < s->n; i++) {
    const double a2 = s->a[i] * s->a[i];
    out->all.squares += a2;
    out->all.fourths += a2 * a2;
    out->all.largest = fmax(out->all.largest, s->a[i]);
    out->check += s->a[i];
    for (int d = 0; d < 3; d++) {
      const double x = s->x[3 * i + d], T = s->T ? s->T[3 * i + d] : 0.0;
      out->torque += fabs(T);
      out->check += x + s->F[3 * i + d] + T;
      out->lo[d] = fmin(out->lo[d], x);
      out->hi[d] = fmax(out->hi[d], x);
    }
  }
}

/* The largest radius becomes 1 ... 2; without radii the spacing does. */
static double scale_of(const sd_field_cloud *c, const sd_field_grid *g)
{
  return ldexp(1.0, -ilogb(c->all.largest > 0.0 ? c->all.largest : g->step[0]));
}

sd_status sd_field_plan(sd_field *f, sd_field_sum how, const sd_ewald_box *box, double tolerance,
                        const sd_field_cloud *all, const sd_field_grid *g, double *range)
{
  const double n = all->all.count, points = all_points(g);
  *range = INFINITY;
  f->how = (sd_field_how){.width = all->torque > 0.0 ? 6 : 3, .tolerance = tolerance, .scale = 1.0};
  if (n == 0.0) return SD_OK;
  if (!isfinite(all->check)) return SD_ENOTFINITE;
  f->how.scale = scale_of(all, g);
  if (!box->periodic && how == SD_FIELD_DIRECT) return SD_OK;
  sd_ewald_box open = f->around;
  if (!box->periodic) box_around(&open, all, g);
  sd_ewald *e = &f->how.ewald;
  const sd_status status =
      choose(box->periodic ? box : &open, all, f->how.width, points, tolerance, e);
  const int must = box->periodic || how == SD_FIELD_SPLIT;
  if (must && status != SD_OK) return status;
  f->how.split = must || (status == SD_OK && cost_of_split(e, n, points) < n * points);
  if (!f->how.split) return SD_OK;
  f->around = open;
  *range = e->range;
  return SD_OK;
}

/* --- sources, as the kernels read them --- */

static int sort_sources(sd_field *f, const sd_field_sources *s)
{
  return sd_reserve(&f->centre, sizeof(double), 3 * (size_t) s->n + SD_FULL, &f->centre_room) &&
      sd_ewald_cells_sort(&f->cells, s->x, NULL, s->n, 2.0 * f->how.ewald.range, 0, f->centre) == SD_OK;
}

/* In the order that is given */
static int list_sources(sd_field *f, const sd_field_sources *s, const int *order)
{
  const size_t n = (size_t) s->n;
  const double scale = f->how.scale;
  if (!sd_reserve(&f->source, sizeof(double), SD_FIELD_ROW * n, &f->source_room)) return 0;
  for (size_t k = 0; k < n; k++) {
    const size_t i = order ? (size_t) order[k] : k;
    double *row = f->source + SD_FIELD_ROW * k;
    for (int d = 0; d < 3; d++) {
      row[d] = scale * s->x[3 * i + d];
      row[4 + d] = s->F[3 * i + d];
      row[7 + d] = s->T ? scale * s->T[3 * i + d] : 0.0;
    }
    row[3] = scale * s->a[i];
  }
  return 1;
}

/* --- the parts of a sum --- */

static sd_field_part part_of(const sd_field *f, int n, const sd_field_grid *g, double *u)
{
  const double scale = f->how.scale;
  sd_field_part p = {.n = n, .source = f->source, .turns = f->how.width == 6,
                     .unit = scale / (8.0 * SD_PI), .u = u};
  for (int d = 0; d < 3; d++) {
    p.step[d] = scale * g->step[d];
    p.lo[d] = scale * g->lo[d];
    p.points[d] = g->n[d];
  }
  p.lo[2] = scale * (g->lo[2] + g->from * g->step[2]);
  p.points[2] = g->to - g->from;
  return p;
}

static void field_range_of(const sd_field *f, sd_field_part *p)
{
  const double scale = f->how.scale;
  static const int power[SD_RADIALS] = {1, 3, 3, 5, 5, 7, 3, 5};
  p->range = scale * f->ewald.range;
  p->ref = scale * f->ewald.a_ref;
  p->degree = f->degree;
  for (int k = 0; k < SD_RADIALS; k++) {
    const double unit = 8.0 * SD_PI / pow(scale, power[k]);
    for (int m = 0; m <= f->degree; m++) p->coefficient[k][m] = unit * f->coefficient[k][m];
  }
}

/* Of this splitting, unless they are there */
static sd_status field_make_tables(sd_field *f, const sd_world *world)
{
  const struct sd_ewald_kernels *kernels = SD_KERNELS_OF(sd_ewald, plain, sd_isa_of(SD_ISA_BEST));
  const sd_ewald *e = &f->how.ewald;
  const int width = f->how.width;
  if (f->ready && f->width == width && sd_ewald_same_tables(&f->ewald, e)) {
    f->ewald = *e;
    f->waves.grid.world = *world;
    sd_ewald_waves_stand(&f->waves, &e->box);
    return SD_OK;
  }
  f->ready = 0;
  f->ewald = *e;
  f->width = width;
  const int least = sd_radial_fit(e, width, f->coefficient[0]);
  f->degree = SD_RADIAL_TERMS - 1;
#define OF_DEGREE(d) \
  if ((d) >= least && (d) < f->degree) f->degree = d;
  f->floats = f->how.tolerance >= SD_FIELD_FLOAT_TOLERANCE && least <= SD_FIELD_FLOAT_MOST;
  if (f->floats) {
    SD_FIELD_FLOAT_DEGREES(OF_DEGREE)
  } else {
    SD_NEAR_DEGREES(OF_DEGREE)
  }
#undef OF_DEGREE
  sd_radial_tail(e, f->tail);
  const sd_status status = sd_ewald_waves_create(&f->waves, e, kernels, width, world);
  f->ready = status == SD_OK;
  return status;
}

/* Velocities on the waves' grid */
static sd_status field_convolve(sd_field *f, const sd_field_sources *s, const sd_world *world)
{
  const int m = f->width;
  const size_t n = (size_t) s->n;
  int *which = malloc(sizeof(int) * (n + 1)), brick[6];
  sd_status status = SD_OK;
  const size_t numbers = (2 * (size_t) m + 5) * n;
  if (!which || !sd_reserve(&f->scratch, sizeof(double), numbers, &f->scratch_room))
    status = SD_ENOMEMORY;
  double *x = f->scratch, *a = x + 3 * n, *w = a + n, *F = w + n, *u = F + m * n;
  const sd_spheres ours = {x, a, w};
  for (size_t i = 0; i < n && status == SD_OK; i++) {
    const size_t j = (size_t) f->cells.place[i];
    which[i] = (int) i;
    w[i] = 1.0;
    a[i] = s->a[j];
    memcpy(x + 3 * i, s->x + 3 * j, 3 * sizeof(double));
    memcpy(F + (size_t) m * i, s->F + 3 * j, 3 * sizeof(double));
    for (size_t d = 0; d < 3 && m == 6; d++) F[6 * i + 3 + d] = s->T ? s->T[3 * j + d] : 0.0;
  }
  if (status == SD_OK) status = sd_ewald_waves_find(&f->waves, &ours, which, (int) n, brick);
  if (status == SD_OK) status = sd_ewald_waves_place_whole(&f->waves);
  status = sd_world_agree(world, status);
  if (status == SD_OK) sd_ewald_waves_load(&f->waves, &ours, F, u);
  if (status == SD_OK) status = sd_ewald_waves_convolve(&f->waves, u);
  free(which);
  return status;
}

/* What is beyond the range is felt as a mean, of the sources of all ranks; a point has b = 0. */
static sd_status field_mean_of(const sd_field *f, const sd_field_sources *s, const sd_world *world,
                               double *mean)
{
  for (int d = 0; d < 3; d++) mean[d] = 0.0;
  if (!f->ewald.box.periodic) return SD_OK;
  const double over_V = 1.0 / sd_ewald_volume(&f->ewald.box);
  for (long i = 0; i < s->n; i++) {
    const double b = sd_ewald_b(&f->ewald, s->a[i]);
    for (int d = 0; d < 3; d++)
      mean[d] += over_V * (f->tail[0] - b * f->tail[1]) * s->F[3 * i + d];
  }
  return sd_world_sum(world, mean, 3);
}

sd_status sd_field_add_all(sd_field *f, const sd_field_sources *some, const sd_field_grid *g,
                           double *u)
{
  if (!list_sources(f, some, NULL)) return SD_ENOMEMORY;
  const sd_field_part p = part_of(f, some->n, g, u);
  SD_KERNELS_OF(sd_field, plain, sd_isa_of(SD_ISA_BEST))->direct(&p);
  return SD_OK;
}

sd_status sd_field_add_split(sd_field *f, const sd_field_sources *ours,
                             const sd_field_sources *near, const sd_field_grid *g,
                             const sd_world *world, double *u)
{
  const struct sd_field_kernels *kernels = SD_KERNELS_OF(sd_field, plain, sd_isa_of(SD_ISA_BEST));
  double mean[3];
  sd_status status = field_make_tables(f, world);
  if (!sort_sources(f, ours)) status = SD_ENOMEMORY;
  status = sd_world_agree(world, status);
  if (status == SD_OK) status = field_mean_of(f, ours, world, mean);
  if (status == SD_OK) status = field_convolve(f, ours, world);
  if (status != SD_OK) return status;
  if (!sort_sources(f, near) || !list_sources(f, near, f->cells.place)) return SD_ENOMEMORY;
  sd_field_part p = part_of(f, near->n, g, u);
  field_range_of(f, &p);
  memcpy(p.mean, mean, sizeof(mean));
  status = sd_field_near(f, &p, kernels);
  return status == SD_OK ? sd_field_gather(f, g, kernels, u) : status;
}
