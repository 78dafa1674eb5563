/* How a run ended: the sum of a hash of all velocities of a group, and the fingerprint of all places, radii
 * and masses (sd_hash_add_row). If they are the same when a run begins, nobody has changed any of
 * them in between, and what the last step found with velocities at half step still stands.
 * Velocities must be the same to the bit; unwrapped places are so within rounding (common/resume.h
 * has rows, which cost 64 bytes an atom; sums have no order, so that 24 bytes in all will do on any
 * number of ranks). */
#ifndef SD_END_OF_RUN_H
#define SD_END_OF_RUN_H

#include "restart.h"

#include "pointers.h"

#include <cstdint>

namespace StokesDyn {

class EndOfRun : protected LAMMPS_NS::Pointers {
 public:
  explicit EndOfRun(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp) {}

  /* on all ranks together */
  void record(int groupbit);
  bool still_stands(int groupbit) const;
  /* In mid-run, or after a run, there is a state that a run can go on from; before any there is none. */
  void write(int groupbit, NamedState &);
  void read(const NamedState &);

 private:
  /* the fingerprint, and the sum of the sizes of its numbers: negative before any run has ended */
  double places = 0.0, size = -1.0;
  uint64_t velocities = 0;
};

}    // namespace StokesDyn
#endif
