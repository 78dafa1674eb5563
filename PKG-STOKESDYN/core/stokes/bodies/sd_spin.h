/* A sphere that a field turns at its own angular velocity, with a torque that is no larger than the field can
 * give. A sphere that would need more is overloaded: the largest torque, about the axis of the field, drives
 * it or brakes it, and what it turns at is found like that of any other sphere. */
#ifndef SD_SPIN_H
#define SD_SPIN_H

#include "sd_status.h"

SD_BEGIN_C

typedef struct {
  /* angular velocity of the field, and its direction, of length 1 */
  double omega[3], axis[3];
  /* the largest torque; 0: it has no limit */
  double most;
} sd_spin_field;

/* Is a sphere overloaded after the next move? 0: no; 1 or -1: yes, and this is the sign of the field's torque
 * along its axis. now: the same before that move. W: its angular velocity; by_fluid: the torque of the fluid
 * on it; others: all other torques, of an overloaded one with that of the field. An overloaded sphere is so
 * until it has caught up with the field, or the field with it. */
double sd_spin_overload(const sd_spin_field *field, double now, const double W[3], const double by_fluid[3],
                        const double others[3]);

SD_END_C
#endif
