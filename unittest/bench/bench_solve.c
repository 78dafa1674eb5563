/* Timings of solves, preconditioned and not, beside LAPACK's dense Cholesky in the same program, with the error of the
 * answer.
 *   bench_solve [quick|waves]      README.md has the command, what the rows mean and figures
 * Times are processor time on one core, medians of five. */
#define _POSIX_C_SOURCE 200809L
#include "bench_scene.h"
#include "cpu.h"

#include "../core/stokes/ewald/periodic.h"
#include "in_clumps.h"
#include "sd_waves.h"

#include <string.h>

void dpotrf_(const char *uplo, const int *n, double *A, const int *lda, int *info);
void dpotrs_(const char *uplo, const int *n, const int *nrhs, const double *A, const int *lda,
             double *b, const int *ldb, int *info);

static const double U = 0.9;
enum { RUNS = 5 };

typedef struct {
  double seconds, drag;
  int iterations;
  double residual;
} solved;

/* One solve for uniform velocity along x. Time includes packing the spheres. */
static solved solve_once(scene *s, double tolerance, double *F, double *work, const double *slip)
{
  const sd_system A = scene_system(s);
  sd_solve_report report;
  solved r = {0};
  s->fast = 1;
  const double begin = cpu();
  sd_packed_free(&s->packed);
  const sd_status status = sd_solve_gradients(&A, slip, tolerance, 2000, F, work, &report);
  r.seconds = cpu() - begin;
  if (status != SD_OK) printf("  %s\n", sd_status_string(status));
  for (int i = 0; i < s->n; i++) r.drag += F[3 * i];
  r.iterations = report.iterations;
  r.residual = report.residual;
  return r;
}

static solved solve_median(scene *s, sd_precondition *P, void *ctx, double tolerance)
{
  double *slip = scene_uniform_slip(s, U, 0, 0), t[RUNS];
  double *F = malloc(3 * sizeof(double) * (size_t) s->n),
         *work = malloc(sizeof(double) * SD_SOLVE_WORK(s->n, 3));
  solved r = {0};
  s->precondition = P;
  s->precondition_ctx = ctx;
  for (int k = 0; k < RUNS; k++) {
    r = solve_once(s, tolerance, F, work, slip);
    t[k] = r.seconds;
  }
  r.seconds = median(t, RUNS);
  free(slip);
  free(F);
  free(work);
  return r;
}

static void sparse_factor(const scene *s, double rho, sd_sparse *f, double *seconds)
{
  const sd_spheres spheres = {s->x, s->a, s->w};
  const double begin = cpu();
  const sd_precondition_case c = {.law = RPY, .spheres = spheres, .n = s->n, .width = 3, .parts = 1};
  if (sd_sparse_create(f, &c, rho) != SD_OK) abort();
  *seconds = cpu() - begin;
}

/* The same matrix, dense: LAPACK's Cholesky factorisation and one solve */
static double dense(const scene *s, double *drag)
{
  const int n = s->n, size = 3 * n, one = 1;
  double *M = malloc(sizeof(double) * (size_t) size * (size_t) size), t[RUNS];
  double *b = malloc(sizeof(double) * (size_t) size);
  for (int k = 0; k < RUNS; k++) {
    for (int j = 0; j < n; j++)
      for (int i = 0; i < n; i++) {
        double r[3], block[9];
        for (int d = 0; d < 3; d++) r[d] = s->x[3 * i + d] - s->x[3 * j + d];
        sd_tensor_uf(SD_TENSOR_RPY, r, s->a[i], s->a[j], 1.0 / (s->w[i] * s->w[j]), block);
        for (int p = 0; p < 3; p++)
          for (int q = 0; q < 3; q++)
            M[3 * i + p + (size_t) size * (size_t) (3 * j + q)] = i == j ? (p == q) / s->drag[i]
                                                                         : block[3 * p + q];
      }
    for (int i = 0; i < size; i++) b[i] = i % 3 == 0 ? U : 0.0;
    int info;
    const double begin = cpu();
    dpotrf_("L", &size, M, &size, &info);
    dpotrs_("L", &size, &one, M, &size, b, &size, &info);
    t[k] = cpu() - begin;
  }
  *drag = 0.0;
  for (int i = 0; i < size; i += 3) *drag += b[i];
  free(M);
  free(b);
  return median(t, RUNS);
}

