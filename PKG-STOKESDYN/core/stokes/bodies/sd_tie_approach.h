/* What the mobility itself resists of the approach of close spheres, for the preconditioner of
 * sd_tie.h. It belongs to the model of one point per sphere: spheres are rows.
 *
 * The blocks M_b know a sphere alone. Close spheres that are pressed together drive each other's
 * fluid away: by the model, a pair of equal ones that touch resists its approach 2.7 times as much
 * as their drags do, many that touch each other nine times. Lubrication makes such forces large, so
 * M_b is wrong where it matters, and the number of products grows with the density. So
 *
 *   M_b^-1 + X,   X = sum over pairs  c (d, -d) (d, -d)^T
 *
 * stands for M^-1: d the direction of the pair, c what it resists beyond its drags if it is alone
 * (sd_rpy_approach), fading from contact to the range of lubrication. X is as sparse as L and
 * positive semidefinite; it leaves the common motion of a pair, where M is large, to M_b. It takes
 * a quarter to a third off the products, and what is left depends little on c. */
#ifndef SD_TIE_APPROACH_H
#define SD_TIE_APPROACH_H

#include "sd_tie.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where A->tie->L stands now; without L->model X = 0. SD_OK or SD_ENOMEMORY */
sd_status sd_tie_approach_make(const sd_bodies *A);
/* out += X v, rows; those of other ranks are in A->tie->L->others */
void sd_tie_approach_add(const sd_bodies *A, const double *v, double *out);

#ifdef __cplusplus
}
#endif
#endif
