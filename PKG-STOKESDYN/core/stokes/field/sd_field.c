#include "sd_field.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_field_internal.h"
#include "sd_room.h"

void sd_field_free(sd_field *f)
{
  sd_ewald_waves_free(&f->waves);
  free(f->source);
  free(f->scratch);
  free(f->cells.first);
  free(f->cells.order);
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
 * velocities, which points do not have. */
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
  const sd_status status = sd_ewald_choose(box, &sizes, width, tighter * tolerance, out);
  out->a_ref = 0.0;
  return status;
}

static sd_status choose(const sd_ewald_box *box, const sd_field_sources *s, const sd_field_grid *g,
                        double tolerance, sd_ewald *out)
{
  const int width = s->T ? 6 : 3;
  sd_ewald_sizes sizes = {.all = {.count = s->n}};
  for (int i = 0; i < s->n; i++) {
    const double a2 = s->a[i] * s->a[i];
    sizes.all.squares += a2;
    sizes.all.fourths += a2 * a2;
    sizes.all.largest = fmax(sizes.all.largest, s->a[i]);
  }
  if (!box->periodic) return choose_open(box, &sizes, width, all_points(g), tolerance, out);
  return sd_ewald_choose_at_points(box, &sizes, width, all_points(g), tolerance, out);
}

/* The open box that holds sources and grid: it lasts while they move a little. */
static void box_around(sd_ewald_box *box, const sd_field_sources *s, const sd_field_grid *g)
{
  double lo[3], hi[3], largest = 0.0;
  for (int d = 0; d < 3; d++) {
    lo[d] = g->lo[d];
    hi[d] = g->lo[d] + (g->n[d] - 1) * g->step[d];
  }
  for (int i = 0; i < s->n; i++) {
    largest = fmax(largest, s->a[i]);
    for (int d = 0; d < 3; d++) {
      lo[d] = fmin(lo[d], s->x[3 * (long) i + d]);
      hi[d] = fmax(hi[d], s->x[3 * (long) i + d]);
    }
  }
  for (int d = 0; d < 3; d++) /* one sphere and one point make no box */
    if (!(hi[d] > lo[d])) largest = fmax(largest, g->step[d]);
  sd_ewald_box_around(box, -1, lo, hi, largest);
}

/* In pairs of the sum over all of them, as sd_ewald_cost.h weighs those of a product: a near pair
 * has polynomials to evaluate, a grid point goes through six transforms, padded in an open box. */
static double cost_of_split(const sd_ewald *e, const sd_field_sources *s, const sd_field_grid *g)
{
  const double near_pair = 2.5, window_point = 1.5, grid_point = 40.0 * 8.0 * 7.0 / 12.0;
  const double ball = 4.0 / 3.0 * SD_PI * e->range * e->range * e->range;
  const double share = fmin(1.0, ball / sd_ewald_volume(&e->box));
  return near_pair * share * s->n * all_points(g) + window_point * s->n * pow(e->points, 3) +
      grid_point * e->grid[0] * e->grid[1] * (double) e->grid[2];
}

/* --- sources, as the kernels read them --- */

typedef struct {
  sd_field *f;
  int n;
  double scale;
  /* the sphere of which an image is added */
  const double *a, *F, *T;
} listing;

static int add_image(void *ctx, const double *x, const int *steps)
{
  listing *l = ctx;
  (void) steps;
  const size_t numbers = (size_t) SD_FIELD_ROW * (size_t) l->n, room = l->f->source_room;
  if (numbers + SD_FIELD_ROW > room) {
    if (!sd_grow(&l->f->source, sizeof(double), 2 * room + 64 * SD_FIELD_ROW)) return 0;
    l->f->source_room = 2 * room + 64 * SD_FIELD_ROW;
  }
  double *row = l->f->source + numbers;
  for (int d = 0; d < 3; d++) {
    row[d] = l->scale * x[d];
    row[4 + d] = l->F[d];
    row[7 + d] = l->T ? l->scale * l->T[d] : 0.0;
  }
  row[3] = l->scale * *l->a;
  l->n++;
  return 1;
}

