/* Incomplete Cholesky factor of a symmetric positive definite matrix of 6x6 blocks: P = C C^T near
 * A, to precondition with.
 *
 * Nodes are eliminated in the order of fewest neighbours left, so that chains, trees and small
 * clusters have no fill at all. Fill is left out where its block has a norm below `drop`, and that
 * norm is added to the diagonals of its two nodes instead: then P >= A whatever is left out, no
 * pivot can fail, and A >= 1 gives P <= A (1 + drop x what a node has lost). drop 0: P = A.
 * Made in double and applied in single precision, which a preconditioner has no need of more than.
 * Source: Ajiz & Jennings, Int. J. Numer. Methods Eng. 20, 949 (1984), here for blocks. */
#ifndef SD_BLOCK_CHOLESKY_H
#define SD_BLOCK_CHOLESKY_H

#include "sd_status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { SD_BLOCK_LANES = 8 };

/* Zero-initialise; made again with the memory that it has; sd_block_cholesky_free in the end. */
typedef struct {
  int n;
  /* [n] nodes in the order of elimination; [n + 1] into entry: their columns */
  int *order;
  long *first;
  /* of the columns: row, and which block holds it */
  int (*entry)[2];
  /* [36 n] lower factors of the pivots, by node; [36 blocks] */
  double *pivot, *block;
  /* What is applied, in the order of elimination: inverses of the pivots' factors, blocks of the
   * columns; a column of 6 takes SD_BLOCK_LANES numbers. And the vector, by nodes */
  float *inverse, *column, *vector;
  /* what the elimination works with */
  struct sd_elimination *work;
} sd_block_cholesky;

/* diagonal [36 n]; A_pq = block + 36 k for pair[k] = (p, q), p != q: one of p, q and q, p, and all
 * that are given for one pair are added up. SD_OK; SD_ENOMEMORY; SD_ESINGULAR: A is not positive
 * definite. */
sd_status sd_block_cholesky_make(sd_block_cholesky *f, int n, const double *diagonal, long count,
                                 const int (*pair)[2], const double *block, double drop);
/* x [6n] becomes P^-1 x */
void sd_block_cholesky_apply(const sd_block_cholesky *f, double *x);
void sd_block_cholesky_free(sd_block_cholesky *f);

#ifdef __cplusplus
}
#endif
#endif
