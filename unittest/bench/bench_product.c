/* Timings of u = Omega F, each as a ratio to a rival run in the same program, with the error of the answer beside it.
 *   bench_product [quick|kernel]      README.md has the command, what the rows mean and figures
 * Times are processor time on one core, medians of five; rival and core take turns, so that both meet the same load. */
#define _POSIX_C_SOURCE 200809L
#include "bench_scene.h"
#include "cpu.h"

#include <string.h>

enum { RUNS = 5 };

/* --- the rival: what one would write first. One root and one division for a pair that does not overlap. --- */

static inline void rival_pair(const double *x, const double *a, const double *F, int i, int j,
                              double u[3])
{
  const double dx = x[3 * i] - x[3 * j], dy = x[3 * i + 1] - x[3 * j + 1],
               dz = x[3 * i + 2] - x[3 * j + 2];
  const double r2 = dx * dx + dy * dy + dz * dz, R = sqrt(r2);
  double f, h;
  if (R > a[i] + a[j]) {
    const double y = 1.0 / R, y2 = y * y, m = (a[i] * a[i] + a[j] * a[j]) * y2;
    f = 0.75 * y * (1.0 + m / 3.0);
    h = 0.75 * y * (1.0 - m) * y2;
  } else {
    double g;
    sd_rpy_radial(R, a[i], a[j], &f, &g);
    h = R > 0.0 ? g / r2 : 0.0;
  }
  const double c = h * (dx * F[3 * j] + dy * F[3 * j + 1] + dz * F[3 * j + 2]);
  u[0] += f * F[3 * j] + c * dx;
  u[1] += f * F[3 * j + 1] + c * dy;
  u[2] += f * F[3 * j + 2] + c * dz;
}

/* The same with torques, times 8 pi instead of 6 pi. */
static inline void rival_grand_pair(const double *x, const double *a, const double *F, int i, int j,
                                    double u[6])
{
  const double *G = F + 6 * j, *T = G + 3;
  const double dx = x[3 * i] - x[3 * j], dy = x[3 * i + 1] - x[3 * j + 1],
               dz = x[3 * i + 2] - x[3 * j + 2];
  const double r2 = dx * dx + dy * dy + dz * dz, R = sqrt(r2);
  double f, h, k, e, cij, cji;
  if (R > a[i] + a[j]) {
    const double y = 1.0 / R, y2 = y * y, m = (a[i] * a[i] + a[j] * a[j]) * y2;
    f = y * (1.0 + m / 3.0);
    h = y * (1.0 - m) * y2;
    cij = cji = y * y2;
    k = -0.5 * cij;
    e = 1.5 * cij * y2;
  } else {
    const double y = R > 0.0 ? 1.0 / R : 0.0;
    double g, ge;
    sd_rpy_radial(R, a[i], a[j], &f, &g);
    sd_rpy_radial_wt(R, a[i], a[j], &k, &ge);
    f *= 4.0 / 3.0;
    h = 4.0 / 3.0 * g * y * y;
    e = ge * y * y;
    cij = sd_rpy_radial_wf(R, a[i], a[j]) * y;
    cji = sd_rpy_radial_wf(R, a[j], a[i]) * y;
  }
  const double c = h * (dx * G[0] + dy * G[1] + dz * G[2]),
               d = e * (dx * T[0] + dy * T[1] + dz * T[2]);
  u[0] += f * G[0] + c * dx + cji * (T[1] * dz - T[2] * dy);
  u[1] += f * G[1] + c * dy + cji * (T[2] * dx - T[0] * dz);
  u[2] += f * G[2] + c * dz + cji * (T[0] * dy - T[1] * dx);
  u[3] += k * T[0] + d * dx + cij * (G[1] * dz - G[2] * dy);
  u[4] += k * T[1] + d * dy + cij * (G[2] * dx - G[0] * dz);
  u[5] += k * T[2] + d * dz + cij * (G[0] * dy - G[1] * dx);
}

static __attribute__((noinline)) void rival_all(int m, const double *x, const double *a,
                                                const double *F, int n, double *u)
{
  for (int i = 0; i < n; i++) {
    double sum[6] = {0.0};
    if (m == 3)
      for (int j = 0; j < n; j++) {
        if (j != i) rival_pair(x, a, F, i, j, sum);
      }
    else
      for (int j = 0; j < n; j++)
        if (j != i) rival_grand_pair(x, a, F, i, j, sum);
    for (int d = 0; d < m; d++) u[m * i + d] = sum[d] / ((m == 3 ? 6.0 : 8.0) * SD_PI);
  }
}