static void print_solve(const char *name, solved r, double rival, double drag, double set_up)
{
  printf("  %-34s %6d %10.4f %10.4f %8.3f %10.1e %10.1e\n", name, r.iterations, r.seconds, set_up,
         rival > 0.0 ? r.seconds / rival : 0.0, r.residual, r.drag / drag - 1.0);
}

static void head(void)
{
  printf("  %-34s %6s %10s %10s %8s %10s %10s\n", "", "its", "solve s", "set-up s", "of dense",
         "residual", "drag error");
}

static void bench_lattice(int side)
{
  const double a = 0.7, unit = 6 * SD_PI * ETA * a * U;
  scene s = scene_lattice(side, side, side, 2.0, a, ETA);
  double drag;
  const double rival = dense(&s, &drag);
  printf("\nResistance, %d^3 touching spheres, uniform velocity, from zero\n", side);
  printf("  LAPACK dense Cholesky: %.4f s; total drag %.6f\n", rival, drag / unit);
  head();
  const double tolerance[] = {1e-3, 1e-6, 1e-9};
  for (int k = 0; k < 3; k++) {
    char name[64];
    snprintf(name, sizeof(name), "diagonal, %.0e", tolerance[k]);
    print_solve(name, solve_median(&s, NULL, NULL, tolerance[k]), rival, drag, 0.0);
  }
  for (double rho = 2.0; rho <= 4.0; rho += 1.0) {
    sd_sparse f = {0};
    double set_up;
    sparse_factor(&s, rho, &f, &set_up);
    for (int k = 0; k < 3; k++) {
      char name[64];
      snprintf(name, sizeof(name), "sparse, rho %.0f, %.0e", rho, tolerance[k]);
      print_solve(name, solve_median(&s, sd_sparse_apply, &f, tolerance[k]), rival, drag, set_up);
    }
    sd_sparse_free(&f);
  }
  scene_free(&s);
}

static void bench_flocs(void)
{
  enum { FLOCS = 50, M = 20 };
  scene s = cloud_flocs(FLOCS, M, 1.0, 34.7, 1, ETA, 1);
  const sd_spheres spheres = {s.x, s.a, s.w};
  in_clumps flocs;
  clumps_of(&flocs, RPY, spheres, s.n, 3, M);
  double drag, set_up;
  const double rival = dense(&s, &drag);
  printf("\nResistance, 50 flocs of 20 overlapping spheres, phi 0.1, 1e-6; dense Cholesky %.4f s\n",
         rival);
  head();
  print_solve("diagonal", solve_median(&s, NULL, NULL, 1e-6), rival, drag, 0.0);
  sd_blocks b = {0};
  double begin = cpu();
  if (sd_blocks_make(&b, &flocs.c) != SD_OK) abort();
  set_up = cpu() - begin;
  print_solve("clump blocks", solve_median(&s, sd_blocks_apply, &b, 1e-6), rival, drag, set_up);
  sd_sparse f = {0};
  sparse_factor(&s, 3.0, &f, &set_up);
  print_solve("sparse, rho 3", solve_median(&s, sd_sparse_apply, &f, 1e-6), rival, drag, set_up);
  sd_sparse_free(&f);
  sd_blocks_free(&b);
  scene_free(&s);
}

