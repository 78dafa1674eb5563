/* Spheres of a scene as bodies that all rest in a fluid that moves with the slip: the resistance problem of sd_solve.h
 * by sd_bodies.h. */
#ifndef RESTING_H
#define RESTING_H

#include "scene.h"

#include "sd_bodies.h"

/* F [3 n]: in, a guess if warm; out, the forces of the fluid. Returns the products. */
static inline int resting_solve(scene *s, const double *slip, int warm, double tolerance, double *F)
{
  const size_t n = (size_t) s->n, size = 3 * n;
  int *row = calloc(n + 1, sizeof(int));
  char *held = calloc(n + 1, 1);
  double *D = malloc(sizeof(double) * size), *load = calloc(size, sizeof(double));
  double *l = malloc(sizeof(double) * size), *V = malloc(sizeof(double) * 6 * n);
  double *v = malloc(sizeof(double) * size), *exerted = malloc(sizeof(double) * size);
  for (size_t i = 0; i < n; i++) {
    row[i] = (int) i;
    held[i] = SD_BODY_HELD;
  }
  for (size_t j = 0; j < size; j++) {
    D[j] = s->drag[j / 3];
    l[j] = -F[j];
  }
  const sd_bodies A = {.lone = s->n,
                       .loner = row,
                       .known = held,
                       .spheres = {s->n, 3, row, NULL},
                       .points = {s->n, 3, NULL, NULL},
                       .D = D,
                       .apply = scene_apply,
                       .apply_ctx = s};
  const sd_bodies_problem problem = {slip, load, NULL, warm, tolerance, 3000};
  const sd_bodies_answer answer = {l, NULL, V, v, exerted};
  double *work = malloc(sizeof(double) * (size_t) sd_bodies_work(&A));
  sd_bodies_report report;
  assert_int_equal(sd_bodies_solve(&A, &problem, &answer, work, &report), SD_OK);
  for (size_t j = 0; j < size; j++) F[j] = -exerted[j];
  void *const all[] = {row, held, D, load, l, V, v, exerted, work};
  for (int k = 0; k < 9; k++) free(all[k]);
  return report.products;
}

/* |D (s - M F)| / |D s|, as sd_solve.h has it */
static inline double resting_residual(scene *s, const double *slip, const double *F)
{
  double *u = malloc(sizeof(double) * 3 * (size_t) s->n), left = 0.0, all = 0.0;
  scene_apply(s, F, u);
  for (int j = 0; j < 3 * s->n; j++) {
    const double D = s->drag[j / 3], r = D * (slip[j] - u[j]) - F[j];
    left += r * r;
    all += D * slip[j] * D * slip[j];
  }
  free(u);
  return sqrt(left / all);
}

/* The fewest products with which resting bodies reach that residual, whatever their own tolerance has to be for it; F
 * as above, for every try */
static inline int resting_to_residual(scene *s, const double *slip, const double *guess, double residual, double *F)
{
  int products = 0;
  for (double tolerance = 1.0; tolerance > 1e-10; tolerance *= 0.8) {
    for (int j = 0; j < 3 * s->n; j++) F[j] = guess ? guess[j] : 0.0;
    products = resting_solve(s, slip, guess != NULL, tolerance, F);
    if (resting_residual(s, slip, F) <= residual) break;
  }
  return products;
}

#endif
