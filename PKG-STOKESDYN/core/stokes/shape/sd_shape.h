/* The shape of a rigid clump of spheres: what it is up to rotation, translation and the order of
 * its spheres; its symmetry; and the pose of a clump of this shape, from where its spheres are
 * now. */
#ifndef SD_SHAPE_H
#define SD_SHAPE_H

#include "sd_status.h"

SD_BEGIN_C

/* Lengths that differ by less than this part of the size (the largest distance of a sphere's
 * surface from the centroid) are one and the same: for "is this the same shape", "is it still
 * rigid", "is it symmetric", "is it a line", "are two spheres one".
 * The drag of a clump is in error by about this part of itself then. That is below what the finest
 * shells are in error by (0.06 % with 162 points), and above what a data file with six digits does
 * to the coordinates. */
#define SD_SHAPE_TOLERANCE 1e-4

enum { SD_SHAPE_KEYS = 5 };

typedef struct {
  /* spheres */
  int n;
  /* [3n] centres, from their centroid, in the shape's own frame; on a line or in a point exactly,
   * where that is the rank */
  double *x;
  /* [n] radii */
  double *a;
  /* largest |x| + a; smallest a */
  double size, thinnest;
  /* 0: all centres in one point, 1: on a line, 2: otherwise */
  int rank;
  /* columns: three unit vectors fixed by the shape alone, right- or left-handed */
  double frame[9];
  /* rotations and reflections that map it onto itself, at least 1 (rank 1: eight azimuths stand for
   * all) */
  int symmetries;
  /* [9 symmetries] their matrices, perm [n symmetries]: x_perm[k] = g x_k within the tolerance */
  double *g;
  int *perm;
  /* private: what the pair of spheres that spans the frame has in common with no other but its
   * images */
  double pair[SD_SHAPE_KEYS];
  /* private: main axes of the centres, a right-handed frame, one after the other; sum over the
   * spheres of (x.axis)^2, 0 for axes along which the clump has no extent */
  double axes[9], squares[3];
  /* private: [2n] x.axis over its sum of squares: the images of the axes are sum arm x */
  double *arm;
} sd_shape;

/* Shape of n spheres at x [3n] with radii a [n]; its frame is that of x. The owner frees.
 * SD_OK; SD_ENOMEMORY; SD_ENOTFINITE: a coordinate or radius that is not finite, or a radius <=
 * 0. */
sd_status sd_shape_create(int n, const double *x, const double *a, sd_shape *shape);
void sd_shape_free(sd_shape *shape);

/* The size that the shape of these spheres has, to look it up by: for spheres of one shape,
 * wherever they are and in any order, it differs by 2 SD_SHAPE_TOLERANCE of itself at most. */
double sd_shape_size(int n, const double *x, const double *a);

/* Are the spheres at x [3n], a [n] of this shape? Mirror images are not. Returns 1 and perm [n]:
 * sphere k of the shape is sphere perm[k] there; otherwise 0. The given order is tried first, so
 * that clumps from one template cost no more than their pose.
 *   scratch [6n] */
int sd_shape_match(const sd_shape *shape, int n, const double *x, const double *a, int *perm,
                   double *scratch);

/* Pose of a clump whose spheres are at x [3n]: x_k = c + R X_k with X the shape's centres.
 *   R [9]   out, always a proper rotation. Centres on a line leave the azimuth free, one point all:
 *           R is then some rotation with the right axis; nothing that the shape stands for depends
 *           on which.
 *   c [3]   out, centroid
 * Returns the largest deviation |x_k - c - R X_k|, a length; INFINITY for positions that are not
 * finite.
 * R follows from the images of the two main axes, not from a fit of all spheres: exact for a rigid
 * clump, and for one that is not the deviation says so. */
double sd_shape_pose(const sd_shape *shape, const double *x, double R[9], double c[3]);

/* Columns of E: the main axes of a shape of rank 2, whose signs are those of its frame; right- or
 * left-handed. Returns 1; 0 where two of its moments along them are alike to a hundredth, so that rounding
 * would turn them. */
int sd_shape_main_axes(const sd_shape *shape, double E[9]);

/* The largest of `most` and (|v|/a)^2 of the spheres of a shape that moves with U [3] of the point at `from`
 * [3] and W [3], all in its own axes. One that cannot be above `most` is not looked at sphere by sphere. */
double sd_shape_fastest(const sd_shape *shape, const double from[3], const double U[3], const double W[3],
                        double most);

SD_END_C
#endif
