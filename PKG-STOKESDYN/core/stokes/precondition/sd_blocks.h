/* One block per clump, a preconditioner (sd_precondition.h).
 * B: the inverse of C of each clump alone. Memory and time of an application: (width m)^2 numbers for a clump of m spheres;
 * set-up m^3. A clump that moves as a rigid body keeps its block: only its turn changes.
 *
 * Coupled blocks add what the clumps do to one another as wholes. With W the rigid translations of the clumps and S = W^T B W
 * their friction, the clumps' velocities as lone bodies, S^-1 W^T B r, go through the sparse factor Q of a cloud with one
 * sphere of equal friction for each clump:
 *   P = B - B W S^-1 W^T B + B W S^-1 Q S^-1 W^T B
 * By Woodbury's identity this is the inverse of (blocks + W G W^T), G the pair tensor of those spheres, when Q is exact. The
 * first two terms are a projection of B, so P is positive definite with any positive definite Q, also with one of clumps that
 * stood elsewhere or had other blocks.
 *
 * Parts: the sum of z over all parts is P r. A part makes its own blocks; what couples them, rigid and mobility, is the sum of those
 * of all parts.
 * Zero-initialise; sd_blocks_free in the end. */
#ifndef SD_BLOCKS_H
#define SD_BLOCKS_H

#include "sd_sparse.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  const double *drag; /* [n] as in sd_system, the caller's: for spheres in no block */
  const double *spin; /* [n], for width 6 */
  int n, width;       /* spheres of this rank; 3, with rotation 6 */
  int part, parts; /* blocks k with k % parts == part are applied: 0 of 1, or as the caller says */
  int blocks;
  long *first;     /* [blocks + 1] into member */
  int *member;     /* spheres of each block */
  long *start;     /* [blocks + 1] into inverse */
  double *inverse; /* (width m)^2 of each block */
  double *turn;    /* [9 blocks] row-major: from the axes at set-up to those of now */
  double *root;    /* [2n] roots of 6 pi eta a, 8 pi eta a^3 at set-up; 0 for spheres in no block */
  double *rigid;   /* [3 width per member] B W, in the axes at set-up */
  double *mobility; /* [9 blocks] S^-1, likewise */
  double *scratch;
  /* coupled */
  double *friction; /* [blocks] of the equal spheres */
  sd_sparse far;    /* Q */
} sd_blocks;

void sd_blocks_free(sd_blocks *b);

/* Blocks of the spheres member[first[k]] ... member[first[k+1]-1]; every sphere is in one block at most, those in none and
 * those with radius 0 are left out of the blocks. Spheres at one point make a block singular: it is then made definite by a
 * small diagonal. SD_OK; SD_ENOMEMORY; SD_EINDEFINITE; SD_ENOTFINITE. On failure b is empty. */
sd_status sd_blocks_create(sd_blocks *b, const sd_law *law, const sd_spheres *s, int n, int width,
                           int blocks, const long *first, const int *member);

/* The same, but only the blocks k with k % parts == part. Before they are coupled the caller sums rigid [3 width first[blocks]] and
 * mobility [9 blocks] over all parts. */
sd_status sd_blocks_create_part(sd_blocks *b, const sd_law *law, const sd_spheres *s, int n,
                                int width, int blocks, const long *first, const int *member,
                                int part, int parts);

/* Block k anew, of its spheres as they stand now. On failure b is of no use but to sd_blocks_free. */
sd_status sd_blocks_renew(sd_blocks *b, const sd_law *law, const sd_spheres *s, int k);

/* Couple the blocks, or couple them again where the clumps stand now. rho: of the sparse factor. Lone spheres take part as blocks
 * of one. SD_OK; SD_ENOMEMORY; SD_EINDEFINITE; SD_ENOTFINITE. On failure b is not coupled. */
sd_status sd_blocks_couple(sd_blocks *b, const sd_law *law, const sd_spheres *s, double rho);

/* The clump of this block has turned by the rotation matrix R [9], row-major, since its set-up. */
void sd_blocks_turn(sd_blocks *b, int block, const double *R);

/* z = P r (this part's share) in the signature of sd_precondition: ctx is an sd_blocks with drag and spin set. */
sd_status sd_blocks_apply(void *ctx, const double *r, double *z);

#ifdef __cplusplus
}
#endif
#endif
