/* What the files of a tie share (sd_tie.h): its arrays, and who is tied. */
#ifndef SD_TIED_H
#define SD_TIED_H

#include "sd_block_cholesky.h"
#include "sd_body.h"
#include "sd_lubrication.h"

SD_BEGIN_C

/* Scratch that the caller lends, so many numbers of each body and each sphere; nothing is kept there. */
enum { SD_TIE_OF_BODY = 36, SD_TIE_OF_SPHERE = 12 };
typedef struct {
  double *bodies, *spheres;
} sd_tie_room;

/* A body of another rank: whose, and its number there */
typedef struct {
  int rank, body;
} sd_tie_other;

/* The bodies at borders between ranks (sd_tie_border.h) */
typedef struct {
  /* of the factor here, in ascending order */
  sd_tie_other *other;
  int others;
  /* does a stiff pair chain bodies together that more than two ranks share? The same on all of them */
  int severed;
  /* [bodies] W of sd_tie_factor.h; [shares] bodies of this rank where it is not 1 */
  double *weight;
  int *shared, shares;
  /* [lents] bodies of this rank in factors of others, for one rank after the other, -1: by rounding it is
   * not at this rank's border; [aways] those at borders that the factor here lacks. [ranks] so many
   * numbers of the first go to each rank, and so many of `others` come from it, 6 a body; [6 lents] room
   * for those that go */
  int *lent, *away, *lend, *borrow, lents, aways;
  double *sent;
  size_t most_weights, most_shared, most_others, most_lent, most_away, most_lend, most_borrow, most_sent;
} sd_tie_border;

/* X, what the model itself resists when spheres approach (sd_tie_approach.h) */
typedef struct {
  /* by pairs of L and those beyond, -c d d^T; by spheres, X_ii of translations, xx yy zz xy xz yz */
  double *c, *own;
  /* what springs see of spheres and do to them [2 9 spheres], and see of those of other ranks [9 others]; 6
   * where rows are spheres */
  double *seen, *there;
  size_t most_c, most_own, most_seen, most_there;
} sd_tie_springs;

/* Zero-initialise, set L, whose rows are the spheres, and `above`; sd_tie_free in the end. */
typedef struct sd_tie {
  sd_lubrication *L;
  /* [n_all - n of L] of the copies, 1: above this rank, 0: below. Of two ranks with a film across their
   * border one alone has the other's sphere above it. NULL: those of higher ranks are above */
  const double *above;
  /* products with L since sd_tie_make */
  long products;
  /* the power that the last solution of H V = g lacks, by the factor */
  double left;
  /* For sd_tie_make, the same on all ranks: is the factor of these bodies, with these numbers? Then it stays
   * where H has hardly changed (sd_tie_kept.h). And what came of it: was it made anew? */
  int keep, anew;
  /* of the bodies of this rank and of others at its borders (sd_tie_factor.h) */
  sd_block_cholesky factor;
  sd_tie_border border;
  sd_tie_springs springs;
  /* [6 bodies] translations in H_ii of then, scaled, when the factor was made: xx yy zz xy xz yz; of so many
   * bodies, -1: there is no factor */
  double *made_of;
  int made_for;
  /* [6 (bodies + others)] 1 over the roots of the diagonal of H_0; 0: nobody is near to this body,
   * or this of its velocity is given */
  double *scale;
  /* scratch: by bodies and others */
  double *all;
  size_t most_made_of, most_scales, most_all;
} sd_tie;

/* Do ranks share bodies at their borders? */
static inline int sd_tie_is_layered(const sd_bodies *A)
{
  const sd_world *world = &A->tie->L->world;
  return world->ranks > 1 && world->refresh && world->tell && world->exchange;
}
/* Is there an X? */
static inline int sd_tie_has_springs(const sd_bodies *A)
{
  return A->tie->L->model && (!A->points.whole || A->faces);
}
/* Is V of body b that of sd_tie_solve? */
static inline int sd_tie_binds(const sd_bodies *A, int b)
{
  const double *scale = A->tie->scale + 6 * (long) b; /* of a pinned one that of W alone is not 0 */
  return scale[0] != 0.0 || scale[3] != 0.0;
}

SD_END_C
#endif
