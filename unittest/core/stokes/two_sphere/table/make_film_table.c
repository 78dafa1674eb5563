/* make_film_table > sd_film_table.inc: the mean resistance of two shells of points at the nodes of
 * sd_film_table_internal.h; some minutes.
 *
 * make_film_table check KIND RATIO GAP: the shipped numbers of one node against those computed here
 * and now; fails if they differ. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sd_body_shape.h"
#include "sd_constants.h"
#include "sd_film_of.h"
#include "sd_film_table_internal.h"
#include "sd_linear.h"
#include "sd_multiblob.h"
#include "sd_two_sphere_table_internal.h"

enum { RATIOS = SD_FILM_RATIOS, GAPS = SD_FILM_GAPS, SCALARS = SD_FILM_SCALARS };

static double ratio_at_node(double t)
{
  return (1.0 + SD_FILM_LARGEST_V * t) / (1.0 - SD_FILM_LARGEST_V * t);
}

static double xi_at_node(double t)
{
  return SD_FILM_LARGEST_XI * t * t;
}

/* Pairs of orientations: those of 42 points differ less, and cost more. */
static int pairs_of(int n)
{
  return n == 12 ? 2048 : 1024;
}

/* Orientation of sphere `which` of pair k: even over all rotations, by an additive sequence of six
 * dimensions (multiples of the powers of 1/1.1128, the root of x^7 = x + 1) */
