/* Every engine: time of a product of N equal spheres at volume fraction 0.2, and its error, the rms of velocities over
 * that of F/(6 pi a), as lines
 *   engine,numbers,spheres,tolerance,placed,seconds,error
 * for speed_error.py. Spheres do not overlap.
 *   bench_speed_error N [FILE]
 * FILE: where the scene of open and periodic boxes goes, with its velocities, for other programs, as doubles
 *   N, edge of the cube, 3N places, 3N forces, 3N velocities in an open box (of some spheres), 3N in a periodic one
 * The viscosity is 1 and radii are 1. Open sums and lists are compared with their pairs, of some targets, one by one;
 * periodic sums and slits with a product that is far more accurate. Processor time on one core, the least of several
 * products; placed: what new places cost. */
#define _POSIX_C_SOURCE 200809L
#include "../core/stokes/ewald/periodic.h"
#include "../core/stokes/slab/slab.h"
#include "cpu.h"

#include "sd_neighbor.h"

static const double PHI = 0.2;
enum { SAMPLES = 200, NEIGHBOURS = 90 };

typedef struct {
  int n, repeat;
  double edge[3], *x, *a, *w, *F, *u, *v;
} scene;

/* Cells, as cubic as the box allows, chosen at random and in random order: a sphere lies anywhere in each that leaves a
 * radius to its faces, so none overlap */
static void scatter(const scene *s, uint64_t *seed)
{
  const double spacing = cbrt(s->edge[0] * s->edge[1] * s->edge[2] / s->n);
  const int high = (int) ceil(s->edge[2] / spacing - 1e-9), wide = (int) ceil(sqrt((double) s->n / high) - 1e-9);
  const int cells[3] = {wide, wide, high}, all = wide * wide * high;
  int *cell = malloc(sizeof(int) * (size_t) all);
  for (int c = 0; c < all; c++) cell[c] = c;
  for (int i = 0; i < s->n; i++) {
    const int drawn = i + (int) uniform(seed, 0, all - i);
    int c = cell[drawn];
    cell[drawn] = cell[i];
    for (int d = 0; d < 3; d++, c /= wide) {
      const double width = s->edge[d] / cells[d], within = d < 2 ? c % wide : c;
      s->x[3 * i + d] = (within + 0.5) * width + uniform(seed, 1.0 - 0.5 * width, 0.5 * width - 1.0);
    }
  }
  free(cell);
}

/* In a box of this height, or a cube, at least a radius from its faces */
static scene make(int n, double height)
{
  const size_t m = (size_t) n;
  const double V = n * 4.0 / 3.0 * SD_PI / PHI, high = height > 0.0 ? height : cbrt(V), wide = sqrt(V / high);
  scene s = {n, n > 200000 ? 2 : n > 20000 ? 3 : 9, {wide, wide, high}, malloc(24 * m), malloc(8 * m), malloc(8 * m),
             malloc(24 * m), malloc(24 * m), malloc(24 * m)};
  uint64_t seed = 9;
  scatter(&s, &seed);
  for (size_t i = 0; i < m; i++) s.a[i] = s.w[i] = 1.0;
  for (size_t i = 0; i < 3 * m; i++) s.F[i] = uniform(&seed, -1, 1);
  return s;
}

static void scene_free_all(scene *s)
{
  free(s->x), free(s->a), free(s->w), free(s->F), free(s->u), free(s->v);
}

typedef struct {
  double placed, product;
} seconds;

static void tell(const scene *s, const char *engine, const char *numbers, double tolerance, seconds took, double error)
{
  printf("%s,%s,%d,%g,%.6g,%.6g,%.3g\n", engine, numbers, s->n, tolerance, took.placed, took.product, error);
  fflush(stdout);
}

/* Least time of a product, which goes to u */
static double product(sd_mobility *omega, const scene *s)
{
  double least = INFINITY;
  for (int k = 0; k < s->repeat; k++) {
    const double begin = cpu();
    if (sd_mobility_apply(omega, s->F, s->u) != SD_OK) exit(1);
    least = fmin(least, cpu() - begin);
  }
  return least;
}

