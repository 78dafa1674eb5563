/* Random scenes of every kind, and the error of a product by Ewald sums in them, over the tolerance that was
 * asked for.
 *
 * Volume fractions 0.001 to 0.6, radii 1 : 1 to 1 : 100 (slabs 1 : 10), forces alone or with torques. Forces
 * are random, or weights: all along x (of a layer, which they would shear, across it) and as large as a^3.
 * Compared with all pairs where the box is open, else with a sum whose tolerance is a fiftieth. Shells have
 * twelve points; forces on these are random for each point, or the same for all of one sphere: then U is the
 * mean of their velocities, F the sum of their forces and a = 1, and the sum over points is asked for
 * sd_multiblob_looser times the tolerance. */
#ifndef RANDOM_SCENE_H
#define RANDOM_SCENE_H

#include "ewald/periodic.h"
#include "plain.h"
#include "slab/slab.h"

#include "sd_multiblob.h"

typedef enum { EQUAL, MANY_SIZES, TWO_SIZES, FEW_LARGE, SHELLS, KINDS } kind;
typedef enum { CUBE, OBLONG, OBLIQUE, OPEN, ABOVE_WALL, LAYER, FLOOR, SLIT, PLACES } place;
static const char *const kinds[] = {"equal", "many sizes", "two sizes", "few large", "shells"};
static const char *const places[] = {"cube", "oblong", "oblique", "open", "wall", "layer", "floor", "slit"};
/* Where the spheres stand in it: evenly, in clusters that overlap, or on one plane across a random axis */
typedef enum { EVEN, CLUSTERS, PLANE, SPREADS } spread;
static const char *const spreads[] = {"even", "clusters", "plane"};

typedef struct {
  int n, width, floats, levels;
  kind kind;
  place place;
  spread spread;
  double ratio, phi, tolerance;
  double *x, *a, *w, *F[3], *u, *v;
  sd_multiblob shell;
  sd_ewald_box box;
} scene;

static inline double log_uniform(uint64_t *seed, double lo, double hi)
{
  return exp(uniform(seed, log(lo), log(hi)));
}

static inline void draw_radii(scene *s, uint64_t *seed)
{
  const double share = uniform(seed, 0.05, 0.9);
  const int few = 1 + (int) uniform(seed, 0, 0.02 * s->n);
  for (int i = 0; i < s->n; i++)
    s->a[i] = s->kind == MANY_SIZES ? log_uniform(seed, 1.0, s->ratio)
        : s->kind == TWO_SIZES   ? (i < share * s->n ? s->ratio : 1.0)
        : s->kind == FEW_LARGE   ? (i < few ? s->ratio : 1.0)
        : s->kind == SHELLS      ? s->shell.point
                                 : 1.0;
}

/* Edges for the volume fraction, with the shape of the place */
static inline void draw_box(scene *s, uint64_t *seed)
{
  const int oblong = s->place != CUBE;
  double V = 0.0, shape[3] = {1, 1, 1};
  for (int i = 0; i < s->n; i++)
    V += 4.0 / 3.0 * SD_PI * (s->kind == SHELLS ? 1.0 / 12 : pow(s->a[i], 3)) / s->phi;
  for (int d = 0; d < 3 && oblong; d++) shape[d] = log_uniform(seed, 0.5, 2.0);
  const double unit = cbrt(V / (shape[0] * shape[1] * shape[2]));
  s->box.periodic = s->place != OPEN && s->place != ABOVE_WALL;
  for (int d = 0; d < 3; d++) s->box.edge[d] = shape[d] * unit;
  if (s->place == SLIT) s->box.edge[2] = fmax(s->box.edge[2], 2.0 * s->ratio); /* the largest fit into it */
  for (int d = 0; d < 3 && s->place == OBLIQUE; d++)
    s->box.tilt[d] = uniform(seed, -0.5, 0.5) * s->box.edge[d > 1];
}

