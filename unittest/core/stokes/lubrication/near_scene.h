/* Spheres with lubrication between them, on one rank, for the tests of sd_lubrication.h and sd_tie.h. */
#ifndef NEAR_SCENE_H
#define NEAR_SCENE_H

#include "clouds.h"
#include "two_spheres.h"

#include "sd_lubrication.h"
#include "sd_tensor.h"

#include <string.h>

typedef struct {
  scene s;
  const sd_two_sphere *functions;
  int64_t *body;
  /* of the fluid; NULL: it rests */
  const double *u;
  double gap, range;
  sd_lubrication L;
} near_scene;

static inline near_scene near_create(scene s, double largest_ratio, double gap)
{
  near_scene q = {.s = s, .functions = two_spheres(largest_ratio), .gap = gap, .range = 2.0};
  q.body = calloc((size_t) s.n + 1, sizeof(int64_t));
  return q;
}

static inline sd_lubrication_scene near_where(const near_scene *q)
{
  return (sd_lubrication_scene){.functions = q->functions,
                                .gap = q->gap,
                                .range = q->range,
                                .n = q->s.n,
                                .n_all = q->s.n,
                                .spheres = {q->s.x, q->s.a, q->s.w},
                                .body = q->body,
                                .u = q->u,
                                .noisy = 1};
}

static inline void near_place(near_scene *q)
{
  const sd_lubrication_scene where = near_where(q);
  assert_int_equal(sd_lubrication_place(&q->L, &where), SD_OK);
}

static inline void near_free(near_scene *q)
{
  sd_lubrication_free(&q->L);
  free(q->body);
  scene_free(&q->s);
}

/* L in full, [(6n)^2], by its products with unit vectors */
static inline double *near_dense(near_scene *q)
{
  const int N = 6 * q->s.n;
  double *L = malloc(sizeof(double) * (size_t) (N * N)), *unit = calloc((size_t) N, sizeof(double)),
         *column = malloc(sizeof(double) * (size_t) N);
  for (int j = 0; j < N; j++) {
    unit[j] = 1.0;
    assert_int_equal(sd_lubrication_apply(&q->L, unit, column), SD_OK);
    unit[j] = 0.0;
    for (int i = 0; i < N; i++) L[i * N + j] = column[i];
  }
  free(unit), free(column);
  return L;
}

/* The mobility with rotation in full, viscosity of all that of the first sphere */
static inline double *dense_mobility(const scene *s)
{
  const int n = s->n, N = 6 * n;
  const double eta = 1.0 / (s->w[0] * s->w[0]);
  double *M = malloc(sizeof(double) * (size_t) (N * N)), block[36];
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      const double *x = s->x + 3 * i, *y = s->x + 3 * j;
      const double r[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
      sd_tensor_grand(r, s->a[i], s->a[j], eta, block);
      for (int p = 0; p < 6; p++)
        for (int e = 0; e < 6; e++) M[(6 * i + p) * N + 6 * j + e] = block[6 * p + e];
    }
  return M;
}

#endif
