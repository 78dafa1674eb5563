/* Does a run begin where, and as, the last one ended? Then the forces of that step still stand:
 * velocity Verlet computed them with velocities at half step, which are gone, so they could not be
 * computed again, and a run in two pieces would not be the run in one.
 *
 * A fix that must know keeps a row of numbers for each of its atoms, made when a run ends or a
 * restart file is written. */
#ifndef SD_RESUME_H
#define SD_RESUME_H

#include "pointers.h"

namespace StokesDyn {

class Resume : protected LAMMPS_NS::Pointers {
 public:
  enum { X = 0, V = 3, RADIUS = 6, NAME = 7, OMEGA = 8 };

  Resume(LAMMPS_NS::LAMMPS *lmp, bool spins) : Pointers(lmp), spins(spins) {}

  int columns() const { return spins ? 11 : 8; }
  /* Row of atom i: unwrapped position, velocity, radius, a hash of atom and molecule ID, with spins
   * angular velocity. */
  void record(int i, double *row) const;
  /* Same place (within rounding: wrapping into the box leaves it), radius and IDs. A row of zeros
   * is no place. */
  bool placed(int i, const double *row) const;
  /* Same velocity and angular velocity (within rounding: rigid bodies set them anew). */
  bool moving(int i, const double *row) const;

 private:
  bool spins;
};

}    // namespace StokesDyn
#endif
