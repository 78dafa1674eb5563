/* Forces from velocities by two solvers, in products: points by sd_solve_gradients, without preconditioner, and the
 * same spheres as bodies that all rest in the slip, by sd_bodies_solve; with the error of the forces.
 *   bench_resting      README.md has the command and figures */
#include "bench_scene.h"

#include "bodies/resting.h"

#include <string.h>

static double error_of(int n, const double *F, const double *exact)
{
  double off = 0.0, all = 0.0;
  for (int j = 0; j < 3 * n; j++) {
    off += (F[j] - exact[j]) * (F[j] - exact[j]);
    all += exact[j] * exact[j];
  }
  return sqrt(off / all);
}

static void row(const char *name, scene *s, const double *slip, const double *guess, double tolerance)
{
  const size_t bytes = sizeof(double) * 3 * (size_t) s->n;
  double *F = calloc(3 * (size_t) s->n, sizeof(double)), *work = malloc(sizeof(double) * SD_SOLVE_WORK(s->n, 3)),
         error[3];
  int as_good = 0;
  double *exact = calloc(3 * (size_t) s->n, sizeof(double));
  sd_system A = scene_system(s);
  sd_solve_report report;
  if (sd_solve_gradients(&A, slip, 1e-12, 3000, exact, work, &report) != SD_OK) abort();
  A.warm = guess != NULL;
  if (guess) memcpy(F, guess, bytes);
  if (sd_solve_gradients(&A, slip, tolerance, 3000, F, work, &report) != SD_OK) abort();
  error[0] = error_of(s->n, F, exact);
  if (guess) memcpy(F, guess, bytes);
  const int own = resting_solve(s, slip, guess != NULL, tolerance, F);
  error[1] = error_of(s->n, F, exact);
  const int same = resting_to_residual(s, slip, guess, tolerance, F);
  error[2] = error_of(s->n, F, exact);
  for (double try = 1.0; try > 1e-10; try *= 0.8) {
    for (int j = 0; j < 3 * s->n; j++) F[j] = guess ? guess[j] : 0.0;
    as_good = resting_solve(s, slip, guess != NULL, try, F);
    if (error_of(s->n, F, exact) <= error[0]) break;
  }
  printf("  %-40s %.0e %8d %9.1e %8d %9.1e %8d %9.1e %8d\n", name, tolerance, report.products, error[0], own, error[1],
         same, error[2], as_good);
  free(F);
  free(exact);
  free(work);
}

static void rows(const char *name, scene s)
{
  static const double tolerances[] = {1e-3, 1e-6};
  static const char *const what[] = {"uniform", "random", "uniform, warm"};
  double *slip[2] = {scene_uniform_slip(&s, 0.9, 0, 0), random_numbers(3 * s.n)}, *before = random_numbers(3 * s.n);
  sd_status status;
  sd_solve_report report;
  s.fast = 1;
  /* a guess: the forces of slip that is off by a hundredth */
  for (int j = 0; j < 3 * s.n; j++) before[j] = slip[0][j] + 0.01 * before[j];
  double *guess = scene_solve(&s, sd_solve_gradients, before, 1e-11, 3000, &status, &report);
  for (int k = 0; k < 3; k++)
    for (int t = 0; t < 2; t++) {
      char title[64];
      snprintf(title, sizeof(title), "%s, %s", name, what[k]);
      row(title, &s, slip[k % 2], k == 2 ? guess : NULL, tolerances[t]);
    }
  free(guess);
  free(before);
  free(slip[0]);
  free(slip[1]);
  scene_free(&s);
}

int main(void)
{
  setvbuf(stdout, NULL, _IOLBF, 0);
  printf("Products and error of the forces: points; bodies at rest, that number as their own tolerance; to the same "
         "residual; products to the same error\n");
  rows("8^3 touching", scene_lattice(8, 8, 8, 2.0, 0.7, ETA));
  rows("1000 polydisperse, phi 0.2", polydisperse(1000, 1));
  rows("500, phi 0.45", cloud_dense(500, 0.45, 0.7, 1.3, ETA, 1));
  rows("50 flocs of 20", cloud_flocs(50, 20, 1.0, 34.7, 1, ETA, 1));
  return 0;
}