static __attribute__((noinline)) void rival_list(int m, const double *x, const double *a,
                                                 const double *F, const sd_pairs *pairs, double *u)
{
  for (int i = 0; i < pairs->n; i++) {
    double sum[6] = {0.0};
    if (m == 3)
      for (long k = pairs->first[i]; k < pairs->first[i + 1]; k++)
        rival_pair(x, a, F, i, pairs->neighbor[k], sum);
    else
      for (long k = pairs->first[i]; k < pairs->first[i + 1]; k++)
        rival_grand_pair(x, a, F, i, pairs->neighbor[k], sum);
    for (int d = 0; d < m; d++) u[m * i + d] = sum[d] / ((m == 3 ? 6.0 : 8.0) * SD_PI);
  }
}

/* Forces for the rival: times w of their own sphere, as the packed product does inside. */
static double *times_root(const scene *s, int m, const double *F)
{
  double *f = malloc((size_t) m * sizeof(double) * (size_t) s->n);
  for (int i = 0; i < m * s->n; i++) f[i] = s->w[i / m] * F[i];
  return f;
}

/* Of the m numbers of each of the first n spheres */
static double difference(const scene *s, int m, int n, const double *u, const double *rival)
{
  double off = 0.0, norm = 0.0;
  for (int i = 0; i < m * n; i++) {
    const double v = s->w[i / m] * rival[i];
    off += (u[i] - v) * (u[i] - v);
    norm += v * v;
  }
  return sqrt(off / norm);
}

static void head_of_products(void)
{
  printf("  %-34s %10s %8s %10s\n", "", "G pairs/s", "ratio", "error");
}

/* The core against the rival: forces F and F times the root of the drag, m numbers a sphere, with
 * torques 6; answers of both; seconds of the rival and of the core */
typedef struct {
  scene s;
  sd_spheres spheres;
  int n, m;
  double *F, *rival, *u, *expected, t[2][RUNS];
} contest;

static contest contest_begin(int n, int m)
{
  const size_t bytes = (size_t) m * sizeof(double) * (size_t) n;
  contest c = {.s = polydisperse(n, 1), .n = n, .m = m, .u = malloc(bytes), .expected = malloc(bytes)};
  c.spheres = (sd_spheres){c.s.x, c.s.a, c.s.w};
  c.F = random_numbers(m * n);
  c.rival = times_root(&c.s, m, c.F);
  return c;
}

static void contest_tell(contest *c, const char *what, double pairs)
{
  const double mine = median(c->t[1], RUNS), its = median(c->t[0], RUNS);
  printf("  %-34s %10.3f %8.2f %10.1e\n", what, 1e-9 * pairs / mine, its / mine,
         difference(&c->s, c->m, c->n, c->u, c->expected));
}

static void contest_end(contest *c, double pairs)
{
  printf("  %-34s %10.3f\n", "scalar C loop", 1e-9 * pairs / median(c->t[0], RUNS));
  free(c->rival);
  free(c->F);
  free(c->u);
  free(c->expected);
  scene_free(&c->s);
}

/* Packed by this function */
typedef sd_status pack(sd_packed *, sd_isa, const sd_law *, const sd_spheres *, int, int);

static void compete(contest *c, pack *packing, sd_isa isa, const char *numbers)
{
  const double pairs = (double) c->n * c->n;
  const int repeat = 1 + (int) (1e8 / pairs);
  char what[40];
  sd_packed p = {0};
  if (packing(&p, isa, &RPY, &c->spheres, c->n, c->m) != SD_OK) abort();
  for (int k = 0; k < RUNS; k++) {
    double begin = cpu();
    rival_all(c->m, c->s.x, c->s.a, c->rival, c->n, c->expected);
    c->t[0][k] = cpu() - begin;
    begin = cpu();
    for (int r = 0; r < repeat; r++) sd_packed_share(&p, 0, 1, c->F, c->u);
    c->t[1][k] = (cpu() - begin) / repeat;
  }
  snprintf(what, sizeof(what), "%s%s", isa_name(isa), numbers);
  contest_tell(c, what, pairs);
  sd_packed_free(&p);
}

