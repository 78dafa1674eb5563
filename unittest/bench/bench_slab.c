/* Time of products above a floor and between two walls in boxes periodic along them, over that of the periodic product
 * of as many spheres in the same run, with the error of the answer beside it.
 *   bench_slab [ROW ...]      rows: names of the table below; none: all
 * In the environment SPHERES: how many; DIGITS: of the tolerance; PRODUCTS: so many of each and no error,
 * for a profiler. */
#define _POSIX_C_SOURCE 200809L
#include "../core/stokes/ewald/periodic.h"
#include "../core/stokes/slab/slab.h"
#include "cpu.h"

/* Height of the slit, 0: a floor; of the highest sphere above it, where they lie on it with a fraction of the area;
 * radius; volume fraction */
typedef struct {
  const char *name;
  double slit, highest, radius, phi, area;
} row;

/* Radius of the points, twelve for each sphere of radius 1 that has the volume fraction */
static const double POINT = 0.56;

static int from_environment(const char *name, int else_)
{
  return getenv(name) ? atoi(getenv(name)) : else_;
}

static const row rows[] = {
    {.name = "cube", .radius = 1.0, .phi = 0.2},
    {.name = "layer", .highest = 1.3, .radius = 1.0, .area = 0.4},
    {.name = "slit-10", .slit = 10.0, .radius = 1.0, .phi = 0.2},
    {.name = "points-10", .slit = 10.0, .radius = 0.56, .phi = 0.2},
    {.name = "points-4", .slit = 4.0, .radius = 0.56, .phi = 0.2},
    {.name = "points-2.5", .slit = 2.5, .radius = 0.56, .phi = 0.2},
};
enum { ROWS = sizeof(rows) / sizeof(rows[0]) };

typedef struct {
  int n;
  double *x, *a, *w, *F, *u, *v;
} scene;

static scene make(int n, double radius, const double *edge, double lo, double hi)
{
  const size_t m = (size_t) n;
  scene s = {n, malloc(24 * m), malloc(8 * m), malloc(8 * m), malloc(24 * m), malloc(24 * m), malloc(24 * m)};
  uint64_t seed = 9;
  for (size_t i = 0; i < m; i++) {
    s.a[i] = radius;
    s.w[i] = 1.0;
    s.x[3 * i] = uniform(&seed, 0, edge[0]);
    s.x[3 * i + 1] = uniform(&seed, 0, edge[1]);
    s.x[3 * i + 2] = uniform(&seed, lo, hi);
    for (int d = 0; d < 3; d++) s.F[3 * i + d] = uniform(&seed, -1, 1);
  }
  return s;
}

static void scene_free_all(scene *s)
{
  free(s->x), free(s->a), free(s->w), free(s->F), free(s->u), free(s->v);
}

/* Least time of a product */
static double least(sd_mobility *omega, const scene *s, double *u)
{
  double time = 1e9;
  for (int k = 0; k < from_environment("PRODUCTS", 7); k++) {
    const double t = cpu();
    if (sd_mobility_apply(omega, s->F, u) != SD_OK) exit(1);
    time = fmin(time, cpu() - t);
  }
  return time;
}

static double periodic_time(int n, double tolerance)
{
  const double edge = cbrt(n * 4.0 / 3.0 * SD_PI / 0.2), edges[2] = {edge, edge};
  const sd_ewald_box box = {.edge = {edge, edge, edge}, .periodic = 1};
  scene s = make(n, 1.0, edges, 0.0, edge);
  sd_ewald_sizes sizes = periodic_sizes(s.a, n);
  periodic p = {.n = n, .width = 3};
  if (sd_ewald_levels_choose(&box, &sizes, 3, tolerance, &p.ewald, &p.second) != SD_OK) exit(1);
  periodic_images(&p, s.x, s.a, s.w);
  const sd_mobility_scene scene = {.how = {.law = {.tensor = SD_TENSOR_RPY}, .width = 3, .ewald = &p.ewald,
                                           .second = &p.second},
                                   .n = n,
                                   .n_all = p.n_all,
                                   .spheres = {p.x, p.a, p.w},
                                   .world = {.ctx = &p, .refresh = periodic_refresh}};
  if (sd_mobility_place(&p.omega, periodic_engine(&p.second), &scene) != SD_OK) exit(1);
  const double time = least(&p.omega, &s, s.u);
  periodic_free(&p);
  scene_free_all(&s);
  return time;
}