/* Those that are within the range of our points, with all images; split 0: the spheres themselves */
static int list_sources(listing *l, const sd_ewald_box *box, int split, double range,
                        const sd_field_sources *s, const sd_field_grid *g)
{
  static const int none[3] = {0, 0, 0};
  double lo[3], hi[3];
  for (int d = 0; d < 3; d++) {
    const int from = d == 2 ? g->from : 0, last = d == 2 ? g->to - 1 : g->n[d] - 1;
    lo[d] = g->lo[d] + from * g->step[d] - range;
    hi[d] = g->lo[d] + last * g->step[d] + range;
  }
  int ok = 1;
  for (int k = 0; k < s->n && ok; k++) {
    const long i = l->f->cells.order[k];
    l->a = s->a + i;
    l->F = s->F + 3 * i;
    l->T = s->T ? s->T + 3 * i : NULL;
    ok = split ? sd_field_images(box, lo, hi, s->x + 3 * i, add_image, l)
               : add_image(l, s->x + 3 * i, none);
  }
  return ok;
}

/* --- the parts of a sum --- */

/* The largest radius becomes 1 ... 2; without radii the spacing does */
static double scale_of(const sd_field_sources *s, const sd_field_grid *g)
{
  double largest = 0.0;
  for (int i = 0; i < s->n; i++) largest = fmax(largest, s->a[i]);
  if (!(largest > 0.0)) largest = g->step[0];
  return ldexp(1.0, -ilogb(largest));
}

static sd_field_part part_of(const sd_field_sources *s, const sd_field_grid *g, double scale,
                             double *u)
{
  sd_field_part p = {.turns = s->T != NULL, .unit = scale / (8.0 * SD_PI), .u = u};
  for (int d = 0; d < 3; d++) {
    p.step[d] = scale * g->step[d];
    p.lo[d] = scale * g->lo[d];
    p.points[d] = g->n[d];
  }
  p.lo[2] = scale * (g->lo[2] + g->from * g->step[2]);
  p.points[2] = g->to - g->from;
  return p;
}

