/* The shape of a rigid clump of spheres: what it is up to rotation, translation and the order of its spheres; its symmetry;
 * and the pose of a clump of this shape, from where its spheres are now.
 *
 * Lengths "within tolerance" are within 1e-6 of the size, the largest distance of a sphere's surface from the centroid. */
#ifndef SD_SHAPE_H
#define SD_SHAPE_H

#include "sd_status.h"

#ifdef __cplusplus
extern "C" {
#endif

#define SD_SHAPE_TOLERANCE 1e-6

typedef struct {
  int n;           /* spheres */
  double *x;       /* [3n] centres, from their centroid, in the shape's own frame */
  double *a;       /* [n] radii */
  double size;     /* largest |x| + a */
  int rank;        /* 0: all centres in one point, 1: on a line, 2: otherwise */
  double frame[9]; /* columns: three unit vectors fixed by the shape alone, right- or left-handed */
  int symmetries; /* rotations and reflections that map it onto itself, at least 1 (rank 1: eight azimuths stand for all) */
  double *g;      /* [9 symmetries] their matrices, x_perm[k] = g x_k */
  int *perm;      /* [n symmetries] */
  /* private */
  int pair[2];         /* spheres that span the frame */
  double invariant[6]; /* for a quick no */
  double axes[9];      /* main axes of the centres, a right-handed frame, one after the other */
  double *arm; /* [2n] x.axis over its sum of squares: the images of the axes are sum arm x */
} sd_shape;

/* Shape of n spheres at x [3n] with radii a [n]; its frame is that of x. The owner frees.
 * SD_OK; SD_ENOMEMORY; SD_ENOTFINITE: a coordinate or radius that is not finite, or a radius <= 0. */
sd_status sd_shape_create(int n, const double *x, const double *a, sd_shape *shape);
void sd_shape_free(sd_shape *shape);

/* Are the spheres at x [3n], a [n] of this shape? Mirror images are not. Returns 1 and perm [n]: sphere k of the shape is sphere
 * perm[k] there; otherwise 0. The given order is tried first, so that clumps from one template cost no more than their pose.
 *   scratch [6n] */
int sd_shape_match(const sd_shape *shape, int n, const double *x, const double *a, int *perm,
                   double *scratch);

/* Pose of a clump whose spheres, in the shape's order, are at x [3n]: x_k = c + R X_k with X the shape's centres.
 *   R [9]         out, always a proper rotation. Centres on a line leave the azimuth free, one point leaves all free: R is then
 *   some
 *                 rotation with the right axis; nothing that the shape stands for depends on which.
 *   c [3]         out, centroid
 * Returns the largest deviation |x_k - c - R X_k|, a length; INFINITY for positions that are not finite.
 * R follows from the images of the two main axes, not from a fit: exact for a rigid clump, and for one that is not the
 * deviation says so. */
double sd_shape_pose(const sd_shape *shape, const double *x, double R[9], double c[3]);

/* The same without the deviation, at half the price. */
void sd_shape_rotation(const sd_shape *shape, const double *x, double R[9], double c[3]);

#ifdef __cplusplus
}
#endif
#endif
