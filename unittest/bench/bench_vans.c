/* Cost of the stream of fix hydro/vans on one core: fluid step per slice, averages and forces per grain. Processor
 * time, median of 9 runs.
 *   build/bench_vans */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cpu.h"
#include "sd_vans.h"

enum { RUNS = 9 };

static double *array(int n)
{
  return calloc(n, sizeof(double));
}

static double fluid(int N, sd_vans_rules rules, double width, int account)
{
  double *edge = array(N + 1), *phi = array(N), *vx = array(N), *b = array(N), *length = array(N),
         *U = array(N + 1), *nut = array(N), *stress = array(N), *scratch = array(4 * N),
         *moved = array(N), *shear = array(N), times[RUNS];
  const double H = 0.06, dz = H / (N - 1), dt = 1e-4;
  for (int n = 0; n <= N; n++) edge[n] = n * dz;
  for (int n = 0; n < N; n++) {
    const double z = (n + 0.5) * dz;
    phi[n] = 0.6 / (1.0 + exp((z - 0.03) / 0.002));
    vx[n] = fmax(z - 0.03, 0.0) * 10;
    b[n] = 10 * phi[n];
    U[n + 1] = 0.02 + fmax(z - 0.03, 0.0) * 20;
  }
  const sd_vans_mesh mesh = {N, 0.0, dz, edge};
  const sd_vans_fluid f = {.rho = 1000,
                           .eta = 1e-3,
                           .gx = 0.98,
                           .turbulence = SD_VANS_LI_SAWAMOTO,
                           .kappa = 0.41,
                           .phi_max = 0.61,
                           .width = width,
                           .wall_coef = 1,
                           .radius = 0.003,
                           .rules = rules};
  const sd_vans_mixture now = {U, phi, NULL, phi};
  sd_vans_mixing_length(&mesh, &f, &now, length, scratch);
  sd_vans_solver *solver = sd_vans_solver_create(&mesh);
  const sd_vans_column column = {phi, vx, b, length, NULL};
  const sd_vans_flow flow = {U, nut, stress};
  sd_vans_books books = {moved, shear, 0, 0, 0, 0};
  const int steps = 2000000 / N;
  for (int r = -1; r < RUNS; r++) {
    const double t = cpu();
    if (sd_vans_solve(solver, &f, &column, steps, dt, &flow, account ? &books : NULL) != SD_OK)
      abort();
    if (r >= 0) times[r] = (cpu() - t) / steps / N * 1e9;
  }
  sd_vans_solver_free(solver);
  double *all[] = {edge, phi, vx, b, length, U, nut, stress, scratch, moved, shear};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) free(all[k]);
  return median(times, RUNS);
}

static void grains(double ratio, int n, int felt_by_volume, sd_drag_law drag_law, double *average, double *force)
{
  const int N = 900;
  const double a = 0.003, dz = a / ratio;
  double *edge = array(N + 1), *phi = array(N), *U = array(N + 1), *hindrance = array(N),
         *V = array(2 * N), *sums = array(N * SD_VANS_ROWS), *x = array(3 * n), *v = array(3 * n),
         *radius = array(n), *F = array(3 * n), *drag = array(n), averages[RUNS], forces[RUNS];
  for (int k = 0; k <= N; k++) edge[k] = k * dz, U[k] = 0.001 * k;
  for (int k = 0; k < N; k++) phi[k] = 0.5;
  unsigned seed = 12345;
  for (int i = 0; i < 3 * n; i++) {
    seed = seed * 1664525u + 1013904223u;
    x[i] = i % 3 == 2 ? a + (edge[N] - 2 * a) * (seed / 4294967296.0) : 0.0;
    v[i] = 0.3 * (seed / 4294967296.0);
  }
  for (int i = 0; i < n; i++) radius[i] = a;
  const sd_vans_mesh mesh = {N, 0.0, dz, edge};
  const sd_vans_force_law law = {.rho = 1000, .eta = 1e-3, .exponent = 3.1, .g = {0.5, 0, -9.8},
                                 .felt_by_volume = felt_by_volume, .drag = drag_law};
  const sd_vans_averaging how = {0, 0, NULL};
  const sd_vans_grains grains = {n, x, v, radius, NULL, NULL, NULL};
  const sd_vans_ambient stream = {&mesh, &law, U, hindrance};
  const int repeat = 400000 / n;
  for (int r = -1; r < RUNS; r++) {
    double t = cpu();
    for (int k = 0; k < repeat; k++) {
      sd_hindrance_of(drag_law, N, phi, 3.1, hindrance);
      memset(sums, 0, N * SD_VANS_ROWS * sizeof(double));
      sd_vans_average(&stream, &how, &grains, sums, V);
    }
    if (r >= 0) averages[r] = (cpu() - t) / repeat / n * 1e9;
    t = cpu();
    for (int k = 0; k < repeat; k++)
      sd_vans_forces(&stream, &grains, F, drag);
    if (r >= 0) forces[r] = (cpu() - t) / repeat / n * 1e9;
  }
  *average = median(averages, RUNS);
  *force = median(forces, RUNS);
  double *all[] = {edge, phi, U, hindrance, V, sums, x, v, radius, F, drag};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) free(all[k]);
}

int main(void)
{
  printf("fluid step, ns per slice and step        clear of walls   momentum booked   side walls "
         "(ratio)   with rules yade\n");
  static const int sizes[] = {100, 300, 900};
  for (int k = 0; k < 3; k++) {
    const int N = sizes[k];
    const double plain = fluid(N, SD_VANS_CONSISTENT, 0.0, 0),
                 booked = fluid(N, SD_VANS_CONSISTENT, 0.0, 1),
                 walls = fluid(N, SD_VANS_CONSISTENT, 0.0065, 0),
                 yade = fluid(N, SD_VANS_YADE, 0.0065, 0);
    printf("  %4d slices                               %6.2f          %6.2f            %6.2f (%.2f) "
           "         %6.2f\n",
           N, plain, booked, walls, walls / plain, yade);
  }
  printf("grains, ns per grain (900 slices)          averages         forces\n");
  static const double ratios[] = {3.0, 15.0};
  static const int counts[] = {1265, 50000};
  for (int k = 0; k < 2; k++)
    for (int m = 0; m < 2; m++) {
      double average, force;
      grains(ratios[k], counts[m], 0, (sd_drag_law){0}, &average, &force);
      printf("  a/dz = %4.1f, %6d grains                 %6.1f          %6.1f\n", ratios[k],
             counts[m], average, force);
    }
  static const struct {
    const char *name;
    sd_drag_law law;
  } laws[] = {{"yade, n", {0}},
              {"brown_lawler, richardson_zaki", {SD_DRAG_BROWN_LAWLER, SD_HINDRANCE_RICHARDSON_ZAKI, 0.0}},
              {"brown_lawler, di_felice", {SD_DRAG_BROWN_LAWLER, SD_HINDRANCE_DI_FELICE, 0.0}}};
  for (size_t k = 0; k < sizeof laws / sizeof *laws; k++)
    for (int felt = 0; felt < 2; felt++) {
      double average, force;
      grains(10.0, 1265, felt, laws[k].law, &average, &force);
      printf("  a/dz = 10.0, felt %s, %-29s %6.1f    %6.1f\n", felt ? "volume" : "centre", laws[k].name, average,
             force);
    }
  return 0;
}
