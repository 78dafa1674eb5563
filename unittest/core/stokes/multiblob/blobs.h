/* Spheres as shells of points, in full: the matrix of all points in open space or in a periodic
 * cube, the resistance of the spheres that follows from it, with films between them. */
#ifndef BLOBS_H
#define BLOBS_H

#include "check.h"

#include <string.h>

#include "two_spheres.h"
#include "ewald/periodic.h"

#include "sd_body_shape.h"
#include "sd_linear.h"
#include "sd_lubrication.h"
#include "sd_multiblob_points.h"

enum { BLOBS_MOST = 64 };

/* Images of spheres within the films' range, as ghosts */
typedef struct {
  int n, count;
  int owner[27 * BLOBS_MOST];
  int64_t body[27 * BLOBS_MOST];
  double drift[3 * 27 * BLOBS_MOST];
  double x[3 * 27 * BLOBS_MOST], a[27 * BLOBS_MOST], w[27 * BLOBS_MOST];
} blob_images;

typedef struct {
  sd_multiblob m;
  int n;
  /* rows, spheres' numbers */
  int N, size;
  double x[3 * BLOBS_MOST], a[BLOBS_MOST], w[BLOBS_MOST];
  int64_t body[BLOBS_MOST];
  sd_multiblob_mask mask[BLOBS_MOST];
  double turn[9 * BLOBS_MOST];
  /* r, x, b of the points; M [N N] and then its factor; M^-1 K [size][N]; K^T M^-1 K + L [size
   * size] and then its factor */
  double *r, *at, *b, *M, *forces, *R;
  double side;
  /* of the films */
  double floor;
  sd_lubrication L;
  sd_films films;
  /* what L asks for its ghosts */
  blob_images *images;
} blobs;

static inline blobs *blobs_create(int points, int one_body, int n, const double *x, const double *a)
{
  blobs *s = calloc(1, sizeof(blobs));
  assert_true(n <= BLOBS_MOST);
  assert_int_equal(sd_multiblob_create(points, one_body, &s->m), SD_OK);
  s->n = n, s->N = 3 * points * n, s->size = 6 * n;
  s->floor = 1e-3;
  memcpy(s->x, x, sizeof(double) * 3 * (size_t) n);
  for (int i = 0; i < n; i++) {
    s->a[i] = a ? a[i] : 1.0;
    s->w[i] = 1.0;
    s->mask[i] = sd_multiblob_whole(&s->m);
    for (int d = 0; d < 3; d++) s->turn[9 * i + 4 * d] = 1.0;
  }
  return s;
}

static inline void blobs_free(blobs *s)
{
  free(s->r), free(s->at), free(s->b), free(s->M), free(s->forces), free(s->R);
  sd_lubrication_free(&s->L);
  free(s->images);
  free(s);
}

static inline void blobs_expand(blobs *s)
{
  const size_t points = (size_t) s->N / 3;
  const sd_multiblob_spheres spheres = {s->x, s->a, s->turn, s->mask, s->n, NULL, NULL};
  s->r = malloc(sizeof(double) * 3 * points), s->at = malloc(sizeof(double) * 3 * points);
  s->b = malloc(sizeof(double) * points),
  s->M = calloc((size_t) s->N * (size_t) s->N, sizeof(double));
  sd_multiblob_expand(&s->m, &spheres, s->r, s->at, s->b);
}

static inline void blobs_add_one_body(blobs *s)
{
  const sd_multiblob_spheres spheres = {s->x, s->a, s->turn, s->mask, s->n, NULL, NULL};
  const sd_multiblob_additions own_ones = {&s->m, spheres, s->w, s->r};
  double *f = calloc((size_t) s->N, sizeof(double)), *u = malloc(sizeof(double) * (size_t) s->N);
  const int own = 3 * s->m.n;
  for (int j = 0; j < own;
       j++) { /* the same number of all spheres at once: they do not know each other here */
    for (int i = 0; i < s->n; i++) f[own * i + j] = 1.0;
    memset(u, 0, sizeof(double) * (size_t) s->N);
    sd_multiblob_add(&own_ones, 0, s->n, f, u);
    for (int k = 0; k < s->N; k++)
      s->M[(size_t) k * (size_t) s->N + (size_t) (own * (k / own) + j)] += u[k];
    for (int i = 0; i < s->n; i++) f[own * i + j] = 0.0;
  }
  free(f), free(u);
}

/* Points that are left out: 1 on the diagonal, no force */
static inline void blobs_leave_out(blobs *s)
{
  for (int k = 0; k < s->N; k++) {
    if (s->b[k / 3] > 0.0) continue;
    for (int j = 0; j < s->N; j++)
      s->M[(size_t) k * (size_t) s->N + (size_t) j] =
          s->M[(size_t) j * (size_t) s->N + (size_t) k] = 0.0;
    s->M[(size_t) k * (size_t) (s->N + 1)] = 1.0;
  }
}

