/* Incomplete Cholesky factor of a symmetric positive definite matrix of 6x6 blocks: P = C C^T near
 * A, to precondition with.
 *
 * Nodes are eliminated in the order of fewest neighbours left, so that chains, trees and small
 * clusters have no fill at all. Fill is left out where its block has a norm below `drop`, and that
 * norm is added to the diagonals of its two nodes instead: then P >= A whatever is left out, and
 * A >= 1 gives P <= A (1 + drop x what a node has lost). drop 0: P = A.
 *
 * In single precision throughout, more than which a preconditioner has no need of: what rounding
 * takes from a diagonal is about its first value times 6e-8, and five times that is added to it
 * before, so that no pivot fails. In a system of 1 and stiffnesses of 1e6 that is a third of 1.
 *
 * Nodes may be put off. What the others leave of them, A_qq - A_qp A_pp^-1 A_pq, can then be read
 * and added to, as several ranks do that share these nodes, before they are eliminated as well.
 * Source: Ajiz & Jennings, Int. J. Numer. Methods Eng. 20, 949 (1984), here for blocks. */
#ifndef SD_BLOCK_CHOLESKY_H
#define SD_BLOCK_CHOLESKY_H

#include "sd_status.h"

SD_BEGIN_C

enum { SD_BLOCK_LANES = 8 };

/* Zero-initialise; made again with the memory that it has; sd_block_cholesky_free in the end. */
typedef struct {
  /* nodes; so many of them are not put off; so many, these first, are not left out */
  int n, early, factored;
  /* [n] nodes in the order of elimination, then those left out; [factored + 1] their columns; by entry of
   * a column: its node */
  int *order;
  long *first;
  int *row;
  /* In the order of elimination, blocks of [6][6]: inverses of the pivots' factors; the entries. Behind the
   * last ones stands at least one more row, since they are read in whole vectors. The vector that they are
   * applied to, [SD_BLOCK_LANES n] by nodes */
  float *inverse, *column, *vector;
  /* what the elimination works with */
  struct sd_elimination *work;
} sd_block_cholesky;

/* A = 0 of n nodes. SD_OK; SD_ENOMEMORY */
sd_status sd_block_cholesky_begin(sd_block_cholesky *f, int n);
/* A_pq += B, row-major, and A_qp += B^T; of p = q B, symmetric. SD_OK; SD_ENOMEMORY */
sd_status sd_block_cholesky_add(sd_block_cholesky *f, int p, int q, const double B[36]);
void sd_block_cholesky_put_off(sd_block_cholesky *f, int p);
/* Eliminates all that are not put off: what has been added is used up. SD_OK; SD_ENOMEMORY;
 * SD_ESINGULAR: A is not positive definite; SD_ENOTFINITE. */
sd_status sd_block_cholesky_factor(sd_block_cholesky *f, double drop);
/* Visits what that has left of node p, which was put off: q = p, with the fill it has lost, and each
 * q of `degree` with which it has a block. B [36] as in sd_block_cholesky_add */
typedef void sd_block_visit(void *ctx, int p, int q, const double B[36]);
int sd_block_cholesky_degree(const sd_block_cholesky *f, int p);
/* The k-th of these q */
int sd_block_cholesky_beside(const sd_block_cholesky *f, int p, int k);
void sd_block_cholesky_left(const sd_block_cholesky *f, int p, sd_block_visit *visit, void *ctx);
/* A node that was put off is not eliminated at all: it and its blocks are no more in the matrix. */
void sd_block_cholesky_leave_out(sd_block_cholesky *f, int p);
/* And those that are put off. Status as of sd_block_cholesky_factor */
sd_status sd_block_cholesky_finish(sd_block_cholesky *f, double drop);
/* x [6n] becomes P^-1 x */
void sd_block_cholesky_apply(const sd_block_cholesky *f, double *x);
/* The same in three parts, P^-1 = back middle forth, in which forth and its transpose back are 1 where
 * nodes are put off, and middle is about those of them that are not left out. x of all of them may change
 * on the way. */
void sd_block_cholesky_forth(const sd_block_cholesky *f, double *x);
void sd_block_cholesky_middle(const sd_block_cholesky *f, double *x);
void sd_block_cholesky_back(const sd_block_cholesky *f, double *x);
void sd_block_cholesky_free(sd_block_cholesky *f);

SD_END_C
#endif
