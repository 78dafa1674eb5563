/* Preconditioners of conjugate gradients: approximations P of the inverse of the mobility matrix M, kept over many solves.
 *
 * Both are made of the matrix with unit diagonal, C = D^1/2 M D^1/2, whose blocks depend on positions, radii and the law only,
 * so that P = D^1/2 (approximation of C^-1) D^1/2. Force and velocity only; torques keep the diagonal. A preconditioner changes
 * the number of iterations, never the answer. */
#ifndef SD_PRECONDITION_H
#define SD_PRECONDITION_H

#include "sd_product.h"
#include "sd_status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* --- sparse inverse Cholesky factor ------------------------------------------------------------------------------------------
 * C^-1 = L L^T nearly, with L from local solves (Schaefer, Katzfuss & Owhadi, SIAM J. Sci. Comput. 43, A2019 (2021)):
 * the spheres are put in order, each the one farthest from all before it, at the distance l_i; sphere i sees those before it
 * that are nearer than rho l_i, and its column of L is the last one of the inverse Cholesky factor of their C. Among all
 * matrices L of this sparsity it is the one nearest to C^-1 in the Kullback-Leibler sense. L L^T is positive definite whatever
 * the rounding. rho 2, 3, 4: about 14, 42, 93 blocks a sphere in a compact cloud. It stays good while spheres move less than a
 * radius or so. Parts: columns i with i % parts == part are made and applied; the sum of z over the parts is P r.
 * Zero-initialise. */
typedef struct {
  int width;          /* 3, with rotation 6: the caller's */
  const double *drag; /* [n] the caller's */
  const double *spin; /* [n] or NULL */
  int n;
  int part, parts;
  int columns; /* of this part */
  long *first; /* [columns + 1] into row */
  int *row;    /* spheres; the first of each column is its own */
  float *
      value; /* [9] each: L L^T is exactly symmetric with rounded L too, and half the bytes are read */
  double *scratch; /* [8n] */
} sd_sparse;

void sd_sparse_free(sd_sparse *f);

/* SD_OK; SD_ENOMEMORY; SD_EINDEFINITE: a hard cut-off in the law's place; SD_ENOTFINITE. On failure f is empty. */
sd_status sd_sparse_create(sd_sparse *f, const sd_law *law, const sd_spheres *s, int n, double rho,
                           int part, int parts);

/* z = P r (this part's share), in the signature of sd_precondition: ctx is an sd_sparse with width, drag and spin set. */
void sd_sparse_apply(void *ctx, const double *r, double *z);

/* The order and the distances alone: order [n] spheres that take part, farthest first; distance [n] l_i of order[i] (INFINITY
 * for the first). Returns their number, or -1 without memory. Ties: the smaller index first. */
int sd_farthest_first(const sd_spheres *s, int n, int *order, double *distance);

/* --- one block per clump ---------------------------------------------------------------------------------------------------
 * B: the inverse of C of each clump alone. Memory and time of an application: 9 m^2 numbers for a clump of m spheres; set-up m^3.
 * A clump that moves as a rigid body keeps its block: only its turn changes.
 *
 * Coupled blocks add what the clumps do to one another as wholes. With W the rigid translations of the clumps and S = W^T B W
 * their friction, the clumps' velocities as lone bodies, S^-1 W^T B r, go through the sparse factor Q of a cloud with one
 * sphere of equal friction for each clump:
 *   P = B - B W S^-1 W^T B + B W S^-1 Q S^-1 W^T B
 * By Woodbury's identity this is the inverse of (blocks + W G W^T), G the pair tensor of those spheres, when Q is exact. The
 * first two terms are a projection of B, so P is positive definite with any positive definite Q.
 * Zero-initialise; sd_blocks_free in the end. */
typedef struct {
  int width;          /* 3, with rotation 6: the caller's */
  const double *drag; /* [n] as in sd_system, the caller's; spheres in no block and torques */
  const double *spin; /* [n] or NULL */
  int n;              /* spheres of this rank */
  int blocks;
  long *first;     /* [blocks + 1] into member */
  int *member;     /* spheres of each block */
  long *start;     /* [blocks + 1] into inverse */
  double *inverse; /* (3m x 3m) of each block */
  double *turn;    /* [9 blocks] row-major: from the axes at set-up to those of now */
  double *root;    /* [n] sqrt(6 pi eta a) at set-up; 0 for spheres in no block */
  double *scratch; /* of the largest block */
  /* coupled: in the axes at set-up */
  double *rigid;    /* [9 per member] B W */
  double *mobility; /* [9 blocks] S^-1 */
  double *total;    /* [9 blocks] scratch: force, velocity, coupled force of each clump */
  double *friction; /* [blocks] of the equal spheres */
  sd_sparse far;    /* Q */
} sd_blocks;

void sd_blocks_free(sd_blocks *b);

/* Blocks of the spheres member[first[k]] ... member[first[k+1]-1]; every sphere is in one block at most, those in none and
 * those with radius 0 are left out of the blocks. Spheres at one point make a block singular: it is then made definite by a
 * small diagonal. SD_OK; SD_ENOMEMORY; SD_EINDEFINITE; SD_ENOTFINITE. On failure b is empty. */
sd_status sd_blocks_create(sd_blocks *b, const sd_law *law, const sd_spheres *s, int n, int blocks,
                           const long *first, const int *member);

/* Couple the blocks, or couple them again where the clumps stand now (s->x, with the turns of now). rho: of the sparse factor.
 * Lone spheres take part in it as blocks of one. SD_OK; SD_ENOMEMORY; SD_EINDEFINITE; SD_ENOTFINITE. On failure b is not
 * coupled. */
sd_status sd_blocks_couple(sd_blocks *b, const sd_law *law, const sd_spheres *s, double rho);

/* The clump of this block has turned by the rotation matrix R [9], row-major, since set-up. */
void sd_blocks_turn(sd_blocks *b, int block, const double *R);

/* z = P r in the signature of sd_precondition: ctx is an sd_blocks with width, drag and spin set. */
void sd_blocks_apply(void *ctx, const double *r, double *z);

#ifdef __cplusplus
}
#endif
#endif
