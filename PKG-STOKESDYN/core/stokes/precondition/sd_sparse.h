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

/* width: 3, or with rotation 6. SD_OK; SD_ENOMEMORY; SD_EINDEFINITE: a hard cut-off in
 * the law's place; SD_ENOTFINITE. On failure f is empty. */
sd_status sd_sparse_create(sd_sparse *f, const sd_law *law, const sd_spheres *s, int n, int width,
                           double rho, int part, int parts);

/* z = P r (this part's share), in the signature of sd_precondition: ctx is an sd_sparse. */
sd_status sd_sparse_apply(void *ctx, const double *r, double *z);

#endif
