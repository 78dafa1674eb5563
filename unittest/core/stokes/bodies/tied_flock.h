/* A flock with lubrication between its bodies, for the tests of sd_tie.h. */
#ifndef TIED_FLOCK_H
#define TIED_FLOCK_H

#include "flock.h"

#include "lubrication/near_scene.h"

#include "sd_bodies.h"
#include "sd_tie.h"

/* The flock with lubrication between its spheres; clumps are bodies 1, 2, ... */
typedef struct {
  flock *f;
  near_scene near;
  sd_tie tie;
  double before[6 * FLOCK_MOST], force[6 * FLOCK_MOST];
} tied_flock;

static inline tied_flock *tie_flock(flock *f, double gap)
{
  tied_flock *t = calloc(1, sizeof(tied_flock));
  t->f = f;
  flock_place(f, 6);
  t->near = near_create(scene_create(f->n), 4.0, gap);
  for (int i = 0; i < f->n; i++) {
    scene_set(&t->near.s, i, f->x[3 * i], f->x[3 * i + 1], f->x[3 * i + 2], f->a[i], f->eta);
    t->near.body[i] = i < f->m * f->clumps ? 1 + i / f->m : 0;
  }
  t->near.u = f->u;
  near_place(&t->near);
  t->tie.L = &t->near.L;
  return t;
}

static inline void untie(tied_flock *t)
{
  sd_tie_free(&t->tie);
  near_free(&t->near);
  flock_free(t->f);
  free(t);
}

static inline sd_status tied_move(tied_flock *t, int warm, double tolerance, int max_iter)
{
  flock *f = t->f;
  sd_bodies A = flock_place(f, 6);
  A.tie = &t->tie;
  const sd_bodies_problem problem = {f->u, f->F, warm, tolerance, max_iter};
  const sd_bodies_motion motion = {f->l, f->v, f->V, t->before, t->force};
  double *work = malloc(sizeof(double) * (size_t) sd_bodies_work(&A));
  for (long j = 0; j < sd_bodies_work(&A); j++) work[j] = NAN; /* nobody may read it */
  const sd_status status = sd_bodies_velocities(&A, &problem, &motion, work, &f->report);
  free(work);
  return status;
}

#endif
