#include "sd_shell_pair.h"

#include <stdlib.h>
#include <string.h>

#include "sd_body_shape.h"
#include "sd_constants.h"
#include "sd_film_of.h"
#include "sd_linear.h"
#include "sd_multiblob.h"
#include "sd_multiblob_half.h"
#include "sd_shell.h"
#include "sd_tensor.h"

enum { SCALARS = SD_FILM_SCALARS, MODES = SD_SHELL_MODES, BOTH = SD_SHELL_BOTH };

enum { PRESSURE = 3, TURN = SD_SHELL_TURN, STRAIN = SD_SHELL_STRAIN };

static void *room(size_t doubles)
{
  void *p = malloc(sizeof(double) * doubles);
  if (!p) exit(EXIT_FAILURE);
  return p;
}

sd_shell_blob sd_shell_blob_alike(int n)
{
  static sd_multiblob m;
  if (sd_multiblob_create(n, 1, &m) != SD_OK) exit(EXIT_FAILURE);
  sd_shell_blob b = {n, room(3 * (size_t) n), m.point, m.alpha, m.beta, m.delta, m.strain, 0.0};
  memcpy(b.r, m.r, sizeof(double) * 3 * (size_t) n);
  return b;
}

sd_shell_blob sd_shell_blob_by_radius(int n)
{
  const sd_multiblob_half *h = sd_multiblob_half_of(n);
  sd_shell shell;
  sd_shell_blob b = n == 12 ? sd_shell_blob_alike(n) : (sd_shell_blob){.n = n};
  if (sd_shell_create(n, &shell) != SD_OK) exit(EXIT_FAILURE);
  const double radius = n == 12 ? shell.radius : h->radius;
  if (n == 12)
    free(b.r);
  else
    b = (sd_shell_blob){n, NULL, h->point, h->alpha, h->beta, h->delta, h->strain, h->rotation};
  b.r = shell.p;
  for (int k = 0; k < 3 * n; k++) b.r[k] *= radius;
  return b;
}

/* Velocity of a point at e, of radius b, of a sphere of radius 1 in mode c */
static void mode_at(int c, const double e[3], double b, double v[3])
{
  static const double half = 0.70710678118654752, sixth = 0.40824829046386302;
  const double strain[5][9] = {{0, half, 0, half, 0, 0, 0, 0, 0},
                               {0, 0, half, 0, 0, 0, half, 0, 0},
                               {0, 0, 0, 0, 0, half, 0, half, 0},
                               {half, 0, 0, 0, -half, 0, 0, 0, 0},
                               {-sixth, 0, 0, 0, -sixth, 0, 0, 0, 2.0 * sixth}};
  const int d = c % 3;
  const double axis[3] = {d == 0, d == 1, d == 2};
  if (c >= STRAIN) {
    sd_multiply3(strain[c - STRAIN], e, v);
  } else if (c >= TURN) {
    sd_cross(axis, e, v);
  } else if (c >= PRESSURE) {
    const double g = 0.2 * sd_dot(e, e) + (b * b - 1.0) / 6.0;
    for (int p = 0; p < 3; p++) v[p] = g * axis[p] - 0.1 * e[d] * e[p];
  } else {
    memcpy(v, axis, sizeof axis);
  }
}

/* The addition between the modes of a sphere of radius a, in the block of D [BOTH BOTH] that begins at
 * mode `first` */
static void set_addition(const sd_shell_blob *b, double a, int first, double D[BOTH * BOTH])
{
  const double unit = 1.0 / (6.0 * SD_PI * a);
  for (int c = 0; c < MODES; c++) {
    double *row = D + (first + c) * BOTH + first;
    if (c < PRESSURE) row[c] = unit * b->alpha, row[c + PRESSURE] = unit * b->beta;
    else if (c < TURN) row[c] = unit * b->delta, row[c - PRESSURE] = unit * b->beta;
    else row[c] = unit * (c < STRAIN ? b->rotation : b->strain);
  }
}

/* --- a pair of them --- */

/* The shell of the larger sphere, 2, of radius 1, stands; that of the smaller one, 1, is put beside it
 * in many ways, and what 2 is by itself is known once.
 *
 *   R = K^T M^-1 K = R_2 + B^T S^-1 B,   X = M_22^-1 M_21,  S = M_11 - M_12 X,  B = K_1 - X^T K_2 */
struct sd_shell_pair {
  const sd_shell_blob *one, *two;
  /* the factor of M_22 [N2 N2]; K_2 [MODES][N2]; R_2 [MODES MODES] */
  double *factor, *K2, R2[MODES * MODES];
  /* of sphere 1: x [N1] from the centre of 2; M_21 and X [N1][N2], transposed; S; B and S^-1 B [BOTH][N1] */
  double *x, *radii, *M21, *X, *across, *turned, *S, *B, *y;
};

