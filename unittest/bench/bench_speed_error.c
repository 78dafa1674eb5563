/* Every engine: time of a product of N equal spheres at volume fraction 0.2, and its error, the rms of velocities over
 * that of F/(6 pi a), as lines
 *   engine,numbers,spheres,tolerance,seconds,error
 * for speed_error.py.
 *   bench_speed_error N
 * Open sums and lists are compared with their pairs, of some targets, one by one; periodic sums and slits with a product
 * that is far more accurate. Processor time on one core, the least of several products. */
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

/* In a box of this height, or a cube; heights at least a radius from lower and upper face */
static scene make(int n, double height)
{
  const size_t m = (size_t) n;
  const double V = n * 4.0 / 3.0 * SD_PI / PHI, high = height > 0.0 ? height : cbrt(V), wide = sqrt(V / high);
  scene s = {n, n > 200000 ? 2 : n > 20000 ? 3 : 9, {wide, wide, high}, malloc(24 * m), malloc(8 * m), malloc(8 * m),
             malloc(24 * m), malloc(24 * m), malloc(24 * m)};
  uint64_t seed = 9;
  for (size_t i = 0; i < m; i++) {
    s.a[i] = s.w[i] = 1.0;
    for (int d = 0; d < 3; d++) {
      const double margin = d == 2 && height > 0.0;
      s.x[3 * i + (size_t) d] = uniform(&seed, margin, s.edge[d] - margin);
      s.F[3 * i + (size_t) d] = uniform(&seed, -1, 1);
    }
  }
  return s;
}

static void scene_free_all(scene *s)
{
  free(s->x), free(s->a), free(s->w), free(s->F), free(s->u), free(s->v);
}

static void tell(const scene *s, const char *engine, const char *numbers, double tolerance, double seconds,
                 double error)
{
  printf("%s,%s,%d,%g,%.6g,%.3g\n", engine, numbers, s->n, tolerance, seconds, error);
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
    if (sd_mobility_place(&omega, &sd_mobility_all_pairs, &scene) != SD_OK) exit(1);
    const double seconds = product(&omega, s);
    tell(s, "all pairs", k ? "float" : "double", tolerances[k], seconds, error(s, sample_step(s)));
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
  if (sd_mobility_place(&omega, &sd_mobility_list, &scene) != SD_OK) exit(1);
  const double seconds = product(&omega, s);
  tell(s, "list", "double", 0.0, seconds, error(s, sample_step(s)));
  sd_mobility_free(&omega);
  sd_neighbors_free(&near);
}

/* --- Ewald sums --- */

/* u of a periodic or an open box; returns the time, or 0 if floats do not do. repeat: 1 for a reference */
static double ewald(scene *s, int periodic_box, double tolerance, int single, int repeat)
{
  const sd_ewald_sizes sizes = periodic_sizes(s->a, s->n);
  const sd_ewald_box box = {.edge = {s->edge[0], s->edge[1], s->edge[2]}, .periodic = periodic_box};
  periodic p = {.n = s->n, .n_all = s->n, .width = 3};
  if (sd_ewald_choose(&box, &sizes, 3, tolerance, &p.ewald) != SD_OK) exit(1);
  if (single && !p.ewald.single) return 0.0;
  p.ewald.single = single;
  sd_mobility_scene scene = {.how = {.width = 3, .ewald = &p.ewald, .second = &p.second}, .n = s->n, .n_all = s->n,
                             .spheres = {s->x, s->a, s->w}};
  if (periodic_box) {
    periodic_images(&p, s->x, s->a, s->w);
    scene.n_all = p.n_all;
    scene.spheres = (sd_spheres){p.x, p.a, p.w};
    scene.world = (sd_world){.ctx = &p, .refresh = periodic_refresh};
  }
  if (sd_mobility_place(&p.omega, &sd_mobility_ewald, &scene) != SD_OK) exit(1);
  const int usual = s->repeat;
  s->repeat = repeat;
  const double seconds = product(&p.omega, s);
  s->repeat = usual;
  periodic_free(&p);
  return seconds;
}

static void ewald_sums(scene *s, int periodic_box, double tightest)
{
  for (double tolerance = 1e-2; tolerance > 0.9 * tightest; tolerance *= 0.1)
    for (int single = 0; single < 2; single++) {
      const double seconds = ewald(s, periodic_box, tolerance, single, s->repeat);
      if (seconds > 0.0)
        tell(s, periodic_box ? "periodic" : "open", single ? "float" : "double", tolerance, seconds,
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
    slab p;
    sd_slab how = {0};
    if (slab_choose(&walls, &box, s.x, s.a, n, tolerance, &how) != SD_OK) exit(1);
    if (slab_try(&p, &how, s.x, s.a, NULL, n) != SD_OK) exit(1);
    const double seconds = product(&p.omega, &s);
    tell(&s, "slit", "double", tolerance, seconds, error(&s, 1));
    slab_free(&p);
  }
  scene_free_all(&s);
}

int main(int count, char **words)
{
  const int n = count > 1 ? atoi(words[1]) : 1000;
  const double tightest = n > 200000 ? 1e-5 : n > 20000 ? 1e-9 : 1e-12;
  scene s = make(n, 0.0);
  list(&s);
  exact_pairs(&s, INFINITY);
  all_pairs(&s);
  ewald_sums(&s, 0, tightest);
  ewald(&s, 1, 0.1 * tightest, 0, 1);
  memcpy(s.v, s.u, sizeof(double) * 3 * (size_t) n);
  ewald_sums(&s, 1, tightest);
  scene_free_all(&s);
  slits(n, tightest);
  return 0;
}