/* Of a mobility that is new: it is placed twice, since tables and plans of transforms are made once in a run */
static seconds measure(sd_mobility *omega, const sd_mobility_engine *engine, const sd_mobility_scene *places,
                       const scene *s)
{
  double placed = 0.0;
  for (int k = 0; k < 2; k++) {
    const double begin = cpu();
    if (sd_mobility_place(omega, engine, places) != SD_OK) exit(1);
    placed = cpu() - begin;
  }
  return (seconds){placed, product(omega, s)};
}

/* u against v, of every `step`th sphere */
static double error(const scene *s, int step)
{
  double off = 0.0, bare = 0.0;
  for (int i = 0; i < s->n; i += step)
    for (int d = 0; d < 3; d++) {
      off += pow(s->u[3 * i + d] - s->v[3 * i + d], 2);
      bare += pow(s->F[3 * i + d] / (6.0 * SD_PI), 2);
    }
  return sqrt(off / bare);
}

/* --- pairs one by one --- */

static int sample_step(const scene *s)
{
  return s->n < SAMPLES ? 1 : s->n / SAMPLES;
}

/* v of some targets: of all sources up to a distance */
static void exact_pairs(const scene *s, double most)
{
  for (int i = 0; i < s->n; i += sample_step(s)) {
    long double u[3] = {0};
    for (int j = 0; j < s->n; j++) {
      double r[3], R = 0.0, f, g, along = 0.0;
      for (int d = 0; d < 3; d++) r[d] = s->x[3 * i + d] - s->x[3 * j + d];
      for (int d = 0; d < 3; d++) R += r[d] * r[d];
      R = sqrt(R);
      if (j == i || R > most) continue;
      sd_rpy_radial(R, 1.0, 1.0, &f, &g);
      for (int d = 0; d < 3; d++) along += r[d] * s->F[3 * j + d];
      for (int d = 0; d < 3; d++)
        u[d] += (long double) (f * s->F[3 * j + d] + g * along * r[d] / (R * R)) / (6.0 * SD_PI);
    }
    for (int d = 0; d < 3; d++) s->v[3 * i + d] = (double) u[d];
  }
}

static void all_pairs(const scene *s)
{
  const double tolerances[2] = {0.0, SD_PRODUCT_SINGLE};
  for (int k = 0; k < 2 && s->n <= 100000; k++) {
    const sd_mobility_scene scene = {.how = {.width = 3, .tolerance = tolerances[k]}, .n = s->n, .n_all = s->n,
                                     .spheres = {s->x, s->a, s->w}};
    sd_mobility omega = {0};
    const seconds took = measure(&omega, &sd_mobility_all_pairs, &scene, s);
    tell(s, "all pairs", k ? "float" : "double", tolerances[k], took, error(s, sample_step(s)));
    sd_mobility_free(&omega);
  }
}

static void list(const scene *s)
{
  const double cutoff = cbrt(NEIGHBOURS / PHI);
  sd_neighbors near = {0};
  if (sd_neighbors_cutoff(&near, s->x, s->n, s->n, cutoff) != SD_OK) exit(1);
  exact_pairs(s, cutoff);
  const sd_mobility_scene scene = {.how = {.width = 3}, .n = s->n, .n_all = s->n, .spheres = {s->x, s->a, s->w},
                                   .pairs = &near.pairs};
  sd_mobility omega = {0};
  const seconds took = measure(&omega, &sd_mobility_list, &scene, s);
  tell(s, "list", "double", 0.0, took, error(s, sample_step(s)));
  sd_mobility_free(&omega);
  sd_neighbors_free(&near);
}

/* --- Ewald sums --- */

