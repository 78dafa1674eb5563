#ifndef CLIMB_H
#define CLIMB_H

/* What the rungs of test_ladder.c are made of: scenes, each as its engine of engines.h can have it, and the matrices
 * that the engine has for them, column by column. */
#include "engines.h"

#include "closed_forms.h"

#include "sd_linear.h"
#include "sd_multiblob_points.h"

/* --- scenes --- */

static inline void add(cast *s, double x, double y, double z, double a)
{
  const double at[3] = {x, y, z};
  memcpy(s->x + 3 * s->n, at, sizeof(at));
  s->a[s->n] = a;
  s->w[s->n] = 1.0 / sqrt(1.7 + 0.6 * (s->n % 2));
  s->n++;
}

/* Viscosity that two spheres, or one, are taken to be in */
static inline double eta_of(const cast *s, int i, int j)
{
  return 1.0 / (s->w[i] * s->w[j]);
}

static inline int widest(const climber *row)
{
  return row->can & TORQUES ? 6 : 3;
}

static inline double lowest(const climber *row, double a)
{
  return row->wall ? wall_at + a : -INFINITY;
}

/* Radii of a pair: the second is large where the row has such */
static inline double large_of(const climber *row)
{
  return 1.3 * (row->ratio > 1.0 ? row->ratio : 1.0);
}

/* Two spheres at a distance, the second higher by 0.48 of it; heights above a wall are a few radii. */
static inline cast pair_of(const climber *row, double a, double b, double R)
{
  cast s = {.width = 3};
  const double up = row->wall ? wall_at + 1.2 * fmax(a, b) : 2.0;
  add(&s, 3.0, 4.0, up, a);
  add(&s, 3.0 + 0.6 * R, 4.0 - 0.64 * R, up + 0.48 * R, b);
  return s;
}

/* So many spheres anywhere in a cube, or none overlapping another; every third is large where the row has such */
static inline cast crowd(const climber *row, int n, int width, double side, uint64_t seed)
{
  const int spread = !(row->can & OVERLAPS);
  cast s = {.width = width};
  for (int i = 0; i < n; i++) {
    const double a = uniform(&seed, 0.5, 1.3) * (i % 3 == 1 ? row->ratio : 1.0);
    double at[3];
    for (int d = 0; d < 3; d++) at[d] = uniform(&seed, 0.0, side);
    const int place[3] = {i % 2, i / 2 % 2, i / 4};
    for (int d = 0; d < 3 && spread; d++) at[d] = 3.4 * place[d] + uniform(&seed, 0.0, 0.5);
    if (row->wall) at[2] += lowest(row, 1.3);
    add(&s, at[0], at[1], at[2], a);
  }
  return s;
}

/* Spheres of a crowd: shells are twelve points each */
static inline int many_of(const climber *row)
{
  return row->shell ? 3 : 6;
}

/* Periodic along the walls alone */
static inline int in_slab(const climber *row)
{
  return row->edge > 0.0 && row->wall;
}

static inline double side_of(const climber *row)
{
  return row->edge > 0.0 ? 0.9 * row->edge : row->ratio > 1.0 ? 50.0 : 7.0;
}

/* --- matrices --- */

static inline int numbers_of(const cast *s)
{
  return s->width * s->n;
}

/* What a push is measured by: of number k of the cast, 1 over its velocity alone */
static inline double drag_of(const cast *s, int k)
{
  const int i = k / s->width;
  const double a = s->a[i], eta = eta_of(s, i, i);
  return k % s->width < 3 ? 6.0 * SD_PI * eta * a : 8.0 * SD_PI * eta * a * a * a;
}

