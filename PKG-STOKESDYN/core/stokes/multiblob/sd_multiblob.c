#include "sd_multiblob.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sd_constants.h"
#include "sd_linear.h"
#include "sd_multiblob_half.h"
#include "sd_shell.h"
#include "sd_wall.h"

int sd_multiblob_has(int n)
{
  return n == 12 || n == 42;
}

/* out = g_k v for r over a */
static void pressure_mode(const sd_multiblob *m, const double r[3], const double v[3],
                          double out[3])
{
  const double faxen = (m->point * m->point - 1.0) / 6.0;
  const double along = sd_dot(r, v), square = sd_dot(r, r);
  for (int d = 0; d < 3; d++) out[d] = 0.1 * (2.0 * square * v[d] - along * r[d]) + faxen * v[d];
}

/* --- the lone sphere -------------------------------------------------------------------------- */

enum { UNIFORM, PRESSURE, STRAIN, MODES };

/* Velocity of a point of the unit sphere in each of the motions that the addition repairs. By the
 * symmetry of the icosahedron one direction of each stands for all, and only the first two know each
 * other. */
static void motions_at(const sd_multiblob *m, const double r[3], double v[MODES][3])
{
  const double x[3] = {1.0, 0.0, 0.0};
  memcpy(v[UNIFORM], x, sizeof x);
  pressure_mode(m, r, x, v[PRESSURE]);
  v[STRAIN][0] = r[1];
  v[STRAIN][1] = r[0];
  v[STRAIN][2] = 0.0;
}

/* R [MODES][MODES] = motions^T M^-1 motions of the shell of radius 1 */
static sd_status resistance_of_lone(const sd_multiblob *m, double R[MODES][MODES])
{
  const size_t N = 3 * (size_t) m->n;
  double b[SD_MULTIBLOB_MOST];
  double *M = malloc(sizeof(double) * N * (N + 2 * MODES));
  if (!M) return SD_ENOMEMORY;
  double *v = M + N * N, *f = v + MODES * N;
  for (int k = 0; k < m->n; k++) {
    double motion[MODES][3];
    b[k] = m->point;
    motions_at(m, m->r + 3 * k, motion);
    for (size_t e = 0; e < MODES; e++) memcpy(v + e * N + 3 * k, motion[e], sizeof motion[e]);
  }
  sd_wall_matrix(NULL, m->n, 3, m->r, b, M);
  memcpy(f, v, sizeof(double) * MODES * N);
  const sd_status status = sd_cholesky_solve((int) N, M, MODES, f);
  for (size_t e = 0; e < MODES; e++)
    for (size_t g = 0; g < MODES; g++) {
      R[e][g] = 0.0;
      for (size_t k = 0; k < N; k++) R[e][g] += v[e * N + k] * f[g * N + k];
    }
  free(M);
  return status;
}

static void find_addition(double R[MODES][MODES], sd_multiblob *m)
{
  const double p = R[UNIFORM][UNIFORM] / (6.0 * SD_PI), q = R[UNIFORM][PRESSURE] / (6.0 * SD_PI),
               s = R[PRESSURE][PRESSURE] / (6.0 * SD_PI), det = p * s - q * q;
  m->alpha = 1.0 - s / det;
  m->beta = q / det;
  m->delta = 45.0 - p / det;
  /* S:E = 20 pi/3 E:E of a sphere, E:E = 2 */
  m->strain = 0.9 * (1.0 - 40.0 / 3.0 * SD_PI / R[STRAIN][STRAIN]);
}

void sd_multiblob_axes(double turn[9])
{
  const double s = 1.0 / 15.0; /* of the quaternion (1, 2, 3, 4)/sqrt 30 */
  const double R[9] = {-10.0 * s, 2.0 * s, 11.0 * s, 10.0 * s, -5.0 * s,
                       10.0 * s,  5.0 * s, 14.0 * s, 2.0 * s};
  memcpy(turn, R, sizeof R);
}

/* Unit vectors p [3 n] become the points of the free sphere */
static void place_points(const double *p, sd_multiblob *m)
{
  double turn[9];
  sd_multiblob_axes(turn);
  for (int k = 0; k < m->n; k++) {
    double e[3];
    sd_multiply3(turn, p + 3 * k, e);
    for (int d = 0; d < 3; d++) m->r[3 * k + d] = m->radius * e[d];
  }
}

