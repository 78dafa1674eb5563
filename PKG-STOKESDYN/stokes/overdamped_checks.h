/* What does not go with motion without inertia: errors, that name the other command, and limits of
 * the time step. */
#ifndef SD_OVERDAMPED_CHECKS_H
#define SD_OVERDAMPED_CHECKS_H

#include "keywords.h"

namespace LAMMPS_NS {
class Fix;
}

namespace StokesDyn {

class Hydrodynamics;

/* Does the time step adapt? Group bit of those that are held, 0: nobody is. */
struct OverdampedWays {
  bool adapts;
  int held_bit;
};

/* The settings of the pair style, other fixes and pair styles, the kind of run. On all ranks. */
void refuse_inertia(const Voice &voice, const LAMMPS_NS::Fix *self,
                    const Hydrodynamics &hydro, const OverdampedWays &ways);

/* With Brownian motion: contacts with friction, whose damping has no noise; keyword begins the message. A
 * warning for contacts that do not tell. */
void refuse_friction(const Voice &keyword);

/* Once a run, when something besides the pair style acts on the spheres: how long a step contacts
 * and bonds allow. A contact of stiffness k relaxes at the rate lambda k/(6 pi eta a), lambda up to
 * 2.6 in dense packings, and a scheme is stable while that times the step is below 1 (ab2) or 2
 * (euler). smallest_drag: 6 pi eta a */
void announce_step_limit(const Voice &voice, bool euler,
                         double smallest_drag);

}    // namespace StokesDyn
#endif