static void slab_time(const row *r, int n, double tolerance, double periodic)
{
  const double V = n * (r->radius == POINT ? 4.0 / 3.0 * SD_PI / 12.0 : 4.0 / 3.0 * SD_PI) /
      (r->phi > 0.0 ? r->phi : 1.0);
  const double height = r->slit > 0.0 ? r->slit : cbrt(V);
  const double edge = r->area > 0.0 ? sqrt(n * SD_PI / r->area) : sqrt(V / height), edges[2] = {edge, edge};
  const sd_wall ground = {2, 1, 0.0};
  const sd_slab_walls walls = r->slit > 0.0 ? sd_slab_slit(2, 0.0, r->slit, 0) : sd_slab_floor(&ground);
  const sd_ewald_box box = slab_box(2, edge, edge);
  const double hi = r->area > 0.0 ? r->highest : r->slit > 0.0 ? r->slit - r->radius : height;
  scene s = make(n, r->radius, edges, r->radius, hi);
  double off = 0.0, all = 0.0;
  slab omega;
  sd_slab how = {0};
  if (slab_choose(&walls, &box, s.x, s.a, n, tolerance, &how) != SD_OK) exit(1);
  if (slab_try(&omega, &how, s.x, s.a, NULL, n) != SD_OK) exit(1);
  const sd_mobility_scene again = {.how = {.law = {.tensor = SD_TENSOR_RPY}, .width = 3, .slab = &omega.slab},
                                   .n = n,
                                   .n_all = omega.n_all,
                                   .spheres = {omega.x, omega.a, omega.w},
                                   .world = {.ctx = &omega, .refresh = slab_refresh}};
  double place = cpu();
  if (sd_mobility_place(&omega.omega, &sd_mobility_slab, &again) != SD_OK) exit(1);
  place = cpu() - place;
  const double time = least(&omega.omega, &s, s.u);
  slab_free(&omega);
  if (!getenv("PRODUCTS")) slab_velocities(&walls, &box, s.x, s.a, n, 0.01 * tolerance, s.F, s.v);
  for (int i = 0; i < 3 * n && !getenv("PRODUCTS"); i++) {
    const double bare = s.F[i] / (6.0 * SD_PI * r->radius);
    const double u = s.u[i] + bare;
    off += (u - s.v[i]) * (u - s.v[i]);
    all += bare * bare;
  }
  printf("%-11s %.0e: %.2f periodic products (%.4f s), error %.1e; places %.3f s; range %.2f, images %.2f, grid %d x "
         "%d x %d, "
         "planes %d, P %d\n",
         r->name, tolerance, time / periodic, time, sqrt(off / all), place, how.ewald.range, how.ewald.images.range,
         how.ewald.grid[0], how.ewald.grid[1], how.ewald.grid[2], how.ewald.slab.planes, how.ewald.points);
  fflush(stdout);
  scene_free_all(&s);
}

int main(int count, char **names)
{
  const int n = from_environment("SPHERES", 100000);
  const int only = from_environment("DIGITS", 0);
  for (int digits = only ? only : 3; digits <= (only ? only : 6); digits += 3) {
    const double tolerance = pow(10.0, -digits), periodic = periodic_time(n, tolerance);
    printf("periodic    %.0e: %.4f s\n", tolerance, periodic);
    for (int k = 0; k < ROWS; k++) {
      int wanted = count == 1;
      for (int j = 1; j < count; j++) wanted = wanted || !strcmp(names[j], rows[k].name);
      if (wanted) slab_time(rows + k, n, tolerance, periodic);
    }
  }
  return 0;
}