/* To the place of one of the first spheres, and a few radii beside it; or onto the plane */
static inline void gather(const scene *s, int sphere, uint64_t *seed, double c[3])
{
  const int together = s->kind == SHELLS ? s->shell.n : 1, clusters = 1 + s->n / together / 20;
  if (s->spread == CLUSTERS && sphere >= clusters) {
    const double *near = s->x + 3L * together * (int) uniform(seed, 0, clusters), most = 4.0 * s->ratio;
    for (int d = 0; d < 3; d++) c[d] = near[d] + uniform(seed, -1, 1) * fmin(most, 0.5 * s->box.edge[d]);
    if (s->place >= ABOVE_WALL) c[2] = fmin(fmax(c[2], 0.0), s->box.edge[2]);
  }
  if (s->spread == PLANE) c[s->n / 12 % 3] = 0.4 * s->box.edge[s->n / 12 % 3];
}

static inline void draw_places(scene *s, uint64_t *seed)
{
  const int together = s->kind == SHELLS ? s->shell.n : 1;
  for (int i = 0; i < s->n; i += together) {
    double c[3];
    for (int d = 0; d < 3; d++) c[d] = uniform(seed, 0, 1) * s->box.edge[d];
    gather(s, i / together, seed, c);
    for (int k = 0; k < 3 * together; k++) s->x[3 * i + k] = c[k % 3] + (together > 1 ? s->shell.r[k] : 0.0);
  }
  /* walls are at 0 and at the edge */
  for (int i = 0; i < s->n && s->place >= ABOVE_WALL; i++) {
    double *z = s->x + 3 * i + 2;
    *z = fmax(*z, s->a[i]);
    if (s->place == SLIT) *z = fmin(*z, s->box.edge[2] - s->a[i]);
  }
}

static inline void draw_forces(scene *s, uint64_t *seed)
{
  for (int i = 0; i < s->n; i++) s->w[i] = 1.0;
  for (int i = 0; i < s->n * s->width; i++) {
    const int d = i % s->width;
    const double a = s->a[i / s->width];
    s->F[0][i] = uniform(seed, -1, 1) * (d < 3 ? a : a * a);
    s->F[1][i] = d == (s->place == LAYER ? 2 : 0) ? a * a * a : 0.0;
    s->F[2][i] = s->F[0][i - i / s->width % s->shell.n * s->width]; /* of the first point of its sphere */
  }
  if (s->place == LAYER) /* forces along it add up to 0 */
    for (int l = 0; l < 3; l++)
      for (int d = 0; d < 2; d++) {
        double sum = 0.0;
        for (int i = 0; i < s->n; i++) sum += s->F[l][3 * i + d];
        for (int i = 0; i < s->n; i++) s->F[l][3 * i + d] -= sum / s->n;
      }
}

/* What is wanted; kind, place or spread -1: any */
typedef struct {
  int most, kind, place, spread;
  double loosest, tightest;
} wish;

/* Number k of those of a seed */
static inline scene random_scene(uint64_t from, int k, const wish *w)
{
  uint64_t mixed = (from << 32) + (uint64_t) k, *const seed = &mixed;
  for (int warm = 0; warm < 20; warm++) mixed = (mixed ^ (mixed >> 31)) * 0x9e3779b97f4a7c15u;
  scene s = {.ratio = 1.0};
  s.phi = log_uniform(seed, 1e-3, 0.6);
  s.tolerance = pow(10.0, -uniform(seed, w->loosest, w->tightest));
  const double place_drawn = uniform(seed, 0, PLACES), kind_drawn = uniform(seed, 0, KINDS);
  s.place = w->place < 0 ? (place) place_drawn : (place) w->place;
  s.kind = w->kind < 0 ? (kind) kind_drawn : (kind) w->kind;
  s.n = 12 * (int) (log_uniform(seed, 60, w->most) / 12);
  s.width = uniform(seed, 0, 1) < 0.4 && s.place < ABOVE_WALL ? 6 : 3;
  if (s.kind != EQUAL && s.kind != SHELLS) s.ratio = log_uniform(seed, 1.1, s.place >= LAYER ? 10.0 : 100.0);
  s.spread = w->spread < 0 ? (spread) uniform(seed, 0, SPREADS) : (spread) w->spread;
  const size_t n = (size_t) s.n;
  double **const rows[] = {&s.x, &s.F[0], &s.F[1], &s.F[2], &s.u, &s.v};
  for (int k = 0; k < 6; k++) *rows[k] = malloc(sizeof(double) * 6 * n);
  s.a = malloc(sizeof(double) * n), s.w = malloc(sizeof(double) * n);
  assert_int_equal(sd_multiblob_create(12, 0, &s.shell), SD_OK);
  draw_radii(&s, seed);
  draw_box(&s, seed);
  draw_places(&s, seed);
  draw_forces(&s, seed);
  return s;
}

