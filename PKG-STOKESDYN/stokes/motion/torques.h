/* Given torques on spheres, for fix stokes_dynamics/overdamped: numbers or variables, along the axes of
 * space or along those of each sphere. They are found once a step, where forces are, and act beside
 * the torques of LAMMPS.
 *
 * Axes of a sphere: those of its quaternion; without one its dipole, which is a z axis alone; without
 * either, in a rigid clump, the axes of space when the fix was given, turned as the clump has since. */
#ifndef SD_STOKES_TORQUES_H
#define SD_STOKES_TORQUES_H

#include "directions.h"
#include "field.h"
#include "keyword_group.h"
#include "keywords.h"
#include "pointers.h"

#include <functional>
#include <vector>

namespace StokesDyn {

class Hydrodynamics;

class Torques : protected LAMMPS_NS::Pointers {
 public:
  explicit Torques(const Voice &voice) : Pointers(voice.lmp), voice(voice.of("keyword torque")) {}

  /* GROUP Tx Ty Tz [body yes|no] */
  void read(Keywords &in);
  bool on() const { return whom.on(); }
  /* Before a run. Errors: a group or variable that does not exist; spheres of it that do not turn, are
   * held, or are not of the fix. */
  void init(const Hydrodynamics &hydro, int groupbit, int held_bit);

  /* The torques of this step. turned(i): quaternion [4] by which the clump of atom i has turned, nullptr:
   * it is in none. Errors, of one rank: a sphere without axes, one with an axis along which the
   * torque is not. */
  using Turned = std::function<const double *(int i)>;
  void find(const Directions &directions, const Turned &turned);
  void add(int i, double *torque) const;

 private:
  const Voice voice;
  KeywordGroup whom;
  Field T[3];
  bool of_body = false;
  /* [3 nlocal] */
  std::vector<double> now;

  void turn(int i, const Directions &directions, const double *turned);
};

}    // namespace StokesDyn
#endif
