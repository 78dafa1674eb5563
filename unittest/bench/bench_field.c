/* Time of the flow at 10^6 points of a grid around 10^5 spheres in a periodic box, in products by Ewald sums of the
 * same spheres at the same tolerance in the same run, with the error of the flow beside it.
 *   bench_field [TOLERANCE [WIDTH]] */
#define _POSIX_C_SOURCE 200809L
#include "../core/stokes/ewald/periodic.h"
#include "../core/stokes/field/around.h"
#include "cpu.h"

enum { SPHERES = 100000, EDGE = 100, RUNS = 9 };

static double flow(sd_field *f, const sd_ewald_box *box, const sd_field_sources *s, double tolerance, double *u)
{
  const double h = box->edge[0] / EDGE;
  const sd_field_grid g = {{0, 0, 0}, {h, h, h}, {EDGE, EDGE, EDGE}, 0, EDGE};
  memset(u, 0, 24 * sd_field_points(&g));
  const double t = cpu();
  if (add_flow(f, SD_FIELD_AUTO, box, tolerance, s, &g, u) != SD_OK) exit(1);
  return cpu() - t;
}

int main(int count, char **word)
{
  const double tolerance = count > 1 ? atof(word[1]) : 1e-3;
  const int m = count > 2 ? atoi(word[2]) : 3;
  const size_t n = SPHERES, points = (size_t) EDGE * EDGE * EDGE;
  double *x = malloc(24 * n), *a = malloc(8 * n), *w = malloc(8 * n), *both = malloc(48 * n), *F = malloc(24 * n),
         *T = malloc(24 * n);
  double *v = malloc(48 * n), *u = malloc(24 * points), *exact = malloc(24 * points);
  uint64_t seed = 9;
  sd_ewald_box box = {.periodic = 1};
  for (int d = 0; d < 3; d++) box.edge[d] = cbrt(n * 4.0 / 3.0 * SD_PI / 0.2);
  for (size_t i = 0; i < n; i++) {
    a[i] = w[i] = 1.0;
    for (int d = 0; d < 3; d++) {
      x[3 * i + d] = uniform(&seed, 0, box.edge[0]);
      F[3 * i + d] = both[(size_t) m * i + (size_t) d] = uniform(&seed, -1, 1);
      T[3 * i + d] = uniform(&seed, -1, 1);
      if (m == 6) both[6 * i + 3 + (size_t) d] = T[3 * i + d];
    }
  }
  const sd_ewald how = periodic_choose(&box, a, (int) n, m, tolerance);
  periodic p;
  periodic_place(&p, x, a, w, (int) n, m, &how);
  const sd_field_sources s = {(int) n, x, a, F, m == 6 ? T : NULL};
  sd_field f = {0}, fine = {0};
  double product = 1e9, field = 1e9, off = 0.0, all = 0.0;
  const double first = flow(&f, &box, &s, tolerance, u);
  for (int k = 0; k < RUNS; k++) { /* by turns, so that a loaded machine slows both */
    const double t = cpu();
    if (sd_mobility_apply(&p.omega, both, v) != SD_OK) exit(1);
    product = fmin(product, cpu() - t);
    field = fmin(field, flow(&f, &box, &s, tolerance, u));
  }
  printf("product: range %.1f grid %d P %d\n", how.range, how.grid[0], how.points);
  printf("field: range %.1f grid %d P %d degree %d\n", f.ewald.range, f.ewald.grid[0], f.ewald.points, f.degree);
  flow(&fine, &box, &s, 0.01 * tolerance, exact);
  periodic_free(&p);
  sd_field_free(&f);
  sd_field_free(&fine);
  for (size_t k = 0; k < 3 * points; k++) off += pow(u[k] - exact[k], 2) / points;
  for (size_t k = 0; k < 3 * n; k++) all += pow(F[k] / (6 * SD_PI), 2) / n;
  printf("tolerance %.0e, error %.1e: product %.4f s, flow at 1e6 points %.4f s (the first %.2f s): %.2f products\n",
         tolerance, sqrt(off / all), product, field, first, field / product);
  return 0;
}
