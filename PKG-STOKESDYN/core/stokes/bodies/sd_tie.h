/* Bodies tied to one another by lubrication L (sd_lubrication.h): the sparse system of the
 * preconditioner of sd_bodies.h,
 *
 *   H V = H_0 V_0 - K^T X r,   H = H_0 + K^T (X + L) K,   H_0: the resistances of bodies alone
 *
 * X: sd_tie_approach.h; r the slip for which V_0 is the velocity of bodies alone. Solved by
 * conjugate gradients within those for the forces, since a product with L is cheap beside one with
 * the mobility. Their preconditioner is an incomplete factor of H where pairs are stiff; what is
 * left couples weakly, so that the number of products does not depend on the gaps. Each rank has
 * the factor of all of them: 18 ms for 10^4 spheres at a volume fraction of 0.3. */
#ifndef SD_TIE_H
#define SD_TIE_H

#include "sd_tie_factor.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where A and A->tie->L stand now. On all ranks together. SD_OK; SD_ENOMEMORY; SD_ESINGULAR,
 * SD_ENOTFINITE; that of a function of the caller. */
sd_status sd_tie_make(const sd_bodies *A);

/* V from V_0 and r (rows, NULL: 0), until what H V lacks of the right side is below `tolerance` of
 * that; share (rows) = X (r + K V), and borne (by bodies) = K^T (L K V + share): what a body bears
 * less than alone. Clumps of several ranks have theirs on each of them. SD_OK, also where as many
 * products as are allowed leave more; SD_EINDEFINITE; SD_ENOTFINITE; as sd_tie_make. */
sd_status sd_tie_solve(const sd_bodies *A, const double *V_0, const double *r, double tolerance,
                       double *V, double *borne, double *share);
void sd_tie_free(sd_tie *t);

#ifdef __cplusplus
}
#endif
#endif