/* u of a periodic or an open box; returns the time, or 0 if floats do not do. repeat: 1 for a reference */
static seconds ewald(scene *s, int periodic_box, double tolerance, int single, int repeat)
{
  const sd_ewald_sizes sizes = periodic_sizes(s->a, s->n);
  const sd_ewald_box box = {.edge = {s->edge[0], s->edge[1], s->edge[2]}, .periodic = periodic_box};
  periodic p = {.n = s->n, .n_all = s->n, .width = 3};
  if (sd_ewald_choose(&box, &sizes, 3, tolerance, &p.ewald) != SD_OK) exit(1);
  if (single && !p.ewald.single) return (seconds){0};
  p.ewald.single = single;
  sd_mobility_scene scene = {.how = {.width = 3, .ewald = &p.ewald, .second = &p.second}, .n = s->n, .n_all = s->n,
                             .spheres = {s->x, s->a, s->w}};
  if (periodic_box) {
    periodic_images(&p, s->x, s->a, s->w);
    scene.n_all = p.n_all;
    scene.spheres = (sd_spheres){p.x, p.a, p.w};
    scene.world = (sd_world){.ctx = &p, .refresh = periodic_refresh};
  }
  const int usual = s->repeat;
  s->repeat = repeat;
  const seconds took = measure(&p.omega, &sd_mobility_ewald, &scene, s);
  s->repeat = usual;
  periodic_free(&p);
  return took;
}

static void ewald_sums(scene *s, int periodic_box, double tightest)
{
  for (double tolerance = 1e-2; tolerance > 0.9 * tightest; tolerance *= 0.1)
    for (int single = 0; single < 2; single++) {
      const seconds took = ewald(s, periodic_box, tolerance, single, s->repeat);
      if (took.product > 0.0)
        tell(s, periodic_box ? "periodic" : "open", single ? "float" : "double", tolerance, took,
             error(s, periodic_box ? 1 : sample_step(s)));
    }
}

static void slits(int n, double tightest)
{
  const double height = 10.0;
  scene s = make(n, height);
  const sd_slab_walls walls = sd_slab_slit(2, 0.0, height, 0);
  const sd_ewald_box box = slab_box(2, s.edge[0], s.edge[1]);
  slab_velocities(&walls, &box, s.x, s.a, n, 0.1 * tightest, s.F, s.v);
  for (int i = 0; i < 3 * n; i++) s.v[i] -= s.F[i] / (6.0 * SD_PI);
  for (double tolerance = 1e-2; tolerance > 0.9 * tightest; tolerance *= 0.1) {
    slab p = {.n = n};
    if (slab_choose(&walls, &box, s.x, s.a, n, tolerance, &p.slab) != SD_OK) exit(1);
    slab_images(&p, s.x, s.a, NULL);
    const sd_mobility_scene scene = {.how = {.width = 3, .slab = &p.slab}, .n = n, .n_all = p.n_all,
                                     .spheres = {p.x, p.a, p.w}, .world = {.ctx = &p, .refresh = slab_refresh}};
    const seconds took = measure(&p.omega, &sd_mobility_slab, &scene, &s);
    tell(&s, "slit", "double", tolerance, took, error(&s, 1));
    slab_free(&p);
  }
  scene_free_all(&s);
}

static void write(FILE *file, const double *numbers, int count)
{
  if (file && fwrite(numbers, sizeof(double), (size_t) count, file) != (size_t) count) exit(1);
}

int main(int count, char **words)
{
  const int n = count > 1 ? atoi(words[1]) : 1000;
  const double tightest = n > 200000 ? 1e-5 : n > 20000 ? 1e-9 : 1e-12;
  FILE *file = count > 2 ? fopen(words[2], "wb") : NULL;
  scene s = make(n, 0.0);
  const double head[2] = {n, s.edge[0]};
  write(file, head, 2), write(file, s.x, 3 * n), write(file, s.F, 3 * n);
  list(&s);
  exact_pairs(&s, INFINITY);
  write(file, s.v, 3 * n);
  all_pairs(&s);
  ewald_sums(&s, 0, tightest);
  ewald(&s, 1, 0.1 * tightest, 0, 1);
  memcpy(s.v, s.u, sizeof(double) * 3 * (size_t) n);
  write(file, s.v, 3 * n);
  ewald_sums(&s, 1, tightest);
  if (file) fclose(file);
  scene_free_all(&s);
  slits(n, tightest);
  return 0;
}