static void bench_dense_cloud(void)
{
  scene s = cloud_dense(1000, 0.45, 0.7, 1.3, ETA, 1);
  double drag, set_up;
  double rival = dense(&s, &drag);
  printf("\nResistance, 1000 spheres, phi 0.45, radii 0.7 ... 1.3, 1e-6; dense Cholesky %.4f s\n",
         rival);
  head();
  print_solve("diagonal", solve_median(&s, NULL, NULL, 1e-6), rival, drag, 0.0);
  sd_sparse f = {0};
  sparse_factor(&s, 3.0, &f, &set_up);
  print_solve("sparse, rho 3", solve_median(&s, sd_sparse_apply, &f, 1e-6), rival, drag, set_up);
  const double moves[] = {0.05, 0.2, 0.5};
  double *home = malloc(3 * sizeof(double) * (size_t) s.n);
  memcpy(home, s.x, 3 * sizeof(double) * (size_t) s.n);
  for (int k = 0; k < 3; k++) {
    uint64_t seed = 2;
    for (int i = 0; i < s.n; i++) {
      double v[3];
      random_vector(&seed, moves[k], v);
      for (int d = 0; d < 3; d++) s.x[3 * i + d] = home[3 * i + d] + v[d];
    }
    char name[64];
    snprintf(name, sizeof(name), "the same after moves of %.2f a", moves[k]);
    rival = dense(&s, &drag);
    print_solve(name, solve_median(&s, sd_sparse_apply, &f, 1e-6), rival, drag, set_up);
  }
  free(home);
  sd_sparse_free(&f);
  scene_free(&s);
}

/* --- with torques: random velocities and spins, 1e-6 --- */

typedef struct {
  sd_packed packed;
  int n;
} rotating;

static sd_status apply_rotating(void *ctx, const double *F, double *u)
{
  rotating *g = ctx;
  sd_packed_share(&g->packed, 0, 1, F, u);
  return SD_OK;
}

static double *spins(const scene *s)
{
  double *spin = malloc(sizeof(double) * (size_t) s->n);
  for (int i = 0; i < s->n; i++) spin[i] = 4.0 / 3.0 * s->drag[i] * s->a[i] * s->a[i];
  return spin;
}

static void solve_rotating(const char *name, const scene *s, const double *spin, sd_precondition *P,
                           void *ctx, double set_up)
{
  const sd_spheres spheres = {s->x, s->a, s->w};
  rotating g = {.n = s->n};
  double *slip = malloc(6 * sizeof(double) * (size_t) s->n), t[RUNS];
  double *F = malloc(6 * sizeof(double) * (size_t) s->n),
         *work = malloc(sizeof(double) * SD_SOLVE_WORK(s->n, 6));
  uint64_t seed = 5;
  for (int i = 0; i < 6 * s->n; i++)
    slip[i] = uniform(&seed, -1, 1) / (i % 6 < 3 ? 1.0 : s->a[i / 6]);
  const sd_system A = {.n = s->n,
                       .drag = s->drag,
                       .spin = spin,
                       .apply = apply_rotating,
                       .apply_ctx = &g,
                       .precondition = P,
                       .precondition_ctx = ctx};
  sd_solve_report report;
  for (int k = 0; k < RUNS; k++) {
    const double begin = cpu();
    if (sd_packed_all(&g.packed, SD_ISA_BEST, &RPY, &spheres, s->n, 6) != SD_OK) abort();
    if (sd_solve_gradients(&A, slip, 1e-6, 1000, F, work, &report) != SD_OK) abort();
    t[k] = cpu() - begin;
  }
  printf("  %-34s %6d %10.4f %10.4f %8s %10.1e\n", name, report.iterations, median(t, RUNS), set_up, "",
         report.residual);
  sd_packed_free(&g.packed);
  free(slip);
  free(F);
  free(work);
}

