/* The long waves of a periodic box, a preconditioner (sd_precondition.h).
 *
 * In a periodic box the large eigenvalues of the mobility are its longest waves, 1 + O(a n/k^2) for
 * n spheres in the volume, and conjugate gradients need the more iterations the larger the box is.
 * So these are taken exactly, as the sum over k defines them, and all the rest as a multiple of
 * what a preconditioner for near spheres inverts:
 *
 *   M_0 = alpha B^-1 + Z E Z^T,   alpha = 0.6,   E = 2/(k^2 V)
 *
 * B: one block per clump, and D for spheres in none (sd_blocks.h). Z has four columns
 * for a pair of waves +-k: cosine and sine of k.x times two directions e across k. In the rows of
 * sphere i, w_i = 1/sqrt(eta_i),
 *
 *   force     w_i s(k a_i) e cos(k.x_i),                   w_i s(k a_i) e sin(k.x_i)
 *   torque   -w_i p(k a_i)/2 (k x e) sin(k.x_i),           w_i p(k a_i)/2 (k x e) cos(k.x_i)
 *
 * with s = sin(x)/x and p = 3 j_1(x)/x, of which rational functions that agree with them to x^4
 * stand here. The inverse by Woodbury's identity, positive definite whatever the rounding of Z is,
 *
 *   P = 1/alpha [ B - B Z G^-1 Z^T B ],   G = alpha E^-1 + Z^T B Z.
 *
 * The 61 pairs of smallest |k|: in a cubic box all with |n|^2 <= 9, 244 columns. Z is never stored:
 * what is kept of a sphere are three phases, and an application costs 5000 operations a sphere
 * (7000 with torques). Set-up: 2 (4 * 61)^2 operations for each row of Z, and a Cholesky factor.
 *
 * Only positions, radii, viscosities and the box enter, so any engine goes with it. Source: the sum
 * over k of the Rotne-Prager-Yamakawa tensor, Wajnryb, Mizerski, Zuk & Szymczak 2013; the
 * preconditioner is our own.
 *
 * To switch it on: a case with the box that the engine has (sd_ewald.box), this rank's spheres
 * alone, parts 1, the sum over all ranks, clumps with their images side by side or none, and the
 * kind sd_precondition_waves. In an open box it is the blocks alone.
 * Zero-initialise; sd_waves_free in the end. */
#ifndef SD_WAVES_H
#define SD_WAVES_H

#include "sd_blocks.h"

enum { SD_WAVES_MOST = 61, SD_WAVES_PADDED = 64, SD_WAVES_COLUMNS = 4 * SD_WAVES_PADDED };

/* A pair of waves each; those that only fill the arrays up have no strength. */
typedef struct {
  /* k = 2 pi times n times the reciprocal edges */
  int n[3][SD_WAVES_PADDED];
  /* |k|; unit vectors across it, (e k) right-handed; E */
  double k[SD_WAVES_PADDED], e[2][3][SD_WAVES_PADDED], strength[SD_WAVES_PADDED];
} sd_wave_list;

/* The longest waves of a box, |k| rising; none in an open one. Returns the largest |n_d|, at most
 * SD_WAVES_MOST; -1: out of memory. */
int sd_wave_list_of(const sd_ewald_box *box, sd_wave_list *list);

typedef struct {
  int n, width;
  sd_wave_list list;
  /* largest |n_d| */
  int harmonics;
  /* [6 n] cosine and sine of 2 pi times the place in the box, along each edge; [2n] a, 1/sqrt(eta).
   * All at set-up. */
  double *phase, *size;
  /* B */
  sd_blocks near;
  /* [columns columns] lower Cholesky factor of G */
  double *factor;
  /* [width n] */
  double *scratch;
  sd_world world;
} sd_waves;

/* As of sd_precondition_kind, with c->box. c->n are the spheres of this rank, or with parts those
 * of all ranks on each; c->world adds the ranks' shares of G here and of Z^T B r in every
 * application. Clumps (c->clumps) may be none. */
sd_status sd_waves_make(void *waves, const sd_precondition_case *c);

void sd_waves_free(void *waves);

/* z = P r (this part's share) in the signature of sd_precondition: ctx is an sd_waves. */
sd_status sd_waves_apply(void *ctx, const double *r, double *z);

#endif
