/* Where a step of motion without inertia leads: Adams and Bashforth's of second order, for steps
 * that change, or Euler's.
 *
 *   x' = x + dt [v + c (v - v_old)] + sqrt(2 kT dt) y,   c = dt / (2 dt_old), or 0: Euler
 *
 * A rigid body keeps the shape it has: its spheres are put where its pose says, c + R X_k, and R
 * is turned by the rotation of the vector dt W. Of order 2 (1) in the pose as well. */
#ifndef SD_POSE_H
#define SD_POSE_H

#include "sd_extern_c.h"

SD_BEGIN_C

/* dt, c, and sqrt(2 kT dt) of y, which is random: 0 without noise */
typedef struct {
  double dt, change, noise;
} sd_step;
/* move [n] = x' - x by v and v_old [n], and y [n] (NULL: 0). Aliases are allowed. */
void sd_step_move(const sd_step *step, int n, const double *v, const double *v_old, const double *y,
                  double *move);

/* Rotation matrix R [9], row-major, of the vector w [3]: by |w| about it. Through the unit
 * quaternion (cos |w|/2, sin(|w|/2) w/|w|), so that R is a rotation to rounding for any w. */
void sd_rotation(const double w[3], double R[9]);

/* v [3] = R v, a direction of that length, which rounding then does not change however often it turns;
 * R [9] a rotation. The direction 0 stays 0. */
void sd_turn_direction(const double R[9], double length, double v[3]);
/* The same by the rotation of the vector w [3], in half the operations */
void sd_turn_direction_by(const double w[3], double length, double v[3]);

/* q [4], a unit quaternion (real part first, the rotation of body axes to space), becomes that of R after
 * it, with a length of 1 to rounding; R [9] a rotation by any angle. q = 0 stays 0. */
void sd_turn_quaternion(const double R[9], double q[4]);
/* Rotation matrix R [9] of q [4], not 0, of whatever length; that of 0 is 1. */
void sd_quaternion_rotation(const double q[4], double R[9]);

/* pose [12]: R, then c; moved by a displacement and a turn, step [6], of the point at centre [3] in the
 * axes of the body, from c: what moves it is known there (0, or sd_clump_noise.h). turn [9]: out, that
 * of space in the step; x [3n] = c + R X, X [3n] */
void sd_pose_step(double pose[12], const double centre[3], const double step[6], int n,
                  const double *X, double turn[9], double *x);

/* The step in which the fastest sphere goes xmax, not more than twice the last, and from tmin to
 * tmax. fastest 0: as long as allowed. */
double sd_next_step(double last, double fastest, double tmin, double tmax, double xmax);

/* Are steps too long? Then the change of velocities from step to step, as a part `error` of a radius,
 * grows by some factor in every step, or it has stopped to grow as forces have a largest value. 1:
 * it is above a tenth, and has grown eightfold in three or more steps without a pause, or was above a
 * tenth in twenty steps. To be called in every step. State: all 0 in the first. */
typedef struct {
  /* the last error, and that with which the growth began */
  double last, first;
  /* for how many steps it has grown, and was above a tenth */
  int grows, large;
} sd_growth;
int sd_grows(sd_growth *state, double error);

SD_END_C
#endif