/* m: spheres of each clump, 0: none */
static void bench_rotating(const char *name, scene s, int m)
{
  const sd_spheres spheres = {s.x, s.a, s.w};
  double *spin = spins(&s);
  printf("\nResistance with torques, %s, random velocities and spins, 1e-6\n", name);
  head();
  solve_rotating("diagonal", &s, spin, NULL, NULL, 0.0);
  sd_sparse f = {0};
  double begin = cpu();
  const sd_precondition_case c = {.law = RPY, .spheres = spheres, .n = s.n, .width = 6, .parts = 1};
  if (sd_sparse_create(&f, &c, 3.0) != SD_OK) abort();
  const double set_up = cpu() - begin;
  solve_rotating("sparse, rho 3", &s, spin, sd_sparse_apply, &f, set_up);
  sd_sparse_free(&f);
  if (m) {
    in_clumps clumps;
    clumps_of(&clumps, RPY, spheres, s.n, 6, m);
    sd_blocks b = {0};
    begin = cpu();
    if (sd_blocks_make(&b, &clumps.c) != SD_OK) abort();
    solve_rotating("clump blocks", &s, spin, sd_blocks_apply, &b, cpu() - begin);
    sd_blocks_free(&b);
  }
  free(spin);
  scene_free(&s);
}

/* Too large for the dense rival: drag from an independent code. */
static void bench_large_lattice(void)
{
  const double a = 0.7, unit = 6 * SD_PI * ETA * a * U, known = 29.013577;
  scene s = scene_lattice(22, 22, 22, 2.0, a, ETA);
  double *slip = scene_uniform_slip(&s, U, 0, 0), set_up = 0.0;
  double *F = malloc(3 * sizeof(double) * (size_t) s.n),
         *work = malloc(sizeof(double) * SD_SOLVE_WORK(s.n, 3));
  sd_sparse f = {0};
  printf("\nResistance, 22^3 touching spheres, uniform velocity, 1e-6, one run\n");
  head();
  for (int k = 0; k < 2; k++) {
    if (k) {
      sparse_factor(&s, 3.0, &f, &set_up);
      s.precondition = sd_sparse_apply;
      s.precondition_ctx = &f;
    }
    const solved r = solve_once(&s, 1e-6, F, work, slip);
    print_solve(k ? "sparse, rho 3" : "diagonal", r, 0.0, known * unit, set_up);
    printf("  total drag %.6f; %.4f s an iteration\n", r.drag / unit, r.seconds / r.iterations);
  }
  sd_sparse_free(&f);
  free(slip);
  free(F);
  free(work);
  scene_free(&s);
}

/* --- long waves of a periodic box ------------------------------------------------------------- */

/* Nanoseconds a sphere, and as pairs of a product by list in the same run */
static void bench_cost_of_waves(int n, int width)
{
  scene s = polydisperse(n, 1);
  const double side = cbrt(n * 4.0 / 3.0 * SD_PI * 1.25 / 0.2);
  const sd_ewald_box box = {.periodic = 1, .edge = {side, side, side}};
  double *r = random_numbers(width * n), *z = malloc(sizeof(double) * (size_t) (width * n));
  double t[3][RUNS];
  const sd_precondition_case c = {
      .law = RPY, .spheres = {s.x, s.a, s.w}, .n = n, .width = width, .box = &box, .parts = 1};
  sd_neighbors list = {0};
  sd_packed packed = {0};
  if (sd_neighbors_cutoff(&list, s.x, n, n, 8.0) != SD_OK) abort();
  if (sd_packed_list(&packed, SD_ISA_BEST, &RPY, &c.spheres, n, 3) != SD_OK) abort();
  for (int k = 0; k < RUNS; k++) {
    sd_waves waves = {0};
    t[0][k] = cpu();
    if (sd_waves_make(&waves, &c) != SD_OK) abort();
    t[0][k] = cpu() - t[0][k];
    t[1][k] = cpu();
    sd_waves_apply(&waves, r, z);
    t[1][k] = cpu() - t[1][k];
    t[2][k] = cpu();
    sd_packed_pairs(&packed, &list.pairs, r, NULL, z);
    t[2][k] = cpu() - t[2][k];
    sd_waves_free(&waves);
  }
  const double pair = median(t[2], RUNS) / (double) list.pairs.first[n];
  printf("  %d spheres, width %d: set-up %.0f ns a sphere, %.0f pairs; application %.0f ns, %.0f "
         "pairs\n",
         n, width, 1e9 * median(t[0], RUNS) / n, median(t[0], RUNS) / n / pair, 1e9 * median(t[1], RUNS) / n,
         median(t[1], RUNS) / n / pair);
  sd_neighbors_free(&list);
  sd_packed_free(&packed);
  free(r);
  free(z);
  scene_free(&s);
}

