/* Smallest eigenvalue of the mobility scaled to unit diagonal, which limits the time step of explicit integration. */
#ifndef SD_SMALLEST_H
#define SD_SMALLEST_H

#include "sd_solve.h"

#ifdef __cplusplus
extern "C" {
#endif

/* M v = lambda D^-1 v, the system of sd_solve.h, by locally optimal preconditioned conjugate gradients (Knyazev, SIAM J. Sci.
 * Comput. 23, 517 (2001)): the next v has the smallest Rayleigh quotient v.Mv / v.D^-1 v in the span of v, of P times its residual
 * and of the last step. With a good P a few products are enough, as in a solve.
 *   v [width n]   in: any vector with a share of every eigenvector, as random numbers have; out: the eigenvector, v.D^-1 v = 1
 *   accuracy      stops when an eigenvalue lies within lambda (1 +- accuracy); lambda itself is nearer
 *   work          [SD_SOLVE_WORK(n, width)]
 *   lambda        out, never below the smallest eigenvalue but for rounding; negative: M is not positive definite
 * One call of sum a product. SD_OK; SD_EMAXITER: max_products were not enough, lambda is the best so far; SD_ENOTFINITE;
 * that of a function of the caller which has failed. */
sd_status sd_smallest_eigenvalue(const sd_system *A, double accuracy, int max_products, double *v,
                                 double *work, double *lambda, int *products);

#ifdef __cplusplus
}
#endif
#endif