/* K_2 and R_2; p->factor is there */
static void find_larger(sd_shell_pair *p)
{
  const sd_shell_blob *two = p->two;
  const size_t N2 = 3 * (size_t) two->n;
  for (int c = 0; c < MODES; c++)
    for (int k = 0; k < two->n; k++)
      mode_at(c, two->r + 3 * k, two->point, p->K2 + (size_t) c * N2 + 3 * k);
  double *f = room(MODES * N2);
  memcpy(f, p->K2, sizeof(double) * MODES * N2);
  sd_cholesky_apply((int) N2, p->factor, MODES, f);
  for (size_t c = 0; c < MODES; c++)
    for (size_t e = 0; e < MODES; e++) {
      p->R2[MODES * c + e] = 0.0;
      for (size_t k = 0; k < N2; k++) p->R2[MODES * c + e] += p->K2[c * N2 + k] * f[e * N2 + k];
    }
  free(f);
}

sd_shell_pair *sd_shell_pair_create(const sd_shell_blob *one, const sd_shell_blob *two)
{
  const size_t N1 = 3 * (size_t) one->n, N2 = 3 * (size_t) two->n;
  sd_shell_pair *p = malloc(sizeof *p);
  if (!p) exit(EXIT_FAILURE);
  p->one = one;
  p->two = two;
  p->factor = room(N2 * N2);
  p->K2 = room(MODES * N2);
  p->x = room(N1);
  p->radii = room(N1 + N2);
  p->M21 = room(4 * N1 * N2);
  p->X = p->M21 + N1 * N2;
  p->across = p->X + N1 * N2;
  p->turned = p->across + N1 * N2;
  p->S = room(N1 * N1);
  p->B = room(2 * BOTH * N1);
  p->y = p->B + BOTH * N1;
  for (int k = 0; k < two->n; k++) p->radii[k] = two->point;
  sd_wall_matrix(NULL, two->n, 3, two->r, p->radii, p->factor);
  if (sd_cholesky((int) N2, p->factor) != SD_OK) exit(EXIT_FAILURE);
  find_larger(p);
  return p;
}

void sd_shell_pair_free(sd_shell_pair *p)
{
  free(p->factor);
  free(p->K2);
  free(p->x);
  free(p->radii);
  free(p->M21);
  free(p->S);
  free(p->B);
  free(p);
}

/* Q [9] orientation of shell 1 of radius a, its centre at `centre`, both in the axes of shell 2 */
static void put_beside(sd_shell_pair *p, double a, const double Q[9], const double centre[3])
{
  const sd_shell_blob *one = p->one, *two = p->two;
  const size_t N1 = 3 * (size_t) one->n, N2 = 3 * (size_t) two->n;
  memset(p->B, 0, sizeof(double) * BOTH * N1);
  for (int k = 0; k < one->n; k++) {
    double e[3];
    sd_multiply3(Q, one->r + 3 * k, e);
    for (int c = 0; c < MODES; c++) mode_at(c, e, one->point, p->B + (size_t) c * N1 + 3 * k);
    for (int d = 0; d < 3; d++) p->x[3 * k + d] = centre[d] + a * e[d];
    p->radii[k] = a * one->point;
  }
  sd_wall_matrix(NULL, one->n, 3, p->x, p->radii, p->S);
  for (size_t i = 0; i < (size_t) one->n; i++)
    for (size_t j = 0; j < (size_t) two->n; j++) {
      double r[3], M[9];
      sd_minus(p->x + 3 * i, two->r + 3 * j, r);
      sd_tensor_uf(SD_TENSOR_RPY, r, a * one->point, two->point, 1.0, M);
      for (size_t d = 0; d < 3; d++) memcpy(p->M21 + (3 * i + d) * N2 + 3 * j, M + 3 * d, 3 * sizeof(double));
    }
}

static void transpose(size_t rows, size_t columns, double sign, const double *A, double *out)
{
  for (size_t i = 0; i < rows; i++)
    for (size_t j = 0; j < columns; j++) out[j * rows + i] = sign * A[i * columns + j];
}

/* G [BOTH BOTH] of the modes of 1 and of 2 */
static void resistance(sd_shell_pair *p, double G[BOTH * BOTH])
{
  const size_t N1 = 3 * (size_t) p->one->n, N2 = 3 * (size_t) p->two->n;
  memcpy(p->X, p->M21, sizeof(double) * N1 * N2);
  sd_cholesky_apply((int) N2, p->factor, (int) N1, p->X);
  transpose(N1, N2, -1.0, p->M21, p->across);
  transpose(N1, N2, 1.0, p->X, p->turned);
  sd_add_gram((int) N1, (int) N2, p->across, p->turned, p->S);
  for (size_t c = 0; c < MODES; c++)
    for (size_t k = 0; k < N2; k++)
      for (size_t i = 0; i < N1; i++)
        p->B[(MODES + c) * N1 + i] -= p->turned[k * N1 + i] * p->K2[c * N2 + k];
  memcpy(p->y, p->B, sizeof(double) * BOTH * N1);
  if (sd_cholesky_solve((int) N1, p->S, BOTH, p->y) != SD_OK) exit(EXIT_FAILURE);
  for (size_t c = 0; c < BOTH; c++)
    for (size_t e = 0; e < BOTH; e++) {
      double sum = c >= MODES && e >= MODES ? p->R2[MODES * (c - MODES) + e - MODES] : 0.0;
      for (size_t i = 0; i < N1; i++) sum += p->B[c * N1 + i] * p->y[e * N1 + i];
      G[BOTH * c + e] = sum;
    }
}

