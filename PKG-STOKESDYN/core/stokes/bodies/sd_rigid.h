/* Parts that move rigidly with wholes: points with their spheres, spheres with their bodies.
 *
 *   K:    v = U + W x r, w = W          velocities of the parts from (U, W) of the wholes
 *   K^T:  F = sum f, T = sum t + r x f  forces and torques on the wholes from those on the parts
 *
 * r: from the centre of the whole to the part. Wholes have 6 numbers, all in space axes. */
#ifndef SD_RIGID_H
#define SD_RIGID_H

#include "sd_extern_c.h"

SD_BEGIN_C

typedef struct {
  /* parts; numbers of each: 3 (v or f), 6 (v w, or f t: the torque about the part's own centre) */
  int n, width;
  /* [n] number of the whole; NULL: part i is whole i, and K = 1 */
  const int *whole;
  /* [3n] r; NULL: 0, the parts are in the centres */
  const double *arm;
} sd_rigid;

/* The whole that part i moves with */
static inline int sd_rigid_whole(const sd_rigid *K, int i)
{
  return K->whole ? K->whole[i] : i;
}

/* v [width n] = K V, V [6 wholes] */
void sd_rigid_move(const sd_rigid *K, const double *V, double *v);
/* K V: in v, or where K = 1 V itself */
const double *sd_rigid_moved(const sd_rigid *K, const double *V, double *v);
/* f [6 wholes] = K^T of parts [width n] */
void sd_rigid_collect(const sd_rigid *K, const double *parts, int wholes, double *f);
/* Likewise, in f or the parts themselves */
const double *sd_rigid_collected(const sd_rigid *K, const double *parts, int wholes, double *f);

SD_END_C
#endif