/* [n n] the engine's part and each sphere's own, by products */
static inline double *matrix_of_spheres(const climber *row, const cast *s)
{
  const int n = numbers_of(s);
  double *A = malloc(sizeof(double) * (size_t) n * (size_t) n), *F = calloc(2 * (size_t) n, sizeof(double)), *u = F + n;
  alone e;
  place_alone(&e, row, s);
  for (int q = 0; q < n; q++) {
    F[q] = 1.0;
    assert_int_equal(sd_mobility_apply(&e.p.m, F, u), SD_OK);
    F[q] = 0.0;
    for (int p = 0; p < n; p++) A[(size_t) p * (size_t) n + (size_t) q] = u[p];
    A[(size_t) q * (size_t) (n + 1)] += 1.0 / drag_of(s, q);
  }
  free_alone(&e);
  free(F);
  return A;
}

/* The same of spheres that are rigid shells of points: (K^T M^-1 K)^-1, M of all points with what each shell has in
   addition */
static inline double *matrix_of_shells(const climber *row, const cast *s)
{
  sd_multiblob m;
  assert_int_equal(sd_multiblob_create(row->shell, 1, &m), SD_OK);
  const int points = row->shell * s->n, N = 3 * points, n = 6 * s->n;
  static cast all;
  double *r = malloc(sizeof(double) * (size_t) N), *K = calloc((size_t) n * (size_t) N, sizeof(double));
  const sd_multiblob_spheres spheres = {s->x, s->a, NULL, NULL, s->n, NULL, NULL};
  all = (cast){.n = points, .width = 3};
  sd_multiblob_expand(&m, &spheres, r, all.x, all.a);
  for (int k = 0; k < points; k++) all.w[k] = s->w[k / row->shell];
  double *M = matrix_of_spheres(row, &all), *R = malloc(sizeof(double) * (size_t) n * (size_t) n);
  for (int i = 0; i < s->n; i++) { /* of viscosity 1: scaled on the way in and out */
    const double eta = eta_of(s, i, i);
    double *B = M + (size_t) (3 * row->shell * i) * (size_t) (N + 1);
    for (int p = 0; p < 3 * row->shell; p++)
      for (int q = 0; q < 3 * row->shell; q++) B[(size_t) p * (size_t) N + (size_t) q] *= eta;
    sd_multiblob_one_body_matrix(&m, s->a[i], r + 3 * row->shell * i, (size_t) N, B);
    for (int p = 0; p < 3 * row->shell; p++)
      for (int q = 0; q < 3 * row->shell; q++) B[(size_t) p * (size_t) N + (size_t) q] /= eta;
  }
  for (int j = 0; j < n; j++)
    for (int k = row->shell * (j / 6); k < row->shell * (j / 6 + 1); k++) {
      const double unit[3] = {j % 3 == 0, j % 3 == 1, j % 3 == 2};
      double *to = K + (size_t) j * (size_t) N + 3 * k;
      if (j % 6 < 3) memcpy(to, unit, sizeof(unit));
      else sd_cross(unit, r + 3 * k, to);
    }
  double *L = malloc(sizeof(double) * (size_t) n * (size_t) N);
  memcpy(L, K, sizeof(double) * (size_t) n * (size_t) N);
  assert_int_equal(sd_cholesky_solve(N, M, n, L), SD_OK);
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      double sum = 0.0;
      for (int k = 0; k < N; k++) sum += K[(size_t) i * (size_t) N + (size_t) k] * L[(size_t) j * (size_t) N + (size_t)
        k];
      R[(size_t) i * (size_t) n + (size_t) j] = sum;
    }
  assert_int_equal(sd_cholesky(n, R), SD_OK);
  assert_int_equal(sd_cholesky_inverse(n, R), SD_OK);
  free(r), free(K), free(M), free(L);
  return R;
}

/* Every number times the drags of both its spheres: 1 on the diagonal of lone ones. Rows and columns of the width of
   s */
