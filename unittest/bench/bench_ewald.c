/* Time of products by Ewald sums in units of T4, the product of all pairs of 10^4 spheres in the same run, with the
 * error of the answer beside it.
 *   bench_ewald [ROW ...]      rows: names of the table below; none: all but those of 10^6 and 10^7 */
#define _POSIX_C_SOURCE 200809L
#include "../core/stokes/ewald/periodic.h"
#include "cpu.h"

#include <sys/resource.h>

enum { RUNS = 5 };

typedef struct {
  const char *name;
  int n, periodic, width;
  double largest, phi, tolerance;
  /* 0: radii evenly in the logarithm; so many of the largest, the others 1; -1: each octave with the same volume */
  int few;
  /* above a plane wall, one radius below the lowest centre */
  int wall;
} row;

static const row rows[] = {
    {"periodic", 100000, 1, 3, 1.0, 0.2, 1e-3, 0, 0},
    {"periodic-6", 100000, 1, 3, 1.0, 0.2, 1e-6, 0, 0},
    {"unequal", 100000, 1, 3, 3.0, 0.2, 1e-3, 0, 0},
    {"unequal-6", 100000, 1, 3, 3.0, 0.2, 1e-6, 0, 0},
    {"eighth-5", 100000, 1, 3, 3.0, 0.2, 1e-5, 12500, 0},
    {"eighth-6", 100000, 1, 3, 3.0, 0.2, 1e-6, 12500, 0},
    {"eighth-8", 100000, 1, 3, 3.0, 0.2, 1e-8, 12500, 0},
    {"eighth-dense-6", 100000, 1, 3, 3.0, 0.5, 1e-6, 12500, 0},
    {"torques", 100000, 1, 6, 1.0, 0.2, 1e-3, 0, 0},
    {"torques-6", 100000, 1, 6, 1.0, 0.2, 1e-6, 0, 0},
    {"open-3", 100000, 0, 3, 1.0, 0.2, 1e-3, 0, 0},
    {"open", 100000, 0, 3, 1.0, 0.2, 3e-7, 0, 0},
    {"wall-3", 100000, 0, 3, 1.0, 0.2, 1e-3, 0, 1},
    {"wall", 100000, 0, 3, 1.0, 0.2, 3e-7, 0, 1},
    {"small", 10000, 1, 3, 1.0, 0.2, 1e-3, 0, 0},
    {"million", 1000000, 1, 3, 1.0, 0.2, 1e-3, 0, 0},
    {"ten-million", 10000000, 1, 3, 1.0, 0.2, 1e-3, 0, 0},
    {"few-10", 100000, 1, 3, 10.0, 0.2, 1e-3, 100, 0},
    {"few-10-6", 100000, 1, 3, 10.0, 0.2, 1e-6, 100, 0},
    {"few-30", 100000, 1, 3, 30.0, 0.2, 1e-3, 4, 0},
    {"three-thousand", 3000, 1, 3, 30.0, 0.2, 1e-3, 2, 0},
    {"three-thousand-6", 3000, 1, 3, 30.0, 0.2, 1e-6, 2, 0},
    {"few-30-6", 100000, 1, 3, 30.0, 0.2, 1e-6, 4, 0},
    {"all-100", 100000, 1, 3, 100.0, 0.2, 1e-3, -1, 0},
    {"all-100-6", 100000, 1, 3, 100.0, 0.2, 1e-6, -1, 0},
};
enum { ROWS = sizeof(rows) / sizeof(rows[0]) };

/* Median of all pairs of 10^4 */
static double all_pairs(void)
{
  enum { N = 10000 };
  static double x[3 * N], a[N], w[N], F[3 * N], u[3 * N];
  uint64_t seed = 4;
  for (int i = 0; i < 3 * N; i++) x[i] = uniform(&seed, 0, 50), F[i] = uniform(&seed, -1, 1);
  for (int i = 0; i < N; i++) a[i] = w[i] = 1.0;
  const sd_mobility_scene s = {
      .how = {.law = {.tensor = SD_TENSOR_RPY}, .width = 3},
                               .n = N, .n_all = N, .spheres = {x, a, w}};
  sd_mobility m = {0};
  if (sd_mobility_place(&m, &sd_mobility_all_pairs, &s) != SD_OK) exit(1);
  double best = 1e9;
  for (int k = 0; k < 7; k++) {
    const double t = cpu();
    sd_mobility_apply(&m, F, u);
    best = fmin(best, cpu() - t);
  }
  sd_mobility_free(&m);
  return best;
}

typedef struct {
  sd_ewald_box box;
  double *x, *a, *F;
} scene;

