/* Bodies tied to one another by lubrication L (sd_lubrication.h): the sparse system of the
 * preconditioner of sd_bodies.h,
 *
 *   H V = H_0 V_0,   H = H_0 + K^T L K,   H_0: the resistances of the bodies alone
 *
 * by conjugate gradients within those for the forces, since a product with L is cheap beside one
 * with the mobility. Their preconditioner is an incomplete factor of H where pairs are stiff; what
 * is left couples weakly, so that the number of products does not depend on the gaps. Each rank
 * factors what it has: pairs of two ranks are in it on the diagonal alone. */
#ifndef SD_TIE_H
#define SD_TIE_H

#include "sd_block_cholesky.h"
#include "sd_bodies.h"
#include "sd_lubrication.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Vectors have 6 numbers a body: the free spheres in the order of loner, then the clumps: velocities
 * in space axes, U at the centroid. Zero-initialise, set L; sd_tie_free in the end. */
typedef struct sd_tie {
  sd_lubrication *L;
  sd_block_cholesky factor;
  /* products with L since sd_tie_make */
  long products;
  /* by numbers of bodies: 1 over the roots of the diagonal of H_0; scratch */
  double *scale, *vectors;
  /* by rows: scratch */
  double *rows, *ghosts;
  /* of the factor: blocks between bodies, by pairs */
  double *block;
  int (*pair)[2], *body, *place;
  long most_bodies, most_rows, most_ghosts, most_pairs;
} sd_tie;

/* Where A and A->tie->L stand now. On all ranks together. SD_OK; SD_ENOMEMORY; SD_ESINGULAR, SD_ENOTFINITE;
 * that of a function of the caller. */
sd_status sd_tie_make(const sd_bodies *A);

/* V from V_0, and LV = K^T L K V, until what H V lacks of H_0 V_0 is below `tolerance` of it. Clumps
 * of several ranks have theirs on each of them. SD_OK; SD_EMAXITER; SD_EINDEFINITE; SD_ENOTFINITE; as
 * sd_tie_make. */
sd_status sd_tie_solve(const sd_bodies *A, const double *V_0, double tolerance, double *V,
                       double *LV);
void sd_tie_free(sd_tie *t);

#ifdef __cplusplus
}
#endif
#endif
