/* Half steps of bodies that move at random, so that the mean of the velocities found there has the drift of
 * their mobility, without a solve for it:
 *
 *   points move with   v'  = A^T y + v_0           A: sd_body_follow.h
 *   films with         v'' = v' + P^-1 (f_L - K^T L K A^T y)
 *   v_0 = A^T u + P^-1 (F + E - K^T L K A^T u)     what is not random, about
 *
 * y, f_L: random velocities at the points, random forces of films (sd_bodies_noise.h); E: what the flow takes
 * off films (sd_lubrication.h). With M' at x + dt/2 v' and L at x + dt/2 v'', the mean displacement of one
 * solve is kT div N dt more than without noise in second order:
 *
 *   M':  <(K N - M' A)_k ...>, and what is left is that of sd_body_follow.h
 *   L:   <(K^T M'^-1 y + f_L) v''^T> = (1 - L P^-1) + L P^-1 = 1 for any symmetric P
 *
 * P: the sparse H of sd_tie.h where bodies are tied, N_b^-1 of those that are not, so that v'' is hindered as
 * velocities are and films see no overlap. (Its incomplete factor would do for the mean, but differs with the
 * number of ranks.)
 * Source: own derivation; random finite differences: Delong et al. 2014. */
#ifndef SD_DRIFTER_H
#define SD_DRIFTER_H

#include "sd_body.h"
#include "sd_body_follow.h"
#include "sd_tied.h"

SD_BEGIN_C

/* [A->shaped] bodies of A as they stand, or as they are in open space, and how each follows; NULL: a point of
 * its own, which is itself */
typedef struct {
  const sd_body *body;
  const sd_body_follow *const *follow;
} sd_drifter;

/* l [points] = A v */
void sd_drifter_spread(const sd_bodies *A, const sd_drifter *d, const double *v, double *l);

/* Velocities of the fluid and random ones at the points, forces and random forces on the spheres
 * (NULL: 0); with a tie, where sd_tie_make has been, to this tolerance of sd_tie_solve. velocities [6 bodies]
 * of those that have a known one, NULL: they rest. v', v'' [6 bodies] out, velocities that are given among
 * them. work [(24 + SD_TIE_OF_BODY) bodies + SD_TIE_OF_SPHERE spheres]. SD_OK; that of sd_tie_solve. */
typedef struct {
  const double *u, *y, *F, *f, *velocities;
  double tolerance;
} sd_drifter_push;
sd_status sd_drifter_move(const sd_bodies *A, const sd_drifter *d, const sd_drifter_push *push,
                          double *work, double *of_points, double *of_films);

/* What the mean lacks where all bodies follow exactly (sd_body_follow.h), of those that are free, kT an
 * energy: slip [points] += kT/(eta a^2) R slip_b, load [spheres] -= kT R torque_b, on the sphere of the
 * body's first point. Where bodies have a slip, spheres are of width 6. */
void sd_drifter_add_own(const sd_bodies *A, const sd_drifter *d, double kT, double *slip, double *load);

/* What the mean lacks where sum_k (d_k M') A_k is left, by differences: of kT sum_k (d_k M') A_k as slip and
 * -kT sum_k (d_k K)^T A_k as load one term each, with l = A W / e, W random and of variance 1, the bodies at
 * x + e W and part = kT/2, then at x - e W and part = -kT/2. slip [points] += part M' l, load [6 bodies] -=
 * part K^T l. work [18 bodies + 6 spheres + points]. SD_OK; that of A->apply. */
sd_status sd_drifter_difference(const sd_bodies *A, const double *l, double part, double *work, double *slip,
                                double *load);

/* W for these, and how far along it. Bodies from `turning` on turn, those before do not. smallest: radius of
 * the smallest sphere of all ranks; dimension 2: all move in the plane of x and y, and turn about z. */
typedef struct {
  /* [6 bodies] standard normal numbers g */
  const double *normals;
  double smallest;
  int turning, dimension;
} sd_drifter_random;
/* Returns e. moves [6 bodies] = e W' and W [6 bodies], for which <W'_k W_k> = 1 will do:
 *   W' = W = g   of velocities,   W' = g/s, W = g s   of angular ones
 * s: from the centre of the body to that of its farthest sphere, at least `smallest`. 0 where the velocity is
 * given and where there is no such motion. extent [bodies]: scratch. */
double sd_drifter_moves(const sd_bodies *A, const sd_drifter_random *random, double *extent, double *moves,
                        double *W);
/* load [spheres] += the torques of of_bodies [6 bodies] on those that turn, as torques on the first sphere of
 * each, of width 6. They are 0 in of_bodies then. */
void sd_drifter_hand_on(const sd_bodies *A, int turning, double *of_bodies, double *load);

/* What one solve has besides: slip y [points] and forces f_L [spheres] as they were drawn, and what its mean
 * lacks without slip_left and load_left, likewise */
typedef struct {
  const double *slip, *load, *slip_left, *load_left;
} sd_drifter_drawn;
/* All of that to the flow u [points] and the loads F [spheres] of the solve */
void sd_drifter_add(const sd_bodies *A, const sd_drifter_drawn *drawn, double *u, double *F);

SD_END_C
#endif
