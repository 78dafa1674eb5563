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
  sd_bodies A = flock_place(t->f, 6);
  A.tie = &t->tie;
  return flock_solve(t->f, &A, warm, tolerance, max_iter);
}

#endif
