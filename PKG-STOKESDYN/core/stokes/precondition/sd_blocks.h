/* One block per clump, a preconditioner (sd_precondition.h).
 *
 * P is the inverse of C of each clump alone, and D for spheres in no block. Memory and time of an
 * application: (width m)^2 numbers for a clump of m spheres; set-up m^3.
 *
 * Its root, for whoever needs random numbers of covariance P: with C = L L^T of a block, which is
 * what sd_blocks_make has before it inverts, D^1/2 L^-T times independent numbers of variance 1.
 *
 * Parts: block k is made and applied by part k % parts.
 * Zero-initialise; sd_blocks_free in the end. */
#ifndef SD_BLOCKS_H
#define SD_BLOCKS_H

#include "sd_precondition.h"

typedef struct {
  int n, width;
  int part, parts;
  int blocks;
  /* [blocks + 1] into member; the spheres of each block */
  long *first;
  int *member;
  /* [n] is the sphere in no block? */
  char *lone;
  /* [blocks + 1] into inverse; (width m)^2 numbers of each block of this part */
  long *start;
  double *inverse;
  /* [2n] sd_unit_roots */
  double *root;
  double *scratch;
  const struct sd_blocks_kernels *kernels;
} sd_blocks;

/* blocks: an sd_blocks */
void sd_blocks_free(void *blocks);

/* As of sd_precondition_kind. Spheres at one point make a block singular: it is then made definite
 * by a small diagonal. */
sd_status sd_blocks_make(void *blocks, const sd_precondition_case *c);

/* z = P r (this part's share) in the signature of sd_precondition: ctx is an sd_blocks. */
sd_status sd_blocks_apply(void *ctx, const double *r, double *z);

/* out = P in, in the rows of block k: [width m][count] numbers each */
void sd_blocks_multiply(const sd_blocks *b, int k, int count, const double *in, double *out);

#endif
