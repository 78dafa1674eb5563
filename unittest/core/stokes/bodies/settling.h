/* Free equal spheres with lubrication, all pairs on one rank, under a weight: for tests of sd_tie.h and
 * timings. */
#ifndef SETTLING_H
#define SETTLING_H

#include "lubrication/near_scene.h"

#include "sd_bodies.h"
#include "sd_constants.h"
#include "sd_tie.h"

typedef struct {
  near_scene near;
  sd_tie tie;
  sd_packed packed;
  sd_bodies A;
  /* rows */
  double *u, *F, *l, *v, *before, *exerted, *V, *D, *work;
  int *loner;
  sd_bodies_report report;
} settling;

static inline sd_status settling_product(void *ctx, const double *F, double *u)
{
  sd_packed_share(ctx, 0, 1, F, u);
  return SD_OK;
}

/* Where the spheres stand */
static inline void settling_place(settling *s)
{
  const sd_law law = {.tensor = SD_TENSOR_RPY};
  const sd_spheres spheres = {s->near.s.x, s->near.s.a, s->near.s.w};
  near_place(&s->near);
  assert_int_equal(sd_packed_all(&s->packed, SD_ISA_BEST, &law, &spheres, s->near.s.n, 6), SD_OK);
}

/* n spheres at volume fraction phi, hundreds of pairs nearer than 1e-3, gaps counted from `gap` on */
static inline settling *settling_create(int n, double phi, double gap)
{
  const double eta = 1.3;
  settling *s = calloc(1, sizeof(settling));
  s->near = near_create(cloud_dense(n, phi, 1.0, 1.0, eta, 7), 1.0, gap);
  settling_place(s);
  s->tie.L = &s->near.L;
  double **const rows[] = {&s->u, &s->F, &s->l, &s->v, &s->before, &s->exerted, &s->V, &s->D};
  for (int k = 0; k < 8; k++) *rows[k] = calloc(6 * (size_t) n, sizeof(double));
  s->loner = malloc(sizeof(int) * (size_t) n);
  for (int i = 0; i < n; i++) {
    for (int d = 0; d < 6; d++) s->D[6 * i + d] = (d < 3 ? 6.0 : 8.0) * SD_PI * eta;
    s->loner[i] = i;
    s->F[6 * i + 2] = -6.0 * SD_PI;
  }
  s->A = (sd_bodies){.lone = n,
                     .loner = s->loner,
                     .spheres = {n, 6, NULL, NULL},
                     .points = {n, 6, NULL, NULL},
                     .D = s->D,
                     .apply = settling_product,
                     .apply_ctx = &s->packed,
                     .tie = &s->tie};
  s->work = malloc(sizeof(double) * (size_t) sd_bodies_work(&s->A));
  return s;
}

/* Unlike forces and torques that add up to nothing, in place of the weight */
static inline void settling_shake(settling *s, uint64_t seed)
{
  double mean[6] = {0.0};
  for (int j = 0; j < 6 * s->A.lone; j++) {
    s->F[j] = uniform(&seed, -6.0 * SD_PI, 6.0 * SD_PI);
    mean[j % 6] += s->F[j] / s->A.lone;
  }
  for (int j = 0; j < 6 * s->A.lone; j++) s->F[j] -= mean[j % 6];
}

static inline void settling_solve(settling *s, int warm, double tolerance)
{
  const sd_bodies_answer answer = {s->l, s->before, s->V, s->v, s->exerted};
  const sd_bodies_problem problem = {s->u, s->F, NULL, warm, tolerance, 400};
  assert_int_equal(sd_bodies_solve(&s->A, &problem, &answer, s->work, &s->report), SD_OK);
}

/* |v - reference| / |reference| */
static inline double settling_error(const settling *s, const double *reference)
{
  double off = 0.0, all = 0.0;
  for (int j = 0; j < 6 * s->A.lone; j++) {
    off += pow(s->v[j] - reference[j], 2);
    all += pow(reference[j], 2);
  }
  return sqrt(off / all);
}

static inline void settling_free(settling *s)
{
  double *const rows[] = {s->u, s->F, s->l, s->v, s->before, s->exerted, s->V, s->D, s->work};
  for (int k = 0; k < 9; k++) free(rows[k]);
  free(s->loner);
  sd_packed_free(&s->packed);
  sd_tie_free(&s->tie);
  near_free(&s->near);
  free(s);
}

#endif