/* M in open space */
static inline void blobs_open(blobs *s)
{
  blobs_expand(s);
  sd_wall_matrix(NULL, s->N / 3, 3, s->at, s->b, s->M);
  blobs_leave_out(s);
  blobs_add_one_body(s);
}

/* M in a cube, by products of the engine with unit vectors */
static inline void blobs_periodic(blobs *s, double side, double tolerance)
{
  for (int k = 0; k < 3 * s->n; k++) s->x[k] -= side * floor(s->x[k] / side);
  blobs_expand(s);
  s->side = side;
  sd_ewald split;
  const sd_ewald_box box = {.periodic = 1, .edge = {side, side, side}};
  const sd_ewald_sizes sizes = periodic_sizes(s->b, s->N / 3);
  assert_int_equal(sd_ewald_choose(&box, &sizes, 3, tolerance, &split), SD_OK);
  for (int k = 0; k < s->N; k++) s->at[k] -= side * floor(s->at[k] / side);
  periodic p;
  periodic_place(&p, s->at, s->b, NULL, s->N / 3, 3, &split);
  double *f = calloc((size_t) s->N, sizeof(double)), *u = malloc(sizeof(double) * (size_t) s->N);
  for (int j = 0; j < s->N; j++) {
    f[j] = 1.0;
    assert_int_equal(sd_mobility_apply(&p.omega, f, u), SD_OK);
    f[j] = 0.0;
    for (int k = 0; k < s->N; k++) s->M[(size_t) k * (size_t) s->N + (size_t) j] = u[k];
    s->M[(size_t) j * (size_t) (s->N + 1)] += 1.0 / (6.0 * SD_PI * s->b[j / 3]);
  }
  for (int k = 0; k < s->N; k++) /* symmetric up to the engine's error */
    for (int j = 0; j < k; j++) {
      double *p1 = s->M + (size_t) k * (size_t) s->N + j,
             *p2 = s->M + (size_t) j * (size_t) s->N + k;
      *p1 = *p2 = 0.5 * (*p1 + *p2);
    }
  free(f), free(u);
  periodic_free(&p);
  blobs_add_one_body(s);
}

/* Column (i, e) of K, [N]: velocities of the points for one number of a sphere */
static inline void blobs_motion(const blobs *s, int i, int e, double *v)
{
  memset(v, 0, sizeof(double) * (size_t) s->N);
  for (int k = s->m.n * i; k < s->m.n * (i + 1); k++) {
    const double unit[3] = {e % 3 == 0, e % 3 == 1, e % 3 == 2};
    if (!(s->b[k] > 0.0)) continue;
    if (e < 3)
      memcpy(v + 3 * k, unit, sizeof unit);
    else
      sd_cross(unit, s->r + 3 * k, v + 3 * k);
  }
}

/* f [6 n] = K^T l */
static inline void blobs_collect(const blobs *s, const double *l, double *f)
{
  memset(f, 0, sizeof(double) * (size_t) s->size);
  for (int k = 0; k < s->N / 3; k++) {
    double t[3], *to = f + 6 * (k / s->m.n);
    sd_cross(s->r + 3 * k, l + 3 * k, t);
    for (int d = 0; d < 3; d++) {
      to[d] += l[3 * k + d];
      to[3 + d] += t[d];
    }
  }
}

static inline void blobs_factor(blobs *s)
{
  assert_int_equal(sd_cholesky(s->N, s->M), SD_OK);
}

/* R = K^T M^-1 K, of a factored M */
static inline void blobs_resistance(blobs *s)
{
  const size_t N = (size_t) s->N, size = (size_t) s->size;
  s->forces = malloc(sizeof(double) * N * size);
  s->R = malloc(sizeof(double) * size * size);
  for (int j = 0; j < s->size; j++) blobs_motion(s, j / 6, j % 6, s->forces + (size_t) j * N);
  sd_cholesky_apply(s->N, s->M, s->size, s->forces);
  for (size_t j = 0; j < size; j++) blobs_collect(s, s->forces + j * N, s->R + j * size);
}

static inline sd_status blobs_refresh(void *ctx, const double *rows, double *ghosts, int width)
{
  const blob_images *g = ctx;
  for (int k = g->n; k < g->count; k++)
    memcpy(ghosts + width * (k - g->n), rows + width * g->owner[k],
           sizeof(double) * (size_t) width);
  return SD_OK;
}