static inline double *matrix(const climber *row, const cast *s)
{
  const int n = numbers_of(s), step = row->shell ? 6 : s->width, N = step * s->n;
  double *A = row->shell ? matrix_of_shells(row, s) : matrix_of_spheres(row, s),
         *S = malloc(sizeof(double) * (size_t) n * (size_t) n);
  for (int p = 0; p < n; p++)
    for (int q = 0; q < n; q++) {
      const int P = step * (p / s->width) + p % s->width, Q = step * (q / s->width) + q % s->width;
      S[p * n + q] = A[(size_t) P * (size_t) N + (size_t) Q] * sqrt(drag_of(s, p) * drag_of(s, q));
    }
  free(A);
  return S;
}

/* Least eigenvalue of the symmetric S [n n], to 1e-4 of its value or to 1e-6 */
static inline double least_eigenvalue(const double *S, int n)
{
  double *A = malloc(sizeof(double) * (size_t) n * (size_t) n), lo = -20.0, hi = 20.0;
  while (hi - lo > 1e-6 && hi - lo > 1e-4 * fabs(lo)) {
    const double middle = 0.5 * (lo + hi);
    memcpy(A, S, sizeof(double) * (size_t) n * (size_t) n);
    if (positive_definite(A, n, middle)) lo = middle;
    else hi = middle;
  }
  free(A);
  return lo;
}

/* Along a floor or a slit, with images */
static inline void expected_in_slab(const climber *row, const cast *s, int i, int j, double M[9])
{
  const double eta = eta_of(s, i, j), *p = s->x + 3 * i, *q = s->x + 3 * j;
  const double above[2][3] = {{p[0], p[1], p[2] - wall_at}, {q[0], q[1], q[2] - wall_at}};
  const pair_above pair = {above[0], above[1], s->a[i], s->a[j], i != j};
  if (row->height > 0.0) slit_tensor(&pair, eta, row->edge, row->height, M);
  if (row->no_flux) stop_flux(&pair, eta, row->edge, row->height, M);
  if (row->height > 0.0) return;
  floor_tensor(&pair, eta, row->edge, M);
}

/* What a pair should be in the boundary of the row, velocity of i from the force on j; i = j: of one with its own
   images, in a box */
static inline void expected(const climber *row, const cast *s, int i, int j, double M[9])
{
  double r[3], edge[3][3], B[9];
  for (int d = 0; d < 3; d++) r[d] = s->x[3 * i + d] - s->x[3 * j + d];
  const double R = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]), eta = eta_of(s, i, j);
  if (in_slab(row)) {
    expected_in_slab(row, s, i, j, M);
    return;
  }
  if (row->edge > 0.0) {
    const sd_ewald_box box = box_of(row, s);
    periodic_edges(&box, edge);
    periodic_tensor(r, s->a[i], s->a[j], eta, edge, i == j, M);
    return;
  }
  pair_tensor(r, s->a[i], s->a[j], eta, M);
  const sd_wall wall = wall_of(row);
  if (row->wall) sd_wall_block(&wall, 3, s->x + 3 * i, s->a[i], s->x + 3 * j, s->a[j], B);
  for (int e = 0; e < 9 && row->wall; e++) M[e] += B[e] / eta;
  const double q = R / row->cut, taper = row->taper ? pow(1.0 - q, 4) * (1.0 + 4.0 * q) : 1.0;
  for (int e = 0; e < 9; e++) M[e] *= row->cut > 0.0 && q >= 1.0 ? 0.0 : taper;
}

/* Of the blocks of all pairs, over the velocity of the pushed sphere alone */
static inline double error_of_pairs(const climber *row, const cast *s)
{
  double *S = matrix(row, s), M[9], worst = 0.0;
  for (int i = 0; i < s->n; i++)
    for (int j = 0; j < s->n; j++) {
      if (i == j) continue;
      const double scale = sqrt(drag_of(s, s->width * i) * drag_of(s, s->width * j));
      expected(row, s, i, j, M);
      for (int e = 0; e < 9; e++) {
        const int p = s->width * i + e / 3, q = s->width * j + e % 3;
        worst = fmax(worst, fabs(S[p * numbers_of(s) + q] - M[e] * scale));
      }
    }
  free(S);
  return worst;
}

#endif
