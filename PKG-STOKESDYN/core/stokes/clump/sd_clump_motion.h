/* How a rigid clump moves and is passed by the fluid, from its spheres; and the drag that follows.
 *
 * Spheres are in the order of the shape. Everything is a least-squares fit that is exact for rigid
 * motion and linear flow. */
#ifndef SD_CLUMP_MOTION_H
#define SD_CLUMP_MOTION_H

#include "sd_clump.h"
#include "sd_linear.h"

SD_BEGIN_C

/* What the n spheres and the fluid at their centres do */
typedef struct {
  /* [3n] positions, velocities */
  const double *x, *v;
  /* [3n] angular velocities; NULL: spheres have none. Only spheres on a line are asked for them:
   * their centres do not tell how the clump spins about it. */
  const double *omega;
  /* the fluid velocity, where it is the same everywhere */
  double u_uniform[3];
  /* [3n], [9n] fluid velocity and its gradient du_p/dx_q; NULL, both: uniform. What the gradient
   * does not explain of the velocities is fitted: all of it, where the gradient is 0. */
  const double *u, *gradient;
} sd_clump_motion;

/* Velocity U of the centroid and angular velocity W of the clump in pose R, c. */
void sd_clump_velocity(const sd_shape *shape, const sd_clump_motion *m, const double R[9],
                       const double c[3], double U[3], double W[3]);

/* Fluid velocity u at the centroid and its gradient G over the clump. Without u in m: uniform. */
void sd_clump_flow(const sd_shape *shape, const sd_clump_motion *m, const double R[9],
                   const double c[3], double u[3], double G[9]);

/* Force and torque of the fluid on each sphere; v is not written. No allocation. */
void sd_clump_drag(const sd_clump_placed *placed, const sd_clump_motion *m, const sd_clump_rows *out);

/* Adds force and torque FT [6] at x to the load [6] about a point, from which x is at arm. */
static inline void sd_clump_add_load(const double arm[3], const double FT[6], double load[6])
{
  double couple[3];
  sd_cross(arm, FT, couple);
  for (int d = 0; d < 3; d++) {
    load[d] += FT[d];
    load[3 + d] += FT[3 + d] + couple[d];
  }
}

/* Velocity and angular velocity V [6] at a point of a rigid body become those at arm [3] from there. */
static inline void sd_clump_shift_velocity(const double arm[3], double V[6])
{
  double turning[3];
  sd_cross(V + 3, arm, turning);
  for (int d = 0; d < 3; d++) V[d] += turning[d];
}

/* A clump without inertia that no other disturbs: under the load on its spheres, force and torque about the
 * centroid, it moves with V [6], U of the centroid and W; load NULL: with the V that is given. Free:
 *   (U, W) = (u, curl u / 2) + N (load + eta C : E) / eta
 * u the flow at its centroid (sd_clump_flow) and E the strain there, N its mobility, C its force from
 * the strain for eta = 1. No allocation. */
void sd_clump_move_alone(const sd_clump_placed *placed, const sd_clump_motion *m, const double *load,
                         double V[6], const sd_clump_rows *out);

/* The same of a lone sphere of which each of `width` components (6: with rotation) has the drag D, in a fluid
 * that moves with u: F, force and torque of the fluid on it. */
static inline void sd_sphere_move_alone(int width, const double *D, const double *u, const double *load,
                                        double *V, double *F)
{
  for (int d = 0; d < width; d++) {
    if (load) V[d] = u[d] + load[d] / D[d];
    F[d] = load ? -load[d] : D[d] * (u[d] - V[d]);
  }
}

SD_END_C
#endif