static void orientation(int k, int which, double Q[9])
{
  const double root = 1.1127756842787055;
  double s[3];
  for (int d = 0; d < 3; d++) s[d] = fmod(0.5 + (k + 1) * pow(root, -(3 * which + d + 1)), 1.0);
  const double u = 2.0 * SD_PI * s[1], v = 2.0 * SD_PI * s[2];
  const double w = sqrt(1.0 - s[0]) * sin(u), x = sqrt(1.0 - s[0]) * cos(u),
               y = sqrt(s[0]) * sin(v), z = sqrt(s[0]) * cos(v);
  const double R[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                       2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                       2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
  memcpy(Q, R, sizeof R);
}

/* Two shells on the z axis, sphere 2 above */
typedef struct {
  const sd_multiblob *m;
  double a[2], distance;
  /* [6n] from their own centres, [6n] where they are; [2n] radii */
  double *r, *x, *b;
  /* [(6n)^2]; [12][6n] velocities and forces of the motions U1 W1 U2 W2 */
  double *M, *v, *f;
} shells;

static void turn_shells(shells *s, int k)
{
  const int n = s->m->n;
  for (int i = 0; i < 2 * n; i++) {
    double Q[9];
    orientation(k, i / n, Q);
    sd_multiply3(Q, s->m->r + 3 * (i % n), s->r + 3 * i);
    for (int d = 0; d < 3; d++) s->x[3 * i + d] = s->r[3 * i + d] *= s->a[i / n];
    s->x[3 * i + 2] += i < n ? 0.0 : s->distance;
    s->b[i] = s->a[i / n] * s->m->point;
  }
}

static void set_motions(shells *s)
{
  const int n = s->m->n;
  memset(s->v, 0, sizeof(double) * 12 * 6 * (size_t) n);
  for (int i = 0; i < 2 * n; i++)
    for (int d = 0; d < 3; d++) {
      const double e[3] = {d == 0, d == 1, d == 2};
      double *columns = s->v + (size_t) (6 * (i / n)) * 6 * n + 3 * i;
      memcpy(columns + (size_t) d * 6 * n, e, sizeof e);
      sd_cross(e, s->r + 3 * i, columns + (size_t) (3 + d) * 6 * n);
    }
}

/* sum += the 12x12 of these orientations, without what depends on azimuth and handedness */
static void add_resistance(shells *s, sd_pair_resistance *sum)
{
  const int N = 6 * s->m->n;
  double R[12][12];
  sd_wall_matrix(NULL, 2 * s->m->n, 3, s->x, s->b, s->M);
  for (int q = 0; q < 2 && s->m->delta != 0.0; q++)
    sd_multiblob_one_body_matrix(s->m, s->a[q], s->r + N / 2 * q, (size_t) N, s->M + N / 2 * q * (N + 1));
  set_motions(s);
  memcpy(s->f, s->v, sizeof(double) * 12 * (size_t) N);
  if (sd_cholesky_solve(N, s->M, 12, s->f) != SD_OK) exit(EXIT_FAILURE);
  for (int p = 0; p < 12; p++)
    for (int q = 0; q < 12; q++) {
      R[p][q] = 0.0;
      for (int k = 0; k < N; k++) R[p][q] += s->v[(size_t) p * N + k] * s->f[(size_t) q * N + k];
    }
  static const int row[3] = {0, 0, 6}, column[3] = {0, 6, 6};
  for (int b = 0; b < 3; b++) {
    const int p = row[b], q = column[b];
    sum->XA[b] += R[p + 2][q + 2];
    sum->YA[b] += 0.5 * (R[p][q] + R[p + 1][q + 1]);
    sum->XC[b] += R[p + 5][q + 5];
    sum->YC[b] += 0.5 * (R[p + 3][q + 3] + R[p + 4][q + 4]);
  }
  for (int b = 0; b < 4; b++) { /* T = YB U x d, d along z */
    const int p = 6 * (b / 2), q = 6 * (b % 2);
    sum->YB[b] += 0.5 * (R[p + 3][q + 1] - R[p + 4][q]);
  }
}

static void at_node(int kind, int i, int j, double value[SCALARS])
{
  const int n = kind < 2 ? 12 : 42, pairs = pairs_of(n), N = 6 * n;
  const double ratio = ratio_at_node(sd_two_sphere_node(RATIOS, i));
  const double xi = xi_at_node(sd_two_sphere_node(GAPS, j));
  sd_multiblob m;
  if (sd_multiblob_create(n, kind % 2, &m) != SD_OK) exit(EXIT_FAILURE);
  shells s = {.m = &m, .a = {1.0, ratio}, .distance = (1.0 + ratio) * (1.0 + 0.5 * xi)};
  double *memory = malloc(sizeof(double) * (size_t) N * (size_t) (N + 27));
  if (!memory) exit(EXIT_FAILURE);
  s.M = memory;
  s.v = s.M + N * N;
  s.f = s.v + 12 * N;
  s.r = s.f + 12 * N;
  s.x = s.r + N;
  s.b = s.x + N;
  sd_pair_resistance sum = {{0.0}, {0.0}, {0.0}, {0.0}, {0.0}};
  for (int k = 0; k < pairs; k++) {
    turn_shells(&s, k);
    add_resistance(&s, &sum);
  }
  free(memory);
  const sd_pair_resistance model = sd_pair_resistance_rpy(1.0, ratio, s.distance);
  sum = sd_pair_resistance_sum(1.0 / pairs, &sum, -1.0, &model);
  const sd_film film = sd_film_of(&sum, 1.0, ratio, s.distance);
  double scale[SCALARS];
  sd_film_scales(1.0, ratio, scale);
  const double numbers[SCALARS] = {film.A_n, film.A_t, film.B[0], film.B[1], film.B[2]};
  for (int k = 0; k < SCALARS; k++) value[k] = numbers[k] / scale[k];
}

static void make(void)
{
  printf("/* Made by make_film_table; sd_film_table_internal.h says of what. */\n");
  for (int kind = 0; kind < SD_FILM_KINDS; kind++) {
    printf("    {\n");
    for (int i = 0; i < RATIOS; i++) {
      printf("        {\n");
      for (int j = 0; j < GAPS; j++) {
        double value[SCALARS];
        at_node(kind, i, j, value);
        printf("            {");
        for (int k = 0; k < SCALARS; k++) printf("%s%.9f", k ? ", " : "", value[k]);
        printf("},\n");
        fflush(stdout);
      }
      printf("        },\n");
    }
    printf("    },\n");
  }
}

static int check(int kind, int i, int j)
{
  double value[SCALARS], worst = 0.0;
  at_node(kind, i, j, value);
  for (int k = 0; k < SCALARS; k++)
    worst = fmax(worst, fabs(value[k] - sd_film_table[kind][i][j][k]));
  printf("largest difference %.2g\n", worst);
  return worst < 1e-8 ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main(int argc, char **argv)
{
  if (argc == 5 && !strcmp(argv[1], "check"))
    return check(atoi(argv[2]), atoi(argv[3]), atoi(argv[4]));
  if (argc != 1) {
    fprintf(stderr, "usage: make_film_table [check KIND RATIO GAP]\n");
    return EXIT_FAILURE;
  }
  make();
  return EXIT_SUCCESS;
}
