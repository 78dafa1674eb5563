/* The loop of sd_bodies.h as it stands, its preconditioner and its matrix-vector product. */
#ifndef SD_BODIES_LOOP_H
#define SD_BODIES_LOOP_H

#include "sd_bodies.h"
#include "sd_cg.h"
#include "sd_tied.h"

SD_BEGIN_C

/* What the loop goes by: what of r.z is rounding, and the power spent as it stands; what the bodies
 * would spend alone, the part of the loads' power that the flow has, and the power of slips that are
 * rounding */
typedef struct {
  double noise, spent, alone, carried, floor;
} sd_bodies_powers;

/* What comes of a guess: the loop goes on, r is to lose what V takes at once, or the guess is bad */
typedef enum { GO_ON, SETTLE, BEGIN_ANEW } sd_bodies_verdict;

typedef struct {
  const sd_bodies *A;
  const sd_bodies_problem *problem;
  /* x = (l, V), z = pre(r, 0), p: [rows + 6 bodies]; r, w: [rows]. w is the answer's l: x has the guess in
   * that from the start on, and the next one is left there when w has been used. Before the loop w is
   * scratch */
  sd_cg_vectors v;
  /* [6 bodies] the loads, and those with L V_inf, of the second line */
  double *loads, *f;
  /* scratch: spheres, twice; bodies, four times; of sd_bodies_alone */
  double *on_spheres, *bodies, *alone;
  /* [SD_TIE_OF_BODY bodies] scratch of a tie; NULL: forces have as many rows, and lend theirs */
  double *tied;
  /* hides: there are points that no body has, whose forces are 0; rests: u is 0, on all ranks, known once the
   * bodies have been for themselves; closer: the loop stopped to go on with a closer solution of the tie */
  int shells, guess_is_new, hides, rests, closer;
  sd_bodies_verdict verdict;
  /* of the tie's next solution, and the closest that one had to be in place of it, 1 if none had to */
  double tie_tolerance, closest;
  sd_bodies_powers power;
  sd_bodies_report *report;
} sd_bodies_loop;

/* Slips of this part of the velocities are rounding, whatever the tolerance. */
static const double sd_bodies_rounding = 1e-14;
/* How well the sparse system in the preconditioner is solved: what is left, of what there was. What
 * the first direction lacks must be made up by directions of its own, but what later ones lack is
 * as small as they are. So it is the first of these parts of sqrt(spent), at most the second of
 * what there is. That takes at most one product in ten more than exact solutions, to 1e-8 as well,
 * and half to three quarters of the products with L that 0.01 all the way takes.
 * Source: van den Eshof & Sleijpen, SIAM J. Matrix Anal. Appl. 26, 125 (2004). */
typedef struct {
  double first, loosest;
  /* that of a guess, and of a start from nothing: the loop takes up their errors */
  double guess, start;
} sd_bodies_accuracy;

/* That of this solve; and of pre(r, 0) where r.z is about so much */
const sd_bodies_accuracy *sd_bodies_accuracy_of(const sd_bodies_loop *c);
double sd_bodies_tie_tolerance(const sd_bodies_loop *c, double power);

static inline long sd_bodies_motions(const sd_bodies_loop *c)
{
  return 6 * (long) sd_bodies_count(c->A);
}

/* V behind the forces of a vector of the loop */
static inline double *sd_bodies_motion_of(const sd_bodies_loop *c, double *vector)
{
  return vector + sd_bodies_unknowns(c->A);
}

/* Scratch of a tie while forces l [rows], and on_spheres, hold nothing */
static inline sd_tie_room sd_bodies_lend(const sd_bodies_loop *c, double *l)
{
  return (sd_tie_room){c->tied ? c->tied : l, c->on_spheres};
}

/* pre(r, f): l, and V, which holds velocities of the held bodies on entry (moved: not all 0) and 0
 * elsewhere. l, and c->on_spheres, are the tie's scratch before. By the second line tied bodies bear L V
 * less, whatever digits V has. SD_OK or what the tie said. */
sd_status sd_bodies_pre(sd_bodies_loop *c, const double *r, const double *f, int moved, double *l, double *V);

/* w = M' l - K V of p = (l, V), counted as a product; the loop is ctx. SD_OK or what the engine said. */
sd_status sd_bodies_multiply(void *ctx, const double *p, double *w);

/* loads.V of what is not known of V */
double sd_bodies_spent(const sd_bodies_loop *c, const double *V);

SD_END_C
#endif