static void bench_product(int n, int m)
{
  contest c = contest_begin(n, m);
  printf("\nProduct, all pairs, %d polydisperse spheres, phi 0.2%s\n", n,
         m == 6 ? ", with torques" : "");
  head_of_products();
  for (int isa = SD_ISA_BASELINE; isa <= SD_ISA_AVX512; isa++) {
    if (!sd_isa_supported(isa)) continue;
    compete(&c, sd_packed_all, isa, "");
    compete(&c, sd_packed_all_single, isa, ", floats");
  }
  contest_end(&c, (double) n * n);
}

/* The bare kernel alone, for unittest/bench/product_in_lammps.py: directed pairs per second. */
static void bench_kernel(int n, int m)
{
  scene s = polydisperse(n, 1);
  const sd_spheres spheres = {s.x, s.a, s.w};
  double *F = random_numbers(m * n), *u = malloc(sizeof(double) * (size_t) (m * n)), t[RUNS];
  sd_packed p = {0};
  if (sd_packed_all(&p, SD_ISA_BEST, &RPY, &spheres, n, m) != SD_OK) abort();
  for (int k = 0; k < RUNS; k++) {
    const double begin = cpu();
    sd_packed_share(&p, 0, 1, F, u);
    t[k] = cpu() - begin;
  }
  printf("%d %.6g\n", m, (double) n * n / median(t, RUNS));
  sd_packed_free(&p);
  free(u);
  free(F);
  scene_free(&s);
}

static void bench_list(int n, double neighbors, int m)
{
  contest c = contest_begin(n, m);
  double side = 0.0;
  for (int i = 0; i < 3 * n; i++) side = fmax(side, c.s.x[i]);
  sd_neighbors list = {0};
  double cutoff = side * cbrt(neighbors / (4.0 / 3.0 * SD_PI * n));
  for (int k = 0; k < 6; k++) { /* fewer neighbours at the border: widen the cut-off */
    if (sd_neighbors_cutoff(&list, c.s.x, n, n, cutoff) != SD_OK) abort();
    cutoff *= cbrt(neighbors / ((double) list.pairs.first[n] / n));
  }
  const double pairs = (double) list.pairs.first[n];
  const int repeat = 1 + (int) (2e7 / pairs);
  printf("\nProduct by list, %d polydisperse spheres, %.1f neighbours%s\n", n, pairs / n,
         m == 6 ? ", with torques" : "");
  head_of_products();
  for (int isa = SD_ISA_BASELINE; isa <= SD_ISA_AVX512; isa++) {
    if (!sd_isa_supported(isa)) continue;
    sd_packed p = {0};
    if (sd_packed_list(&p, isa, &RPY, &c.spheres, n, m) != SD_OK) abort();
    for (int k = 0; k < RUNS; k++) {
      double begin = cpu();
      for (int r = 0; r < repeat; r++)
        rival_list(m, c.s.x, c.s.a, c.rival, &list.pairs, c.expected);
      c.t[0][k] = (cpu() - begin) / repeat;
      begin = cpu();
      for (int r = 0; r < repeat; r++) sd_packed_pairs(&p, &list.pairs, c.F, NULL, c.u);
      c.t[1][k] = (cpu() - begin) / repeat;
    }
    contest_tell(&c, isa_name(isa), pairs);
    sd_packed_free(&p);
  }
  sd_neighbors_free(&list);
  contest_end(&c, pairs);
}

int main(int argc, char **argv)
{
  const int quick = argc > 1 && strcmp(argv[1], "quick") == 0;
  setvbuf(stdout, NULL, _IOLBF, 0);
  if (argc > 1 && strcmp(argv[1], "kernel") == 0) {
    for (int m = 3; m <= 6; m += 3) bench_kernel(10000, m);
    return 0;
  }
  printf("Best instruction set: %s\n", isa_name(sd_isa_of(SD_ISA_BEST)));
  for (int m = 3; m <= 6; m += 3) {
    bench_product(1000, m);
    if (!quick) bench_product(10000, m);
    bench_list(10000, 88.0, m);
  }
  return 0;
}