/* G of the points becomes that with the addition D: what moves is (G^-1 + D) f */
static void add_addition(const double D[BOTH * BOTH], double G[BOTH * BOTH])
{
  if (sd_cholesky(BOTH, G) != SD_OK || sd_cholesky_inverse(BOTH, G) != SD_OK) exit(EXIT_FAILURE);
  for (int k = 0; k < BOTH * BOTH; k++) G[k] += D[k];
  if (sd_cholesky(BOTH, G) != SD_OK || sd_cholesky_inverse(BOTH, G) != SD_OK) exit(EXIT_FAILURE);
}

/* --- means over orientations --- */

/* sum += G of modes scaled to spheres of radii a, without what depends on azimuth and handedness; d from
 * sphere 1 to 2 */
static void add_scalars(const double G[BOTH * BOTH], const double a[2], const double d[3],
                        sd_pair_resistance *sum)
{
  static const int row[3] = {0, 0, 1}, column[3] = {0, 1, 1};
  for (int b = 0; b < 3; b++) {
    const double arms = a[row[b]] * a[column[b]];
    const double *U = G + BOTH * MODES * row[b] + MODES * column[b], *W = U + BOTH * TURN + TURN;
    double uu = 0.0, ww = 0.0;
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++) {
        uu += d[p] * U[BOTH * p + q] * d[q];
        ww += d[p] * W[BOTH * p + q] * d[q];
      }
    sum->XA[b] += uu;
    sum->YA[b] += 0.5 * (U[0] + U[BOTH + 1] + U[2 * BOTH + 2] - uu);
    sum->XC[b] += arms * ww;
    sum->YC[b] += 0.5 * arms * (W[0] + W[BOTH + 1] + W[2 * BOTH + 2] - ww);
  }
  for (int b = 0; b < 4; b++) { /* T = YB U x d */
    const double *TU = G + BOTH * (MODES * (b / 2) + TURN) + MODES * (b % 2);
    double twice = 0.0;
    for (int p = 0; p < 3; p++) {
      const int q = (p + 1) % 3, r = (p + 2) % 3;
      twice += d[r] * (TU[BOTH * p + q] - TU[BOTH * q + p]);
    }
    sum->YB[b] += 0.5 * a[b / 2] * twice;
  }
}

static void points_alone(sd_shell_pair *p, const double a[2], double distance, const sd_shell_way *way,
                         double G[BOTH * BOTH])
{
  double centre[3];
  for (int e = 0; e < 3; e++) centre[e] = -distance * way->d[e];
  put_beside(p, a[0], way->Q, centre);
  resistance(p, G);
}

static void set_additions(const sd_shell_pair *p, const double a[2], double D[BOTH * BOTH])
{
  memset(D, 0, sizeof(double) * BOTH * BOTH);
  set_addition(p->one, a[0], 0, D);
  set_addition(p->two, a[1], MODES, D);
}

void sd_shell_pair_resistance(sd_shell_pair *p, double ratio, double xi, const sd_shell_way *way,
                              double G[BOTH * BOTH])
{
  const double a[2] = {1.0 / ratio, 1.0}, distance = (a[0] + a[1]) * (1.0 + 0.5 * xi);
  double D[BOTH * BOTH];
  points_alone(p, a, distance, way, G);
  set_additions(p, a, D);
  add_addition(D, G);
}

void sd_shell_pair_means(sd_shell_pair *p, double ratio, double xi, int count, const sd_shell_way *ways,
                         double value[2][SCALARS])
{
  const double a[2] = {1.0 / ratio, 1.0}, distance = (a[0] + a[1]) * (1.0 + 0.5 * xi);
  double D[BOTH * BOTH], G[BOTH * BOTH], scale[SCALARS];
  sd_pair_resistance sum[2] = {{{0.0}, {0.0}, {0.0}, {0.0}, {0.0}}, {{0.0}, {0.0}, {0.0}, {0.0}, {0.0}}};
  set_additions(p, a, D);
  for (int k = 0; k < count; k++) {
    points_alone(p, a, distance, ways + k, G);
    add_scalars(G, a, ways[k].d, &sum[0]);
    add_addition(D, G);
    add_scalars(G, a, ways[k].d, &sum[1]);
  }
  const sd_pair_resistance model = sd_pair_resistance_rpy(a[0], a[1], distance);
  sd_film_scales(a[0], a[1], scale);
  for (int with = 0; with < 2; with++) {
    const sd_pair_resistance rest = sd_pair_resistance_sum(1.0 / count, &sum[with], -1.0, &model);
    const sd_film film = sd_film_of(&rest, a[0], a[1], distance);
    const double numbers[SCALARS] = {film.A_n, film.A_t, film.B[0], film.B[1], film.B[2]};
    for (int k = 0; k < SCALARS; k++) value[with][k] = numbers[k] / scale[k];
  }
}
