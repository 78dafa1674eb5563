/* Conjugate gradients, preconditioned: the one loop under forces from velocities (sd_solve.h),
 * velocities from forces (sd_bodies.h), the films within these (sd_tie.h) and implicit friction of SPH
 * (sd_sph_implicit.h).
 *
 * A symmetric and positive definite on the space that the directions span, from x and r = b - A x:
 *
 *   z = P r;  stop?  p = z + beta p,  w = A p,  alpha = r.p / p.w,
 *   x += alpha p,  r -= alpha w,  z = P r,  beta = -w.z / p.w
 *
 * Where P is linear this beta is r.z over the r.z before. Where P is itself solved to a few digits
 * it makes the next direction conjugate to the last one all the same. Two sums over the ranks an
 * iteration.
 * Source: Golub & Van Loan, Matrix Computations; for beta Golub & Ye, SIAM J. Sci. Comput. 21, 1305
 * (1999). */
#ifndef SD_CG_H
#define SD_CG_H

#include "sd_status.h"
#include "sd_world.h"

SD_BEGIN_C

/* x, z, p have `size` numbers. The first `paired` of them meet r and w [paired] in inner products;
 * the others are what belongs to these (velocities, to forces) and goes along by the same steps. */
typedef struct {
  double *x, *z, *p, *r, *w;
} sd_cg_vectors;

/* Numbers of the stop rule that are summed with those of the loop */
enum { SD_CG_OWN = 4 };

/* Where the loop stands: after `steps` steps, r.z there; of the last step its length, p.w, r.p and
 * p.p in the norm of the caller; the next beta; the stop rule's own sums */
typedef struct {
  int steps;
  double rz, alpha, beta, pw, rp, pp, own[SD_CG_OWN];
} sd_cg_state;

/* All functions return SD_OK or why they failed, which ends the loop at once. */
typedef struct {
  long size, paired;
  void *ctx;
  /* w = A p */
  sd_status (*apply)(void *ctx, const double *p, double *w);
  /* z = P r */
  sd_status (*precondition)(void *ctx, const double *r, double *z);
  /* this rank's part of own [SD_CG_OWN], of x, z and r; NULL: 0 */
  void (*measure)(void *ctx, const sd_cg_vectors *v, double *own);
  /* sets *done to end the loop with what it returns; another status than SD_OK ends it as well */
  sd_status (*judge)(void *ctx, const sd_cg_state *now, int *done);
  /* this rank's part of p.p, by which p.w is judged; NULL: 0 */
  double (*square)(void *ctx, const double *p);
  const sd_world *world;
} sd_cg;

/* p.w below this part of p.p is rounding */
#define SD_CG_SINGULAR 1e-13

/* x and r as above on entry; state: where it ended. On all ranks together. That of judge;
 * SD_EINDEFINITE: p.w < 0; SD_ESINGULAR: p.w is 0 within the rounding of p.p: x and r are as before
 * this step; SD_ENOTFINITE; that of a function. */
sd_status sd_cg_run(const sd_cg *A, const sd_cg_vectors *v, sd_cg_state *state);

SD_END_C
#endif
