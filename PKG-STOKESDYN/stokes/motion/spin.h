/* Spheres that a field keeps spinning, for fix stokes_dynamics/overdamped: their angular velocity is
 * given and the torque that the field needs for it is found, up to a largest one. A sphere that would need
 * more is overloaded: the largest torque drives it, and it is slower than the field, or brakes it, and it is
 * faster.
 *
 * Who is overloaded is decided once a step, by the velocities and torques just found, for the step after
 * the next move: both solves of a step (scheme midpoint) then hold the same coordinates. */
#ifndef SD_STOKES_SPIN_H
#define SD_STOKES_SPIN_H

#include "keyword_group.h"
#include "keywords.h"
#include "pointers.h"
#include "rows_fix.h"

#include "sd_spin.h"

namespace StokesDyn {

class Hydrodynamics;

class Spin : protected LAMMPS_NS::Pointers {
 public:
  /* [2] of one that is overloaded, or will be: 0 or the sign of the torque along the axis, now and next */
  AtomRows overloaded;

  explicit Spin(const Voice &voice) : Pointers(voice.lmp), overloaded(2), voice(voice) {}

  /* GROUP wx wy wz [most] */
  void read(Keywords &in);
  bool on() const { return whom.on(); }
  /* Before a run. Errors: a group that does not exist; settings under which no sphere spins; spheres
   * of it that are in clumps, or held. */
  void init(const Hydrodynamics &hydro, int held_bit);
  /* In each step. Error: the group has gone since. */
  void find() { whom.find(voice.of("keyword spin")); }

  /* Is the angular velocity W of atom i given now? */
  bool turns(int i, double W[3]) const;
  /* The torque of the field on those overloaded is added to theirs. */
  void push(int i, double *torque) const;
  /* What a solve has found: W, and the torque of the fluid. torque: of all but the field, with
   * push() */
  void note_found(int i, const double *W, const double *by_fluid, const double *torque);
  /* Positions have advanced: next is now. */
  void advance();
  /* How many are overloaded, on all ranks */
  double count_overloaded() const;

 private:
  const Voice voice;
  KeywordGroup whom;
  sd_spin_field field = {};

  double sign(int i) const { return overloaded[i][0]; }
};

}    // namespace StokesDyn
#endif