static inline blob_images *blobs_images(const blobs *s, double range, const double *gradient)
{
  blob_images *g = calloc(1, sizeof(blob_images));
  double largest = 0.0;
  for (int i = 0; i < s->n; i++) largest = fmax(largest, s->a[i]);
  const double reach = (2.0 + range) * largest;
  g->n = s->n;
  for (int shift = -1; shift < 27; shift++) {
    if (shift == 13 || (shift >= 0 && s->side == 0.0)) continue;
    const int at[3] = {shift < 0 ? 0 : shift % 3 - 1, shift < 0 ? 0 : shift / 3 % 3 - 1,
                       shift < 0 ? 0 : shift / 9 - 1};
    for (int i = 0; i < s->n; i++) {
      int near = 1;
      double *x = g->x + 3 * g->count;
      for (int d = 0; d < 3; d++) {
        x[d] = s->x[3 * i + d] + at[d] * s->side;
        near = near && (s->side == 0.0 || (x[d] > -reach && x[d] < s->side + reach));
      }
      if (!near) continue;
      g->a[g->count] = s->a[i], g->w[g->count] = 1.0, g->body[g->count] = s->body[i];
      const double moved[3] = {at[0] * s->side, at[1] * s->side, at[2] * s->side};
      if (gradient && shift >= 0) sd_multiply3(gradient, moved, g->drift + 3 * (g->count - s->n));
      g->owner[g->count++] = i;
    }
  }
  return g;
}

/* L of the films added to R; gradient NULL: 0 */
static inline void blobs_add_films(blobs *s, double range, const double *gradient)
{
  const int one_body = s->m.delta != 0.0;
  blob_images *g = blobs_images(s, range, gradient);
  free(s->images);
  s->images = g;
  const sd_two_sphere *functions = two_spheres(SD_FILM_LARGEST_RATIO);
  assert_int_equal(sd_films_create(s->m.n, one_body, functions, &s->films), SD_OK);
  const sd_lubrication_scene scene = {
      .functions = functions,
      .films = &s->films,
      .gap = s->floor,
      .range = range,
      .n = s->n,
      .n_all = g->count,
      .spheres = {g->x, g->a, g->w},
      .body = g->body,
      .drift = g->drift,
      .world = {.ctx = g, .refresh = s->side > 0.0 ? blobs_refresh : NULL},
      .noisy = 1};
  assert_int_equal(sd_lubrication_place(&s->L, &scene), SD_OK);
  double *V = calloc((size_t) s->size, sizeof(double)),
         *f = malloc(sizeof(double) * (size_t) s->size);
  for (int j = 0; j < s->size; j++) {
    V[j] = 1.0;
    assert_int_equal(sd_lubrication_apply(&s->L, V, f), SD_OK);
    V[j] = 0.0;
    for (int i = 0; i < s->size; i++) s->R[(size_t) j * (size_t) s->size + (size_t) i] += f[i];
  }
  free(V), free(f);
}

/* In open fluid, with films, for blobs_move: M and R are factored. */
static inline void blobs_ready(blobs *s, const double *gradient)
{
  blobs_open(s);
  blobs_factor(s);
  blobs_resistance(s);
  blobs_add_films(s, 1.0, gradient);
  assert_int_equal(sd_cholesky(s->size, s->R), SD_OK);
}

/* Velocities V [6 n] of the free spheres under F (NULL: none) in a flow of gradient G (NULL:
 * none), counted from it at each centre; S [6 n] first moments, with those of films. R is
 * factored; L was placed with the same G, or there is none. */
static inline void blobs_move(const blobs *s, const double *F, const double *G, double *V,
                              double *S)
{
  double *u = calloc((size_t) s->N, sizeof(double)), *l = malloc(sizeof(double) * (size_t) s->N);
  double *drag = malloc(sizeof(double) * (size_t) s->size);
  for (int k = 0; G && k < s->N / 3; k++) {
    double x[3];
    for (int d = 0; d < 3; d++) x[d] = s->x[3 * (k / s->m.n) + d] + s->r[3 * k + d];
    sd_multiply3(G, x, u + 3 * k);
  }
  for (int k = 0; k < s->N; k++)
    if (!(s->b[k / 3] > 0.0)) u[k] = 0.0;
  sd_cholesky_apply(s->N, s->M, 1, u);
  blobs_collect(s, u, drag);
  for (int j = 0; j < s->size; j++)
    V[j] = (F ? F[j] : 0.0) + drag[j] + (s->L.count ? s->L.carried[j] : 0.0);
  sd_cholesky_apply(s->size, s->R, 1, V);
  for (int k = 0; k < s->N; k++) l[k] = -u[k];
  for (int j = 0; j < s->size; j++)
    for (int k = 0; k < s->N; k++)
      l[k] += s->forces[(size_t) j * (size_t) s->N + (size_t) k] * V[j];
  if (S) {
    memset(S, 0, sizeof(double) * (size_t) s->size);
    for (int i = 0; i < s->n; i++)
      sd_multiblob_moment(s->m.n, s->r + 3 * s->m.n * i, l + 3 * s->m.n * i, S + 6 * i);
    if (s->L.count) assert_int_equal(sd_lubrication_stress(&s->L, V, S), SD_OK);
  }
  for (int i = 0; G && i < s->n; i++) {
    double flow[3];
    sd_multiply3(G, s->x + 3 * i, flow);
    for (int d = 0; d < 3; d++) V[6 * i + d] -= flow[d];
  }
  free(u), free(l), free(drag);
}

#endif
