/* Implicit friction. The forces F(u) of a step, explicit in the estimate u of the velocities, get what makes
 * friction that of the velocities at the end of the step: with K the matrix of friction (F_friction = - K u),
 * M of the masses and v the velocity that the step begins with,
 *   w = v + tau M^-1 [F(u) - K (w - u)],      (M/tau + K) (w - u) = F(u) + M/tau (v - u)
 * by conjugate gradients: K is symmetric and not negative, since each pair rubs by its difference of
 * velocities. - K (w - u) is opposite on the two of a pair, so momentum is exact however few steps are made.
 * Backward Euler: stable for every tau, first order in it; a steady flow, where w = u, is that of F.
 *
 * K is that of the plain scheme, whatever the scheme of F is: where w = u it does not matter, and otherwise
 * the step is stable as long as the true one has less than 1.5 K. A velocity that is given (walls, layers of
 * open ends: phase < 0) stays, and its pairs have twice the coefficient: a wall without slip shows the mirror
 * image, 2 v - u, which goes along when u changes. With K alone each step would overshoot by as much as it
 * was wrong. */
#ifndef SD_SPH_IMPLICIT_H
#define SD_SPH_IMPLICIT_H

#include "sd_sph_pair.h"
#include "sd_world.h"

SD_BEGIN_C

typedef struct {
  const sd_sph_model *model;
  const sd_sph_list *list;
  /* as for sd_sph_forces, with phase and mu; the last column of x4 is 0 */
  const sd_sph_particles *particles;
  /* particles 0 .. n - 1 are of this rank, m [n] their masses */
  int n;
  const double *m;
  double tau;
  /* of world only the sum is asked. forward: rows [4 (particles->n + 1)] of this rank to its ghosts; back:
   * those of ghosts are added to the owners'; ctx for both. NULL: there are none */
  const sd_world *world;
  void *ctx;
  void (*forward)(void *ctx, double *rows);
  void (*back)(void *ctx, double *rows);
} sd_sph_implicit;

/* How many numbers of scratch it needs. */
size_t sd_sph_implicit_size(const sd_sph_implicit *A);

/* Adds - K (w - u) to the forces F [3 n] (in: all that acts), of those with a given velocity as well, with v
 * and u [3 n]. more [4 (particles->n + 1)]: what was added, rows x y z and a number without meaning. more and
 * work begin with a cache line. steps: of the loop. The residual is 1e-8 of the right-hand side. SD_OK, or as
 * sd_cg_run. */
sd_status sd_sph_rub_implicitly(const sd_sph_implicit *A, const double *v, const double *u, double *F,
                                double *more, double *work, int *steps);

SD_END_C
#endif
