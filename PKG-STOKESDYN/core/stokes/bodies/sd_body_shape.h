/* What a rigid shape of points is to the loop of sd_bodies.h: constant blocks, in the frame of the
 * shape and for eta = 1, which are turned with every body of this shape.
 *
 * Unknowns of a point are its force, width 3, or force and torque about its own centre, width 6:
 * width m numbers, with the matrix M_b between them. K (width m x 6): velocities of the points from
 * those of the body about the centre of the shape, v_k = U + W x X_k, w_k = W.
 *
 * One shape serves bodies of any size. With lengths a times as large, T = diag(1, 1/a) on (velocity,
 * angular velocity) and on (force, torque) of points and bodies alike, and viscosity eta
 *
 *   M_b(a) = T M_b T / (eta a),   K(a) = T K T^-1,   so N(a) = T N T / (eta a)
 *
 * of which width 3 sees M_b / (eta a) alone.
 *
 * Shells at the price of spheres: with N_spheres = (K^T M_b^-1 K)^-1, the mobility that a clump
 * has as spheres, and N_shell, the one that it has with shells (sd_clump.h), the body's own matrix
 * is
 *   M_b' = M_b + K dN K^T,   dN = N_shell - N_spheres
 * Then the lone body moves exactly as its shells say, K^T M_b'^-1 K = N_shell^-1, and two bodies
 * feel each other as spheres do. Likewise it is carried by a straining flow as its shells say, by
 * dE E more than as spheres. */
#ifndef SD_BODY_SHAPE_H
#define SD_BODY_SHAPE_H

#include "sd_clump.h"
#include "sd_mirrored.h"
#include "sd_wall.h"

SD_BEGIN_C

/* How the points move as the body turns: along with it; not at all; in a way of their own
 * (sd_multiblob_shape_stand) */
typedef enum { SD_BODY_ALONG, SD_BODY_STILL, SD_BODY_OTHERWISE } sd_body_turns;

typedef struct {
  /* points, and numbers of each: 3 or 6 */
  int m, width;
  /* SD_BODY_ALONG unless the maker says another */
  sd_body_turns turns;
  /* [3m] X_k, from the centre; [m] radii */
  double *x, *radius;
  /* [(width m)^2] M_b'^-1, symmetric, or in blocks, width 3: then `inverse` is NULL; [(width m) 6] M_b'^-1 K,
   * row-major */
  double *inverse, *rigid;
  sd_mirrored *mirrored;
  /* [6 6] of the lone body: (U, W) from force and torque about the centre; and its inverse */
  double mobility[36], resistance[36];
  /* [6 6] dN, 0 without shells */
  double shell[36];
  /* [6 6] dE: (U, W) from E_xx E_yy E_zz E_yz E_xz E_xy, as in sd_clump.h; 0 without shells */
  double carried[36];
} sd_body_shape;

/* The shape of points x [3m] with radii [m] whose matrix is M [(width m)^2]: that of sd_wall_matrix,
 * or with what a model adds for each body alone. The owner frees.
 * SD_OK; SD_ENOMEMORY; SD_ESINGULAR: M is not positive definite (points of equal radii at one
 * place); SD_ENOTFINITE. */
sd_status sd_body_shape_of(int m, int width, const double *x, const double *radius, const double *M,
                           sd_body_shape *out);
/* The same of width 3 where mirrors leave M as it is (sd_mirrored.h). */
sd_status sd_body_shape_mirrored(int m, const double *x, const double *radius, const double axes[9],
                                 const double *M, sd_body_shape *out);
/* out [width m] = M_b'^-1 y, on entry 0 */
void sd_body_shape_answer(const sd_body_shape *s, const double *y, double *out);
/* A clump of spheres with forces and torques. shells: the clump of this shape with shells; NULL:
 * none. The owner frees. Status as above. */
sd_status sd_body_shape_create(const sd_shape *shape, const sd_clump *shells, sd_body_shape *out);

/* A body above a wall, alone: its matrix has the images of its points, and depends on where it
 * stands. Its blocks are made anew where it has moved, for sd_bodies.h: beside the wall those of open
 * space are up to seven times too mobile, and the loop would take twice as many products. The shape,
 * in axes of space, of points x [3m] of a body whose centre is there. The owner frees. Status as
 * above. */
sd_status sd_body_wall_shape(const sd_wall *wall, int m, int width, const double *x,
                             const double *a, const double centre[3], sd_body_shape *out);
/* Is it worth a body's own blocks? Making them costs about as much as 2 m^3 pairs of points, so that
 * a body of m points wants about m/3 of `bodies`, and one of at most SD_BODY_WALL_SMALL none. From a
 * height of ten times its extent on the wall is worth a tenth of its mobility. */
enum { SD_BODY_WALL_SMALL = 42 };
int sd_body_wall_pays(int m, int bodies, double height, double extent);

void sd_body_shape_free(sd_body_shape *s);

SD_END_C
#endif
