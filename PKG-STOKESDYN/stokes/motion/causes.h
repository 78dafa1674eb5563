/* What the velocities of a step without inertia follow from, as fingerprints (sd_hash_add_row): forces,
 * torques, the fluid, viscosities, given velocities and strokes, and who is held, pinned or spun. Where a run
 * begins, velocities of the step before still count if spheres stand as they did and these are the same. */
#ifndef SD_CAUSES_H
#define SD_CAUSES_H

#include "drives.h"
#include "pointers.h"

namespace StokesDyn {

class Hydrodynamics;

class Causes : protected LAMMPS_NS::Pointers {
 public:
  Causes(LAMMPS_NS::LAMMPS *lmp, const Drives &drives) : Pointers(lmp), drives(drives) {}

  /* loads, the fluid and what is given, and who is held: of the last velocities, also in restart files */
  enum { LOADS = 4, KINDS = 10, ALL = 12 };
  double prints[ALL] = {0.0};

  /* Velocities have been found: their prints, but for who is held, are due. note() finds them when somebody
   * may ask, as a run ends or a restart file is written, while atoms are as they were then. */
  bool due = false;
  void note(const Hydrodynamics &);
  /* Do the last velocities follow from the same as those of now would? which: LOADS, the first of them, or
   * ALL. Noise leaves the fluid as it is half a step later. */
  bool stand(const Hydrodynamics &, int which = ALL) const;
  /* Are others held, pinned or spun than in the step before? Notes who is. */
  bool others_held(const Hydrodynamics &);

 private:
  const Drives &drives;

  void find(const Hydrodynamics &, double *all) const;
  void find_kinds(const Hydrodynamics &, double *kinds) const;
};

}    // namespace StokesDyn
#endif
