/* A box that LAMMPS changes with its particles: fix deform remap x, barostats, change_box remap. They
 * are moved without a velocity, so no rate of density sees that their volume has changed. */
#ifndef SD_MOVED_BOX_H
#define SD_MOVED_BOX_H

#include "pointers.h"

namespace StokesDyn {

class MovedBox : protected LAMMPS_NS::Pointers {
 public:
  explicit MovedBox(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp) {}

  /* Owned and ghost particles that were moved with the box since the last call: rho *= V_old / V.
   * Call once per force. In a run the fixes that change the box say whom they move; at its
   * beginning the particles themselves do: all that command change_box has moved kept their place
   * in the box. Returns 0, on all ranks, if the box has changed between two runs and the particles
   * have neither kept their places in it nor their positions. */
  bool follow(double *rho);

 private:
  /* of the last call; 0: there was none */
  double volume = 0.0;
  /* one particle of this rank then: ID (0: there was none), position, position in units of the box */
  struct Witness {
    LAMMPS_NS::tagint tag;
    double x[3], lamda[3];
  } witness = {};

  double present_volume() const;
  int moved_by_fixes() const;
  void remember();
  enum Change { NEITHER, STAYED, MOVED };
  Change between_runs() const;
  bool agrees(const double *x, const double *lamda) const;
};

}    // namespace StokesDyn
#endif
