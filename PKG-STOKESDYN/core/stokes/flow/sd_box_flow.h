/* The flow that takes a box along, u = u_corner + G (x - corner), and steps of bodies in that box. */
#ifndef SD_BOX_FLOW_H
#define SD_BOX_FLOW_H

#include "sd_lattice.h"

SD_BEGIN_C

typedef struct {
  /* G, d u_p / d x_q, row-major */
  double gradient[9];
  /* the lower corner of the box, and its velocity */
  double corner[3], corner_velocity[3];
} sd_box_flow;

/* u [3] at x [3] */
void sd_box_flow_at(const sd_box_flow *flow, const double x[3], double u[3]);

/* The box `now`, as it is a time t later: exact where edges change evenly, else to second order */
sd_box sd_box_later(const sd_box_flow *flow, const sd_box *now, double t);

/* How bodies go in the half step from the start of a step, or in all of it by velocities of its middle */
typedef struct {
  /* how long they go */
  double t;
  /* 1: the flow takes the box along. Then velocities beyond that of the box count, which are the same for a
   * body and its images, and the box carries what has been moved (sd_box_step of sd_lattice.h) */
  int carried;
  /* when the step starts, where velocities are of, and when it ends */
  sd_box start, at, to;
  /* where velocities are of */
  sd_box_flow flow;
} sd_step_in_box;

/* step [3] of a body that is at x when the step starts, by its velocity V [3], which it has at `place` in the
 * box `at`. Not carried: t V */
void sd_step_in_box_of(const sd_step_in_box *s, const double V[3], const double place[3], const double x[3],
                       double step[3]);

SD_END_C
#endif