static inline void scene_release(scene *s)
{
  free(s->x), free(s->a), free(s->w), free(s->F[0]), free(s->F[1]), free(s->F[2]), free(s->u), free(s->v);
}

static inline sd_slab_walls walls_of(const scene *s)
{
  const sd_wall ground = {2, 1, 0.0};
  if (s->place == LAYER) return sd_slab_layer(2);
  return s->place == FLOOR ? sd_slab_floor(&ground) : sd_slab_slit(2, 0.0, s->box.edge[2], 0);
}

static inline void in_slab(scene *s, double tolerance, const double *F, double *u)
{
  const sd_slab_walls walls = walls_of(s);
  const sd_ewald_box box = slab_box(2, s->box.edge[0], s->box.edge[1]);
  slab_velocities(&walls, &box, s->x, s->a, s->n, tolerance, F, u);
}

static inline void in_periodic_box(scene *s, double tolerance, const double *F, double *u)
{
  const sd_ewald_sizes sizes = periodic_sizes(s->a, s->n);
  periodic p;
  sd_ewald how;
  sd_ewald_level second;
  assert_int_equal(sd_ewald_levels_choose(&s->box, &sizes, s->width, tolerance, &how, &second), SD_OK);
  periodic_place_levels(&p, s->x, s->a, NULL, s->n, s->width, &how, &second);
  periodic_apply(&p, F, u);
  periodic_free(&p);
  s->floats = how.single;
  s->levels = second.from > 0.0 ? 2 : 1;
}

static inline void in_open_box(scene *s, double tolerance, const double *F, double *u)
{
  const sd_ewald_sizes sizes = periodic_sizes(s->a, s->n);
  const sd_wall wall = {2, 1, 0.0};
  sd_ewald_box box = {0};
  sd_ewald how;
  sd_ewald_level second = {0};
  sd_mobility m = {0};
  double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (int i = 0; i < 3 * s->n; i++)
    lo[i % 3] = fmin(lo[i % 3], s->x[i]), hi[i % 3] = fmax(hi[i % 3], s->x[i]);
  sd_ewald_box_around(&box, s->place == OPEN ? -1 : 2, lo, hi, sizes.all.largest);
  if (s->place == OPEN)
    assert_int_equal(sd_ewald_levels_choose(&box, &sizes, s->width, tolerance, &how, &second), SD_OK);
  else
    assert_int_equal(sd_ewald_choose_at_wall(&box, &wall, &sizes, tolerance, &how), SD_OK);
  const sd_mobility_scene scene = {
      .how = {.law = {.tensor = SD_TENSOR_RPY}, .width = s->width, .ewald = &how, .second = &second},
      .n = s->n, .n_all = s->n, .spheres = {s->x, s->a, s->w}};
  assert_int_equal(sd_mobility_place(&m, periodic_engine(&second), &scene), SD_OK);
  assert_int_equal(sd_mobility_apply(&m, F, u), SD_OK);
  sd_mobility_free(&m);
  s->floats = how.single;
  s->levels = second.from > 0.0 ? 2 : 1;
}