/* n spheres, radii 0.5 ... 1.5, phi 0.2, that take random velocities: one solve from zero, products
 * to a tenth of the tolerance, with what it takes to make the waves */
static void bench_solve_with_waves(int n, double tolerance)
{
  scene s = polydisperse(n, 1);
  double volume = 0.0;
  for (int i = 0; i < n; i++) volume += 4.0 / 3.0 * SD_PI * pow(s.a[i], 3);
  const double side = cbrt(volume / 0.2);
  const sd_ewald_box box = {.periodic = 1, .edge = {side, side, side}};
  const sd_ewald how = periodic_choose(&box, s.a, n, 3, 0.1 * tolerance);
  const sd_precondition_case c = {
      .law = RPY, .spheres = {s.x, s.a, s.w}, .n = n, .width = 3, .box = &box, .parts = 1};
  double *slip = random_numbers(3 * n), *F = malloc(sizeof(double) * 3 * (size_t) n),
         *work = malloc(sizeof(double) * SD_SOLVE_WORK(n, 3)), first = 0.0;
  periodic p;
  periodic_place(&p, s.x, s.a, s.w, n, 3, &how);
  printf("  %d spheres, periodic, %.0e\n", n, tolerance);
  for (int k = 0; k < 2; k++) {
    sd_waves waves = {0};
    const double begin = cpu();
    if (k && sd_waves_make(&waves, &c) != SD_OK) abort();
    const double made = cpu() - begin;
    const sd_system A = {.n = n,
                         .drag = s.drag,
                         .apply = sd_mobility_apply,
                         .apply_ctx = &p.omega,
                         .precondition = k ? sd_waves_apply : NULL,
                         .precondition_ctx = &waves};
    sd_solve_report report;
    if (sd_solve_gradients(&A, slip, tolerance, 400, F, work, &report) != SD_OK) abort();
    const double took = cpu() - begin;
    if (!k) first = took;
    printf("    %-10s %3d iterations, %.2f s with the set-up (%.2f s), ratio %.2f, residual %.1e\n",
           k ? "waves" : "diagonal", report.iterations, took, made, took / first, report.residual);
    sd_waves_free(&waves);
  }
  periodic_free(&p);
  free(slip);
  free(F);
  free(work);
  scene_free(&s);
}

int main(int argc, char **argv)
{
  const int quick = argc > 1 && strcmp(argv[1], "quick") == 0;
  setvbuf(stdout, NULL, _IOLBF, 0);
  if (argc > 1 && strcmp(argv[1], "waves") == 0) {
    for (int width = 3; width <= 6; width += 3) bench_cost_of_waves(20000, width);
    bench_solve_with_waves(30000, 1e-3);
    return 0;
  }
  bench_lattice(quick ? 5 : 10);
  bench_flocs();
  bench_dense_cloud();
  bench_rotating("10^3 touching spheres", scene_lattice(10, 10, 10, 2.0, 0.7, ETA), 0);
  bench_rotating("phi 0.45", cloud_dense(1000, 0.45, 0.7, 1.3, ETA, 1), 0);
  bench_rotating("50 flocs of 20", cloud_flocs(50, 20, 1.0, 34.7, 1, ETA, 1), 20);
  if (!quick) bench_large_lattice();
  return 0;
}
