/* Sparse inverse Cholesky factor, a preconditioner (sd_precondition.h): C^-1 = L L^T nearly, with L
 * from local solves (Schaefer, Katzfuss & Owhadi, SIAM J. Sci. Comput. 43, A2019 (2021)).
 *
 * The spheres are put in order, each the one farthest from all before it, at the distance l_i;
 * sphere i sees those before it that are nearer than rho l_i, and its columns of L are the last
 * ones of the inverse Cholesky factor of their C. Among all matrices L of this sparsity it is the
 * one nearest to C^-1 in the Kullback-Leibler sense. L L^T is positive definite whatever the
 * rounding. rho 2, 3, 4:
 * about 14, 42, 93 blocks per sphere in a compact cloud. It stays good while spheres move less than a
 * radius or so. Parts: spheres i in this order with i % parts == part have their columns made and
 * applied; the sum of z over the parts is P r.
 * What it is worth, in free clouds with inertia (unittest/bench/precondition_auto.py): where solves
 * start from the last ones and end at 1e-3, the default, 0.4 to 0.6 products a step in place of 1 to
 * 3, and the time of a run over that without is 0.8 to 1.0; of 50 flocs of 20 spheres 0.4 products
 * in place of 4, and 0.7 to 0.84 of the time that blocks of flocs take. To 1e-6, 1.8 in place of 14
 * and about 0.7 of the time; from nothing to 1e-6, 15 in place of 40 and 0.7, with torques 0.5.
 * Zero-initialise. */
#ifndef SD_SPARSE_H
#define SD_SPARSE_H

#include "sd_order.h"
#include "sd_precondition.h"

typedef struct {
  int n, width;
  int part, parts;
  /* of this part; the first of each column of blocks is its own sphere */
  sd_rows rows;
  /* Blocks, as floats: L L^T is exactly symmetric with rounded L too, and half the bytes are
   * read. */
  float *value;
  /* [2n] sd_unit_roots */
  double *root;
  double *scratch;
} sd_sparse;

/* factor: an sd_sparse */
void sd_sparse_free(void *factor);

/* Of the law and the spheres of c, this rank alone. SD_OK; SD_ENOMEMORY; SD_EINDEFINITE: a hard cut-off in
 * the law's place; SD_ENOTFINITE. On failure f is empty. */
sd_status sd_sparse_create(sd_sparse *f, const sd_precondition_case *c, double rho);

/* z = P r (this part's share), in the signature of sd_precondition: ctx is an sd_sparse. */
sd_status sd_sparse_apply(void *ctx, const double *r, double *z);

#endif
