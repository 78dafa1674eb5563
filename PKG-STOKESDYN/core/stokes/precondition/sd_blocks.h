/* One block per clump, a preconditioner (sd_precondition.h).
 *
 * B: the inverse of C of each clump alone. Memory and time of an application: (width m)^2 numbers
 * for a clump of m spheres; set-up m^3. A clump that moves as a rigid body keeps its block: only
 * its turn changes. Spheres in no block have D.
 *
 * Coupled blocks add what the clumps do to one another as wholes. With W the rigid translations of
 * the clumps and S = W^T B W their friction, the clumps' velocities as lone bodies, S^-1 W^T B r,
 * go through the sparse factor Q of a cloud with one sphere of equal friction for each clump:
 *   P = B - B W S^-1 W^T B + B W S^-1 Q S^-1 W^T B
 * By Woodbury's identity this is the inverse of (blocks + W G W^T), G the pair tensor of those
 * spheres, when Q is exact. The first two terms are a projection of B, so P is positive definite
 * with any positive definite Q, also with one of clumps that stood elsewhere or had other blocks.
 *
 * Parts: block k is made and applied by part k % parts. What couples them, rigid and mobility, is
 * then known to all.
 * Zero-initialise; sd_blocks_free in the end. */
#ifndef SD_BLOCKS_H
#define SD_BLOCKS_H

#include "sd_precondition_case.h"
#include "sd_shape.h"
#include "sd_sparse.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  int n, width;
  int part, parts;
  int blocks;
  /* [blocks + 1] into member; the spheres of each block */
  long *first;
  int *member;
  /* [n] is the sphere in no block? */
  char *lone;
  /* [blocks + 1] into inverse; (width m)^2 numbers of each block */
  long *start;
  double *inverse;
  /* [9 blocks] row-major: from the axes at set-up to those of now */
  double *turn;
  /* [2n] sd_unit_roots, at set-up */
  double *root;
  /* [3 width per member] B W, in the axes at set-up; [9 blocks] S^-1, likewise */
  double *rigid, *mobility;
  /* [blocks] of blocks that may move: at set-up. NULL: they may not */
  sd_shape *shape;
  /* Q. far.n == 0: not coupled */
  sd_sparse far;
  double *scratch;
} sd_blocks;

void sd_blocks_free(sd_blocks *b);

/* As of sd_precondition_kind. Spheres at one point make a block singular: it is then made definite
 * by a small diagonal. Blocks that cannot be coupled are left uncoupled, on all ranks. */
sd_status sd_blocks_make(sd_blocks *b, const sd_precondition_case *c);

/* Turns the blocks, renews those of clumps that have bent, couples them where they are now. */
sd_status sd_blocks_move(sd_blocks *b, const sd_precondition_case *c);

/* z = P r (this part's share) in the signature of sd_precondition: ctx is an sd_blocks. */
sd_status sd_blocks_apply(void *ctx, const double *r, double *z);

/* --- what sd_blocks_make and _move are made of ------------------------------------------------ */

/* out = B in, in the rows of block k at set-up: [width m][count] numbers each */
void sd_blocks_multiply(const sd_blocks *b, int k, int count, const double *in, double *out);

/* Block k anew, of its spheres as they stand now. On failure b is of no use but to
 * sd_blocks_free. */
sd_status sd_blocks_renew(sd_blocks *b, const sd_precondition_case *c, int k);

/* The clump of this block has turned by the rotation matrix R [9], row-major, since its set-up. */
void sd_blocks_turn(sd_blocks *b, int block, const double *R);

/* Couple the blocks, or couple them again where the clumps stand now, by a factor of reach c->rho.
 * Lone spheres in blocks of one take part. SD_OK; SD_ENOMEMORY; SD_EINDEFINITE; SD_ENOTFINITE. On
 * failure, which may be this part's alone, b is not coupled. */
sd_status sd_blocks_couple(sd_blocks *b, const sd_precondition_case *c);

#ifdef __cplusplus
}
#endif
#endif
