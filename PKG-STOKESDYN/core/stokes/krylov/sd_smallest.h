/* Smallest eigenvalue of the mobility, weighed: the limit of explicit time steps. */
#ifndef SD_SMALLEST_H
#define SD_SMALLEST_H

#include "sd_solve.h"

#ifdef __cplusplus
extern "C" {
#endif

/* M v = mu W^-1 v, M of sd_solve.h and W a positive diagonal, by locally optimal preconditioned
 * conjugate gradients (Knyazev, SIAM J. Sci. Comput. 23, 517 (2001)): the next v has the smallest
 * Rayleigh quotient v.Mv / v.W^-1 v in the span of v, of P times its residual and of the last step.
 * With a good P a few products are enough, as in a solve.
 *   weight     [width n] W; NULL: D, then mu is the smallest eigenvalue of the mobility scaled to
 *              unit diagonal. With W the inertia of each row, W dU/dt = F = -M^-1 U: velocities of
 *              spheres that are let go die at rates of which 1/mu is the fastest, and explicit
 *              steps of them are stable up to dt = 2 mu
 *   accuracy   stops when an eigenvalue lies within mu (1 +- accuracy); mu itself is nearer
 *   v          [width n] in: any vector with a share of every eigenvector, as random numbers have;
 *              out: the eigenvector, v.W^-1 v = 1
 *   work       [SD_SOLVE_WORK(n, width)]
 *   mu         out, never below the smallest eigenvalue but for rounding; negative: M is not
 *              positive definite
 * One call of sum a product. SD_OK; SD_EMAXITER: max_products were not enough, mu is the best so
 * far; SD_ENOTFINITE; that of a function of the caller which has failed. */
sd_status sd_smallest_eigenvalue(const sd_system *A, const double *weight, double accuracy,
                                 int max_products, double *v, double *work, double *mu,
                                 int *products);

#ifdef __cplusplus
}
#endif
#endif
