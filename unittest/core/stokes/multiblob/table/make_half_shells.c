/* make_half_shells: the rows of sd_multiblob_half.c; a second.
 *
 * make_half_shells check: the shipped numbers against those computed here and now; fails if they
 * differ. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_linear.h"
#include "sd_multiblob_half.h"
#include "sd_shell.h"
#include "sd_wall.h"

/* Motions of the lone sphere of radius 1. By the symmetry of the icosahedron one direction of each
 * stands for all. */
enum { UNIFORM, PRESSURE, STRAIN, TURN, MODES };

static double nearest(int n, const double *p, int i)
{
  double least = 4.0;
  for (int j = 0; j < n; j++)
    if (j != i) least = fmin(least, sd_distance_squared(p + 3 * i, p + 3 * j));
  return sqrt(least);
}

/* Half the mean distance of a point's nearest neighbour, in radii of the shell */
static double half_spacing(int n, const double *p)
{
  double sum = 0.0;
  for (int i = 0; i < n; i++) sum += nearest(n, p, i);
  return 0.5 * sum / n;
}

static void motions_at(const double x[3], double b, double v[MODES][3])
{
  const double faxen = (b * b - 1.0) / 6.0, square = sd_dot(x, x);
  memset(v, 0, sizeof(double) * 3 * MODES);
  v[UNIFORM][0] = 1.0;
  for (int d = 0; d < 3; d++) v[PRESSURE][d] = -0.1 * x[0] * x[d];
  v[PRESSURE][0] += 0.2 * square + faxen;
  v[STRAIN][0] = x[1], v[STRAIN][1] = x[0];
  v[TURN][0] = -x[1], v[TURN][1] = x[0];
}

/* R = motions^T M^-1 motions of the points `radius` p, of radius b */
static void resistance(int n, const double *p, double radius, double b, double R[MODES][MODES])
{
  const size_t N = 3 * (size_t) n;
  double *M = malloc(sizeof(double) * (N * N + (2 * MODES + 2) * N));
  if (!M) exit(EXIT_FAILURE);
  double *v = M + N * N, *f = v + MODES * N, *x = f + MODES * N, *radii = x + N;
  for (size_t k = 0; k < N; k++) x[k] = radius * p[k], radii[k / 3] = b;
  for (size_t k = 0; k < (size_t) n; k++) {
    double motion[MODES][3];
    motions_at(x + 3 * k, b, motion);
    for (size_t e = 0; e < MODES; e++) memcpy(v + e * N + 3 * k, motion[e], sizeof motion[e]);
  }
  sd_wall_matrix(NULL, n, 3, x, radii, M);
  memcpy(f, v, sizeof(double) * MODES * N);
  if (sd_cholesky_solve((int) N, M, MODES, f) != SD_OK) exit(EXIT_FAILURE);
  for (size_t e = 0; e < MODES; e++)
    for (size_t g = 0; g < MODES; g++) {
      R[e][g] = 0.0;
      for (size_t k = 0; k < N; k++) R[e][g] += v[e * N + k] * f[g * N + k];
    }
  free(M);
}

/* Of the sphere of radius 1 (sd_multiblob.h) */
static sd_multiblob_half constants_of(int n)
{
  double R[MODES][MODES];
  sd_shell shell;
  if (sd_shell_create(n, &shell) != SD_OK) exit(EXIT_FAILURE);
  const double kappa = half_spacing(n, shell.p);
  resistance(n, shell.p, 1.0, kappa, R);
  const double radius = 6.0 * SD_PI / R[UNIFORM][UNIFORM]; /* the drag is that of the sphere */
  resistance(n, shell.p, radius, kappa * radius, R);
  sd_shell_free(&shell);
  const double unit = 1.0 / (6.0 * SD_PI), uniform = unit * R[UNIFORM][UNIFORM],
               both = unit * R[UNIFORM][PRESSURE], pressure = unit * R[PRESSURE][PRESSURE],
               det = uniform * pressure - both * both;
  return (sd_multiblob_half){.n = n,
                             .radius = radius,
                             .point = kappa * radius,
                             .alpha = 1.0 - pressure / det,
                             .beta = both / det,
                             .delta = 45.0 - uniform / det,
                             .strain = 0.9 * (1.0 - 40.0 / 3.0 * SD_PI / R[STRAIN][STRAIN]),
                             .rotation = 0.75 * (1.0 - 8.0 * SD_PI / R[TURN][TURN])};
}

static const int sizes[] = {42, 162, 642};
enum { SHELLS = sizeof sizes / sizeof *sizes };

static void make(void)
{
  for (int s = 0; s < SHELLS; s++) {
    const sd_multiblob_half h = constants_of(sizes[s]);
    printf("    {%d, %.15g, %.15g, %.12g, %.14g,\n     %.14g, %.14g, %.14g},\n", h.n, h.radius, h.point,
           h.alpha, h.beta, h.delta, h.strain, h.rotation);
  }
}

static double difference(const sd_multiblob_half *p, const sd_multiblob_half *q)
{
  const double all[] = {p->radius - q->radius, p->point - q->point,   p->alpha - q->alpha,
                        p->beta - q->beta,     p->delta - q->delta,   p->strain - q->strain,
                        p->rotation - q->rotation};
  double worst = 0.0;
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) worst = fmax(worst, fabs(all[k]));
  return worst;
}

static int check(void)
{
  double worst = 0.0;
  for (int s = 0; s < SHELLS; s++) {
    const sd_multiblob_half h = constants_of(sizes[s]), *shipped = sd_multiblob_half_of(sizes[s]);
    if (!shipped) return EXIT_FAILURE;
    worst = fmax(worst, difference(&h, shipped));
  }
  printf("largest difference %.2g\n", worst);
  return worst < 1e-11 ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main(int argc, char **argv)
{
  if (argc == 2 && !strcmp(argv[1], "check")) return check();
  if (argc != 1) {
    fprintf(stderr, "usage: make_half_shells [check]\n");
    return EXIT_FAILURE;
  }
  make();
  return EXIT_SUCCESS;
}