/* By Ewald sums of the rule */
static inline void by_rule(scene *s, double tolerance, const double *F, double *u)
{
  (s->place >= LAYER ? in_slab : s->place >= OPEN ? in_open_box : in_periodic_box)(s, tolerance, F, u);
}

static inline void exact(const scene *s, const double *F, double *u)
{
  const sd_law law = {.tensor = SD_TENSOR_RPY, .wall = {2, s->place == ABOVE_WALL, 0.0}};
  const sd_mobility_scene scene = {.how = {.law = law, .width = s->width}, .n = s->n, .n_all = s->n,
                                   .spheres = {s->x, s->a, s->w}};
  sd_mobility m = {0};
  assert_int_equal(sd_mobility_place(&m, &sd_mobility_all_pairs, &scene), SD_OK);
  assert_int_equal(sd_mobility_apply(&m, F, u), SD_OK);
  sd_mobility_free(&m);
}

/* U in error[0], W in error[1], over the tolerance; flow: rms of U over that of F/(6 pi a) */
static inline void errors(const scene *s, const double *F, double *error, double *flow)
{
  double off[2] = {0}, bare[2] = {0}, moved = 0.0;
  for (int i = 0; i < s->n * s->width; i++) {
    const int spin = i % s->width >= 3;
    const double a = s->a[i / s->width], length = spin ? a : 1.0;
    off[spin] += pow(length * (s->u[i] - s->v[i]), 2);
    bare[spin] += pow(length * F[i] / (spin ? 8.0 * SD_PI * a * a * a : 6.0 * SD_PI * a), 2);
    if (!spin) moved += pow(s->v[i], 2);
  }
  for (int spin = 0; spin < 2; spin++)
    error[spin] = off[spin] > 0.0 ? sqrt(off[spin] / bare[spin]) / s->tolerance : 0.0;
  *flow = sqrt(moved / bare[0]);
}

/* u by a sum to this tolerance, and v exactly */
static inline void both(scene *s, double tolerance, const double *F)
{
  if (s->place == OPEN || s->place == ABOVE_WALL)
    exact(s, F, s->v);
  else
    by_rule(s, fmax(0.02 * s->tolerance, 1e-13), F, s->v);
  by_rule(s, tolerance, F, s->u);
}

/* Of the mean velocities of spheres that are shells, over the tolerance; F is the same for all points of one
 */
static inline double error_of_spheres(scene *s, const double *F)
{
  const int n = s->shell.n;
  double off = 0.0, bare = 0.0;
  both(s, s->tolerance * sd_multiblob_looser(&s->shell), F);
  for (int i = 0; i < s->n; i += n)
    for (int d = 0; d < 3; d++) {
      double mean = 0.0;
      for (int k = i; k < i + n; k++) mean += (s->u[s->width * k + d] - s->v[s->width * k + d]) / n;
      off += mean * mean;
      bare += pow(n * F[s->width * i + d] / (6.0 * SD_PI), 2);
    }
  return sqrt(off / bare) / s->tolerance;
}

/* What is larger than 1 where a tolerance is not kept: errors of U and of W under random forces, of U under
 * weights; of shells, whose points bear random forces: last that of spheres. flow: rms of U under weights
 * over that of F/(6 pi a) */
typedef struct {
  double U, W, weights, flow, spheres;
} errors_over_tolerance;

static inline errors_over_tolerance errors_of(scene *s)
{
  errors_over_tolerance e = {0};
  double error[2][2], flow;
  for (int l = 0; l < 2; l++) {
    both(s, s->tolerance, s->F[l]);
    errors(s, s->F[l], error[l], l ? &e.flow : &flow);
  }
  e.U = error[0][0], e.W = error[0][1];
  e.weights = s->kind == SHELLS ? error_of_spheres(s, s->F[1]) : error[1][0];
  e.spheres = s->kind == SHELLS ? error_of_spheres(s, s->F[2]) : 0.0;
  return e;
}

#endif
