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

#include "sd_block_cholesky.h"
#include "sd_body.h"
#include "sd_lubrication.h"

SD_BEGIN_C

/* Zero-initialise, set L, whose rows are the spheres; sd_tie_free in the end. */
typedef struct sd_tie {
  sd_lubrication *L;
  /* products with L since sd_tie_make */
  long products;
  /* of the bodies of this rank and of `others`, those of other ranks that are near */
  sd_block_cholesky factor;
  int others;
  /* [6 (bodies + others)] 1 over the roots of the diagonal of H_0; 0: nobody is near to this body,
   * or this of its velocity is given */
  double *scale;
  /* [others] the copy, among the n_all - n of L, that stands for it */
  int *copy;
  /* X by pairs of L and those beyond, c; by spheres, L_ii and that of K^T X K together; what springs
   * see of faces and do to them [2 9 spheres], [9 others] */
  double *spring, *stiff, *face, *faces_there;
  /* scratch: by bodies, by bodies and others, by spheres, by copies */
  double *vectors, *all, *rows, *copies;
  size_t most_scales, most_copies, most_springs, most_stiff, most_vectors, most_all, most_rows,
      most_rows_there, most_faces, most_faces_there;
} sd_tie;

/* Where A and A->tie->L stand now. On all ranks together, which agree on failures. SD_OK;
 * SD_ENOMEMORY; SD_ESINGULAR, SD_ENOTFINITE; that of a function of the caller. */
sd_status sd_tie_make(const sd_bodies *A);

/* V [6 bodies] from g [6 bodies] and r (rows, NULL: 0), until what H V lacks of the right side is
 * below `tolerance` of that. V: on entry velocities of the held bodies, and 0 elsewhere; moved: some
 * are not 0. Bodies that nobody is near to keep V = 0. borne = K^T (L K V + X (r + K V)): what a body
 * bears less than alone; share (rows) = X (r + K V), not written where there are no springs. SD_OK,
 * also where as many products as are allowed leave more; as sd_cg.h and sd_tie_make. */
sd_status sd_tie_solve(const sd_bodies *A, const double *g, const double *r, double tolerance,
                       int moved, double *V, double *borne, double *share);
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
void sd_tie_free(sd_tie *t);

SD_END_C
#endif
