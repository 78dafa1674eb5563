/* What a rigid shape of spheres is to the loop of sd_bodies.h: constant blocks, in the frame of
 * the shape and for eta = 1, which are turned with every clump of this shape.
 *
 * The unknowns are force and torque of each sphere about its own centre, 6 m numbers, with the
 * Rotne-Prager-Yamakawa blocks M_b between them. K (6 m x 6): velocities of the spheres from those
 * of the body about the centroid, v_k = U + W x X_k, w_k = W.
 *
 * Shells at the price of spheres: with N_spheres = (K^T M_b^-1 K)^-1, the mobility that the body
 * has as spheres, and N_shell, the one that it has with shells (sd_clump.h), the body's own matrix
 * is
 *   M_b' = M_b + K dN K^T,   dN = N_shell - N_spheres
 * Then the lone body moves exactly as its shells say, K^T M_b'^-1 K = N_shell^-1, and two bodies
 * feel each other as spheres do. Likewise it is carried by a straining flow as its shells say, by
 * dE E more than as spheres. */
#ifndef SD_BODY_SHAPE_H
#define SD_BODY_SHAPE_H

#include "sd_clump.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  /* spheres */
  int m;
  /* [3m] X_k, from the centroid */
  double *x;
  /* [(6m)^2] M_b'^-1, symmetric; [(6m) 6] M_b'^-1 K, row-major */
  double *inverse, *rigid;
  /* [6 6] of the lone body: (U, W) from force and torque about the centroid; and its inverse */
  double mobility[36], resistance[36];
  /* [6 6] dN, 0 without shells */
  double shell[36];
  /* [6 6] dE: (U, W) from E_xx E_yy E_zz E_yz E_xz E_xy, as in sd_clump.h; 0 without shells */
  double carried[36];
} sd_body_shape;

/* shells: the clump of this shape with shells; NULL: spheres are points with force and torque. The
 * owner frees.
 * SD_OK; SD_ENOMEMORY; SD_ESINGULAR: spheres at one point with equal radii. */
sd_status sd_body_shape_create(const sd_shape *shape, const sd_clump *shells, sd_body_shape *out);
void sd_body_shape_free(sd_body_shape *s);

#ifdef __cplusplus
}
#endif
#endif