/* Product at a tolerance; place and apply times, best of RUNS. STOKESDYN_ONE_LEVEL: never two */
static void product(const row *r, const scene *of, double tolerance, double *u, double *times, sd_ewald *how)
{
  const double *x = of->x, *a = of->a, *F = of->F;
  const sd_ewald_box *box = &of->box;
  double *w = malloc(sizeof(double) * (size_t) r->n);
  for (int i = 0; i < r->n; i++) w[i] = 1.0;
  sd_ewald_sizes sizes = periodic_sizes(a, r->n);
  if (getenv("STOKESDYN_ONE_LEVEL")) memset(sizes.octave, 0, sizeof(sizes.octave));
  const sd_wall wall = {2, 1, -1.0};
  sd_ewald_level second = {0};
  const sd_status chosen = r->wall
      ? sd_ewald_choose_at_wall(box, &wall, &sizes, tolerance, how)
      : sd_ewald_levels_choose(box, &sizes, r->width, tolerance, how, &second);
  if (chosen != SD_OK) exit(1);
  periodic p = {.n = r->n, .width = r->width, .ewald = *how, .second = second};
  sd_mobility_scene s = {
      .how = {.law = {.tensor = SD_TENSOR_RPY}, .width = r->width, .ewald = &p.ewald, .second = &p.second},
                         .n = r->n, .n_all = r->n, .spheres = {x, a, w}};
  if (r->periodic) {
    periodic_images(&p, x, a, w);
    s.n_all = p.n_all;
    s.spheres = (sd_spheres){p.x, p.a, p.w};
    s.world = (sd_world){.ctx = &p, .refresh = periodic_refresh};
  }
  times[0] = times[1] = times[2] = 1e9;
  for (int k = 0; k < RUNS; k++) {
    double t = cpu();
    if (sd_mobility_place(&p.omega, periodic_engine(&second), &s) != SD_OK) exit(1);
    if (k == 0) times[2] = cpu() - t;
    else times[0] = fmin(times[0], cpu() - t);
    t = cpu();
    if (sd_mobility_apply(&p.omega, F, u) != SD_OK) exit(1);
    times[1] = fmin(times[1], cpu() - t);
  }
  periodic_free(&p);
  free(w);
}

static void measure(const row *r)
{
  uint64_t seed = 9;
  const size_t n = (size_t) r->n;
  double *x = malloc(24 * n), *a = malloc(8 * n), *F = malloc(8 * n * (size_t) r->width), V = 0.0;
  double *u = malloc(8 * n * (size_t) r->width), *v = malloc(8 * n * (size_t) r->width);
  for (size_t i = 0; i < n; i++) {
    if (r->few > 0) a[i] = i < (size_t) r->few ? r->largest : 1.0;
    else if (r->few < 0) a[i] = cbrt(1.0 / (1.0 - uniform(&seed, 0, 1) * (1.0 - pow(r->largest, -3))));
    else a[i] = r->largest == 1.0 ? 1.0 : exp(uniform(&seed, 0, log(r->largest)));
    V += 4.0 / 3.0 * SD_PI * pow(a[i], 3);
  }
  sd_ewald_box box = {.periodic = r->periodic};
  for (int d = 0; d < 3; d++) box.edge[d] = cbrt(V / r->phi);
  for (size_t i = 0; i < 3 * n; i++) x[i] = uniform(&seed, 0, box.edge[0]);
  for (size_t i = 0; i < n; i++)
    for (int d = 0; d < r->width; d++) F[r->width * i + d] = uniform(&seed, -1, 1) * pow(a[i], d < 3 ? 1 : 2);
  double times[3], reference[3], off = 0.0, all = 0.0, T4 = all_pairs();
  sd_ewald how, tight;
  const scene cloud = {box, x, a, F};
  product(r, &cloud, r->tolerance, u, times, &how);
  T4 = fmin(T4, all_pairs());
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  product(r, &cloud, (r->n > 100000 ? 0.1 : 0.01) * r->tolerance, v, reference, &tight);
  for (size_t i = 0; i < n; i++)
    for (int d = 0; d < 3; d++) {
      off += pow(u[r->width * i + d] - v[r->width * i + d], 2);
      all += pow(F[r->width * i + d] / (6 * SD_PI * a[i]), 2);
    }
  printf("%-11s N %8d tolerance %.0e error %.1e: %6.2f T4 (%.4f s, T4 %.4f s); places %.4f s, tables %.2f s; range "
         "%.1f grid %d P %d; %.0f MB\n",
         r->name, r->n, r->tolerance, sqrt(off / all), times[1] / T4, times[1], T4, times[0], times[2] - times[0],
         how.range, how.grid[0], how.points, usage.ru_maxrss / 1024.0);
  fflush(stdout);
  free(x), free(a), free(F), free(u), free(v);
}

int main(int count, char **names)
{
  for (int k = 0; k < ROWS; k++) {
    int wanted = count == 1 && rows[k].n <= 100000;
    for (int j = 1; j < count; j++) wanted = wanted || !strcmp(names[j], rows[k].name);
    if (wanted) measure(rows + k);
  }
  return 0;
}
