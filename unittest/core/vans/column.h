/* A column of water with all that a solve wants, grains at rest in none of it. */
#ifndef COLUMN_H
#define COLUMN_H

#include "check.h"

#include "sd_constants.h"
#include "sd_vans.h"

#include <string.h>

typedef struct {
  sd_vans_mesh mesh;
  double *edge, *phi, *vx, *b, *length, *U, *nut, *stress, *scratch, *moved, *shear;
  sd_vans_solver *solver;
} column;

static inline column *column_create(int N, double H, double stretch)
{
  column *c = calloc(1, sizeof *c);
  double **arrays[] = {&c->edge, &c->phi, &c->vx,     &c->b,     &c->length,
                       &c->U,    &c->nut, &c->stress, &c->moved, &c->shear};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
    *arrays[k] = calloc(N + 1, sizeof(double));
  c->scratch = calloc(4 * N + 4, sizeof(double));
  for (int j = 0; j <= N; j++) {
    const double s = (double) j / (N - 1);
    c->edge[j] = stretch > 0.0 ? H * s * (1.0 + stretch * s) / (1.0 + stretch) : j * (H / (N - 1));
  }
  c->mesh = (sd_vans_mesh){N, 0.0, stretch > 0.0 ? 0.0 : H / (N - 1), c->edge};
  c->solver = sd_vans_solver_create(&c->mesh);
  return c;
}

static inline void column_free(column *c)
{
  double *arrays[] = {c->edge, c->phi,    c->vx,      c->b,     c->length, c->U,
                      c->nut,  c->stress, c->scratch, c->moved, c->shear};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  sd_vans_solver_free(c->solver);
  free(c);
}

/* Mixing lengths; classes NULL: of one class of grains */
static inline void find_lengths(column *c, const sd_vans_fluid *fluid, const double *classes)
{
  const sd_vans_mixture now = {c->U, c->phi, classes, c->phi};
  sd_vans_mixing_length(&c->mesh, fluid, &now, c->length, c->scratch);
}

static inline void solve(column *c, const sd_vans_fluid *fluid, int64_t steps, double dt)
{
  find_lengths(c, fluid, NULL);
  const sd_vans_column column = {c->phi, c->vx, c->b, c->length, NULL};
  const sd_vans_flow flow = {c->U, c->nut, c->stress};
  assert_int_equal(sd_vans_solve(c->solver, fluid, &column, steps, dt, &flow, NULL), SD_OK);
}

#endif
