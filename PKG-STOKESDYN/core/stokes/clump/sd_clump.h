/* Hydrodynamic resistance of a rigid clump of spheres, computed once for its shape, and the forces
 * that follow from it.
 *
 * Forces are those of the fluid on the clump when the fluid slips past it with
 *   s(y) = s0 + A (y - c) = s0 + W x (y - c) + E (y - c),   s = u_inf - v
 * c: centroid of the centres; W: slip of angular velocity (half the vorticity less the clump's
 * angular velocity); E: symmetric.
 * Rigid motion and every linear ambient flow are covered exactly. Viscosity is a factor.
 *
 * Models:
 *   shell 1, no rotation   a point force in every centre, (I/(6 pi eta a) + Omega) F = s (Joung et
 *                          al. 2001)
 *   shell 1, rotation      force and torque in every centre, 6x6 Rotne-Prager-Yamakawa blocks
 *   shell n >= 12          point forces on the surface of every sphere, see sd_shell.h
 * Points of a shell inside another sphere of the clump are no surface and left out. The surface is
 * covered evenly, with n points for every sphere that shows: spheres of a fused clump get more than
 * n, of which n are left; with unequal radii a sphere's shell has a number in proportion to a^2, at
 * least 12 and at most max(4n, 642). With few points: mean of several orientations of the shells.
 * With shells the lone sphere is exact (6 pi eta a, 8 pi eta a^3, no response to strain), and the
 * result has the symmetry of the shape: it is averaged over the shape's own symmetries, and the
 * shells are oriented by the shape's frame, so that neither the orientation nor the order in which
 * the spheres came matters. */
#ifndef SD_CLUMP_H
#define SD_CLUMP_H

#include "sd_clump_options.h"
#include "sd_clump_strain.h"
#include "sd_shape.h"
#include "sd_shell.h"

SD_BEGIN_C

typedef struct {
  /* spheres, and points of the surface (n for shell 1) */
  int n, points;
  /* 0: dense solve, else largest number of iterations of the twelve solves */
  int iterations;
  /* In the frame of the shape, eta = 1. Rows 0-2 force, 3-5 torque about the sphere's own centre.
   * Columns 0-2 s0, 3-5 W, 6-11 E_xx E_yy E_zz E_yz E_xz E_xy (each off-diagonal stands for itself
   * and its mirror). table[(12 k + column) 6 + row] */
  double *table;
  /* force and torque about the centroid from s0, W; symmetric */
  double R[36];
  /* the same from E: row-major, 6 rows, 6 columns as above */
  double strain[36];
  /* of hydrodynamic stress (reaction), from the centroid: there the coupling block is symmetric */
  double centre[3];
  /* resistance about it, and its pseudo-inverse: velocity of the centre and angular velocity from
   * force and torque about it */
  double R_centre[36], mobility[36];
  /* of mobility, from there: about it the mobility's coupling block is symmetric (sd_clump_noise.h) */
  double mobility_centre[3];
  /* hydrodynamic: 1/(6 pi eta) over the mean translational mobility at the centre of mobility */
  double radius;
} sd_clump;

sd_status sd_clump_needs(const sd_shape *shape, const sd_clump_options *options,
                         sd_clump_need *need);

/* Solve. The shape is not kept. The owner frees. need may be NULL.
 * SD_OK; SD_ENOMEMORY (see need); SD_ESINGULAR: spheres of equal radii at one point
 * (SD_SHAPE_TOLERANCE); the codes of Cholesky's factorisation and of the iterative solver. */
sd_status sd_clump_create(const sd_shape *shape, const sd_clump_options *options, sd_shells *cache,
                          sd_clump *clump, sd_clump_need *need);
void sd_clump_free(sd_clump *clump);

/* A clump in its pose (sd_shape_pose), R row-major and the centroid c, lab = c + R shape, in a fluid of
 * viscosity eta */
typedef struct {
  const sd_shape *shape;
  const sd_clump *clump;
  /* [12] */
  const double *pose;
  double eta;
} sd_clump_placed;

/* What is told of its spheres, in the shape's order, of sphere k from width k on: v [6] velocity and angular
 * velocity; F, T [3] force and torque of the fluid on it about its own centre, T NULL: not wanted */
typedef struct {
  int width;
  double *v, *F, *T;
} sd_clump_rows;

/* F and T under the slip s0 [3], and W [3] or A [9], row-major; all in the lab. The rigid version is for slip
 * without strain. Neither shape nor c is read. No allocation. */
void sd_clump_forces_rigid(const sd_clump_placed *placed, const double s0[3], const double W[3],
                           const sd_clump_rows *out);
void sd_clump_forces(const sd_clump_placed *placed, const double s0[3], const double A[9],
                     const sd_clump_rows *out);

/* 6x6 resistance about the point at d from the one that R is about. */
void sd_resistance_shift(const double R[36], const double d[3], double out[36]);

SD_END_C
#endif
