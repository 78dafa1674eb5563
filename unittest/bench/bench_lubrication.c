/* What lubrication costs in motion without inertia, in units of one product with the mobility (all pairs,
 * with torques) in the same run: n free spheres that settle at volume fraction phi, gaps down to xi.
 *   bench_lubrication [n phi xi]      without: those of the table in README.md */
#define _POSIX_C_SOURCE 200809L
#include "../core/stokes/bodies/settling.h"
#include "cpu.h"

enum { RUNS = 5 };

/* Medians, taken in turns */
typedef struct {
  double product, place, make, apply, solve;
} times;

static times measure(settling *s, int warm, double tolerance)
{
  double t[5][RUNS], *out = calloc(6 * (size_t) s->A.lone, sizeof(double));
  double *l = malloc(sizeof(double) * 6 * (size_t) s->A.lone), *v = malloc(sizeof(double) * 6 * (size_t) s->A.lone);
  double *bodies = malloc(sizeof(double) * (SD_TIE_OF_BODY + SD_TIE_OF_SPHERE) * (size_t) s->A.lone);
  const size_t bytes = sizeof(double) * 6 * (size_t) s->A.lone;
  memcpy(l, s->l, bytes);
  memcpy(v, s->before, bytes);
  for (int k = 0; k < RUNS; k++) {
    t[0][k] = cpu();
    settling_product(&s->packed, s->F, out);
    t[1][k] = cpu();
    near_place(&s->near);
    t[2][k] = cpu();
    assert_int_equal(sd_tie_make(&s->A, (sd_tie_room){bodies, bodies + SD_TIE_OF_BODY * s->A.lone}), SD_OK);
    t[3][k] = cpu();
    sd_lubrication_apply(&s->near.L, s->F, out);
    t[4][k] = cpu();
    memcpy(s->l, l, bytes);
    memcpy(s->before, v, bytes);
    settling_solve(s, warm, tolerance);
    const double end = cpu();
    for (int e = 0; e < 4; e++) t[e][k] = t[e + 1][k] - t[e][k];
    t[4][k] = end - t[4][k];
  }
  free(out), free(l), free(v), free(bodies);
  return (times){median(t[0], RUNS), median(t[1], RUNS), median(t[2], RUNS), median(t[3], RUNS),
                 median(t[4], RUNS)};
}

static void tell(settling *s, const char *what, int warm, double tolerance)
{
  const times t = measure(s, warm, tolerance);
  const int products = s->report.products;
  const long within = s->tie.products;
  double *reference = malloc(sizeof(double) * 6 * (size_t) s->A.lone),
         *mine = malloc(sizeof(double) * 6 * (size_t) s->A.lone);
  const size_t bytes = sizeof(double) * 6 * (size_t) s->A.lone;
  memcpy(mine, s->v, bytes);
  settling_solve(s, 0, 1e-8);
  memcpy(reference, s->v, bytes);
  memcpy(s->v, mine, bytes);
  const double error = settling_error(s, reference);
  free(reference), free(mine);
  printf("| %s, %g | %d | %ld | %.1f | %.2f | %.2f | %.2f | %.1e |\n", what, tolerance, products, within,
         1e3 * t.product, t.place / t.product, t.make / t.product,
         (t.place + t.solve) / t.product - products, error);
  fflush(stdout);
}

static void scene_of(int n, double phi, double xi)
{
  settling *s = settling_create(n, phi, xi);
  printf("\n%d spheres, phi %g, gaps from %g, %.1f pairs a sphere\n", n, phi, xi, (double) s->near.L.count / n);
  tell(s, "from nothing", 0, 1e-3);
  /* the fastest falls a hundredth of a radius */
  settling_solve(s, 0, 1e-3);
  double fastest = 0.0;
  for (int i = 0; i < n; i++) fastest = fmax(fastest, fabs(s->v[6 * i + 2]));
  for (int i = 0; i < n; i++)
    for (int d = 0; d < 3; d++) s->near.s.x[3 * i + d] += 0.01 / fastest * s->v[6 * i + d];
  settling_place(s);
  tell(s, "from the last step", 1, 1e-3);
  settling_shake(s, 5);
  tell(s, "from nothing, unlike forces", 0, 1e-3);
  settling_free(s);
}

int main(int argc, char **argv)
{
  printf("| begins, tolerance | products | with L | a product, ms | pairs | factor | all besides | error |\n"
         "|---|---|---|---|---|---|---|---|\n");
  if (argc == 4)
    scene_of(atoi(argv[1]), atof(argv[2]), atof(argv[3]));
  else {
    scene_of(10000, 0.3, 1e-3);
    scene_of(2000, 0.1, 1e-6);
    scene_of(2000, 0.3, 1e-6);
    scene_of(2000, 0.5, 1e-6);
  }
  return 0;
}
