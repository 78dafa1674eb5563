/* Bodies tied to one another by lubrication L between their spheres (sd_lubrication.h): the sparse
 * system of the preconditioner of sd_bodies.h,
 *
 *   H V = g - K^T X r,   H = H_0 + K^T (X + L) K,   H_0 = N^-1: the resistances of bodies alone
 *
 * K: rows on bodies; g: what is left of the loads; X: what the model itself resists beside the
 * bodies' own (sd_tie_approach.h); 0 for points on spheres that have no faces. Solved by conjugate gradients
 * within those for the forces, since a product with L is cheap beside one with the mobility. Their
 * preconditioner is an incomplete factor of H where pairs are stiff (sd_tie_factor.h); what is left
 * couples weakly, so that the number of products does not depend on the gaps. Held bodies keep
 * their V. */
#ifndef SD_TIE_H
#define SD_TIE_H

#include "sd_tied.h"

SD_BEGIN_C

/* Where A and A->tie->L stand now. room: scratch. On all ranks together, which agree on failures. SD_OK;
 * SD_ENOMEMORY; SD_ESINGULAR, SD_ENOTFINITE; that of a function of the caller. */
sd_status sd_tie_make(const sd_bodies *A, sd_tie_room room);

typedef struct {
  /* [6 bodies]; rows, NULL: 0 */
  const double *g, *r;
  /* what H V may lack of the right side, over that */
  double tolerance;
  /* are some velocities of held bodies not 0? */
  int moved;
} sd_tie_problem;
/* V [6 bodies]: on entry velocities of the held bodies, and 0 elsewhere. Bodies that nobody is near to keep
 * V = 0. borne = K^T (L K V + X (r + K V)): what a body bears less than alone. room: scratch. SD_OK, also
 * where as many products as are allowed leave more; as sd_cg.h and sd_tie_make. */
sd_status sd_tie_solve(const sd_bodies *A, const sd_tie_problem *problem, sd_tie_room room, double *V,
                       double *borne);
/* l (rows) += X (r + K V) of the last solution */
void sd_tie_share(const sd_bodies *A, double *l);
void sd_tie_free(sd_tie *t);

SD_END_C
#endif