static void range_of(const sd_field *f, double scale, sd_field_part *p)
{
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
static sd_status make_tables(sd_field *f, const sd_ewald *e, int width, double tolerance,
                             const sd_world *world)
{
  const struct sd_ewald_kernels *kernels = SD_KERNELS_OF(sd_ewald, plain, sd_isa_of(SD_ISA_BEST));
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
  f->floats = tolerance >= SD_FIELD_FLOAT_TOLERANCE && least <= SD_FIELD_FLOAT_MOST;
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

/* Velocities on the waves' grid, from a share of the sources */
static sd_status convolve(sd_field *f, const sd_field_sources *s, const sd_world *world)
{
  const int me = sd_world_me(world), ranks = sd_world_ranks(world), m = f->width;
  const long begin = (long) s->n * me / ranks, end = (long) s->n * (me + 1) / ranks;
  const size_t n = (size_t) (end - begin);
  int *which = malloc(sizeof(int) * (n + 1)), brick[6];
  sd_status status = SD_OK;
  if (!which || !sd_reserve(&f->scratch, sizeof(double), (2 * (size_t) m + 5) * n, &f->scratch_room))
    status = SD_ENOMEMORY;
  double *x = f->scratch, *a = x + 3 * n, *w = a + n, *F = w + n, *u = F + m * n;
  const sd_spheres ours = {x, a, w};
  for (size_t i = 0; i < n && status == SD_OK; i++) {
    const size_t j = (size_t) f->cells.order[begin + (long) i];
    which[i] = (int) i;
    w[i] = 1.0;
    a[i] = s->a[j];
    memcpy(x + 3 * i, s->x + 3 * j, 3 * sizeof(double));
    memcpy(F + m * i, s->F + 3 * j, 3 * sizeof(double));
    if (m == 6) memcpy(F + m * i + 3, s->T + 3 * j, 3 * sizeof(double));
  }
  if (status == SD_OK) status = sd_ewald_waves_find(&f->waves, &ours, which, (int) n, brick);
  if (status == SD_OK) status = sd_ewald_waves_place_whole(&f->waves);
  status = sd_world_agree(world, status);
  if (status == SD_OK) status = sd_ewald_waves_convolve(&f->waves, &ours, F, u);
  free(which);
  return status;
}

/* What is beyond the range is felt as a mean; a point has b = 0. */
static void mean_of(const sd_field *f, const sd_field_sources *s, double *mean)
{
  for (int d = 0; d < 3; d++) mean[d] = 0.0;
  if (!f->ewald.box.periodic) return;
  const double over_V = 1.0 / sd_ewald_volume(&f->ewald.box);
  for (long i = 0; i < s->n; i++)
    for (int d = 0; d < 3; d++)
      mean[d] += over_V * (f->tail[0] - sd_ewald_b(&f->ewald, s->a[i]) * f->tail[1]) * s->F[3 * i + d];
}

static int sound(const sd_field_sources *s)
{
  double sum = 0.0;
  for (long i = 0; i < s->n; i++) {
    sum += s->a[i];
    for (int d = 0; d < 3; d++)
      sum += s->x[3 * i + d] + s->F[3 * i + d] + (s->T ? s->T[3 * i + d] : 0.0);
  }
  return isfinite(sum);
}

/* Which sum, and its splitting in e */
static sd_status decide(sd_field *f, sd_field_sum how, const sd_ewald_box *box, double tolerance,
                        const sd_field_sources *s, const sd_field_grid *g, int *split, sd_ewald *e)
{
  *split = box->periodic || how != SD_FIELD_DIRECT;
  if (!*split) return SD_OK;
  sd_ewald_box open = f->around;
  if (!box->periodic) box_around(&open, s, g);
  const sd_status status = choose(box->periodic ? box : &open, s, g, tolerance, e);
  if (box->periodic || how == SD_FIELD_SPLIT) {
    f->around = open;
    return status;
  }
  *split = status == SD_OK && cost_of_split(e, s, g) < s->n * all_points(g);
  if (*split) f->around = open;
  return SD_OK;
}

sd_status sd_field_add(sd_field *f, sd_field_sum how, const sd_ewald_box *box, double tolerance,
                       const sd_field_sources *s, const sd_field_grid *g, const sd_world *world,
                       double *u)
{
  if (s->n == 0) return SD_OK;
  if (!sound(s)) return SD_ENOTFINITE;
  sd_ewald e;
  int split;
  sd_status status = decide(f, how, box, tolerance, s, g, &split, &e);
  if (status != SD_OK) return status; /* the same on every rank */
  if (!sd_field_sort(&f->cells, s->x, 3, s->n, split ? e.range : 0.0)) status = SD_ENOMEMORY;
  status = sd_world_agree(world, status);
  if (status != SD_OK) return status;
  if (split) {
    status = sd_world_agree(world, make_tables(f, &e, s->T ? 6 : 3, tolerance, world));
    if (status == SD_OK) status = convolve(f, s, world);
    if (status != SD_OK) return status;
  }
  const double scale = scale_of(s, g);
  sd_field_part p = part_of(s, g, scale, u);
  listing l = {.f = f, .scale = scale};
  if (!list_sources(&l, box, split, split ? e.range : 0.0, s, g)) return SD_ENOMEMORY;
  p.n = l.n;
  p.source = f->source;
  const struct sd_field_kernels *kernels = SD_KERNELS_OF(sd_field, plain, sd_isa_of(SD_ISA_BEST));
  if (!split) {
    kernels->direct(&p);
    return SD_OK;
  }
  range_of(f, scale, &p);
  mean_of(f, s, p.mean);
  status = sd_field_near(f, &p, kernels);
  return status == SD_OK ? sd_field_gather(f, g, kernels, u) : status;
}