sd_status sd_multiblob_create_half(int n, int one_body, sd_multiblob *m)
{
  const sd_multiblob_half *half = sd_multiblob_half_of(n);
  double p[3 * SD_MULTIBLOB_MOST];
  *m = (sd_multiblob){.n = n};
  if (!half || !sd_shell_points(n, p)) return SD_EOUTSIDE;
  m->radius = half->radius;
  m->point = half->point;
  place_points(p, m);
  if (!one_body) return SD_OK;
  m->alpha = half->alpha;
  m->beta = half->beta;
  m->delta = half->delta;
  m->strain = half->strain;
  m->rotation = half->rotation;
  return SD_OK;
}

sd_status sd_multiblob_create(int n, int one_body, sd_multiblob *m)
{
  sd_shell shell;
  double R[MODES][MODES];
  *m = (sd_multiblob){.n = n};
  if (!sd_multiblob_has(n)) return SD_EOUTSIDE;
  sd_status status = sd_shell_create(n, &shell);
  if (status != SD_OK) return status;
  m->radius = shell.radius;
  m->point = shell.point;
  place_points(shell.p, m);
  sd_shell_free(&shell);
  if (!one_body) return SD_OK;
  status = resistance_of_lone(m, R);
  if (status == SD_OK) find_addition(R, m);
  return status;
}

double sd_multiblob_looser(const sd_multiblob *m)
{
  return sqrt((double) m->n) * m->point;
}

/* --- the addition ----------------------------------------------------------------------------- */

/* What the forces of a sphere add up to, lengths in radii: A0, Q = sum r_k (r_k.f_k), B = sum r_k f_k (row:
 * r_k) */
typedef struct {
  double A0[3], Q[3], B[9];
} moments;

static void moments_of(int n, double inverse, const double *r, const double *f, moments *m)
{
  *m = (moments){{0.0}, {0.0}, {0.0}};
  for (int k = 0; k < n; k++) {
    const double *fk = f + 3 * k;
    const double e[3] = {inverse * r[3 * k], inverse * r[3 * k + 1], inverse * r[3 * k + 2]};
    const double along = sd_dot(e, fk);
    for (int d = 0; d < 3; d++) {
      m->A0[d] += fk[d];
      m->Q[d] += e[d] * along;
      for (int p = 0; p < 3; p++) m->B[3 * d + p] += e[d] * fk[p];
    }
  }
}

/* All points have one distance, so that g_k f = same f - r_k (r_k.f)/10 with one number for all. What S and
 * T do is one matrix times r_k. */
void sd_multiblob_one_body(const sd_multiblob *m, double a, double eta, const double *r,
                           const double *f, double *u)
{
  const double unit = 1.0 / (6.0 * SD_PI * eta * a), inverse = 1.0 / a;
  const double same = 0.2 * m->radius * m->radius + (m->point * m->point - 1.0) / 6.0;
  const double strain = 0.5 * unit * m->strain, spin = unit * m->rotation;
  moments of;
  moments_of(m->n, inverse, r, f, &of);
  const double *B = of.B, trace = (B[0] + B[4] + B[8]) / 1.5;
  double all[3], odd[3], S[9];
  for (int d = 0; d < 3; d++) {
    const double A1 = same * of.A0[d] - 0.1 * of.Q[d];
    odd[d] = unit * (m->beta * of.A0[d] + m->delta * A1);
    all[d] = unit * (m->alpha * of.A0[d] + m->beta * A1) + same * odd[d];
    for (int p = 0; p < 3; p++)
      S[3 * d + p] = inverse *
          (strain * (B[3 * d + p] + B[3 * p + d] - (d == p ? trace : 0.0)) + spin * (B[3 * p + d] - B[3 * d + p]));
  }
  for (int d = 0; d < 3; d++) odd[d] *= 0.1 * inverse * inverse;
  for (int k = 0; k < m->n; k++) {
    const double *rk = r + 3 * k, along = sd_dot(rk, odd);
    for (int d = 0; d < 3; d++)
      u[3 * k + d] += all[d] + (S[3 * d] * rk[0] + S[3 * d + 1] * rk[1] + S[3 * d + 2] * rk[2]) - along * rk[d];
  }
}

void sd_multiblob_one_body_matrix(const sd_multiblob *m, double a, const double *r, size_t size,
                                  double *M)
{
  const size_t N = 3 * (size_t) m->n;
  for (size_t j = 0; j < N; j++) {
    double f[3 * SD_MULTIBLOB_MOST] = {0.0}, u[3 * SD_MULTIBLOB_MOST] = {0.0};
    f[j] = 1.0;
    sd_multiblob_one_body(m, a, 1.0, r, f, u);
    for (size_t i = 0; i < N; i++) M[i * size + j] += u[i];
  }
}
