/* What is given of the spheres in a step of fix stokes_dynamics/overdamped, and so what a solve is asked:
 * keywords held, pin, spin, torque and squirm, and the forces of LAMMPS. Each sphere has
 *
 *   a velocity    held, as fix move says, or at rest; pinned: of its place alone; spun: of its turning alone
 *   or a load     force and torque, noise apart; a swimmer the slip of its surface too
 *
 * The fix reads the keywords, asks for a Given at each solve, and tells what a solve has found. */
#ifndef SD_STOKES_DRIVES_H
#define SD_STOKES_DRIVES_H

#include "clump_poses.h"
#include "directions.h"
#include "keyword_group.h"
#include "rows_fix.h"
#include "spin.h"
#include "squirmers.h"
#include "torques.h"

#include <vector>

namespace StokesDyn {

class Drives : protected LAMMPS_NS::Pointers {
 public:
  /* [6] scheme midpoint: force and torque on a sphere in the step before */
  AtomRows before;

  Drives(const Voice &voice, Directions &directions) :
      Pointers(voice.lmp), before(6), voice(voice), directions(directions), spin(voice), torques(voice),
      squirmers(voice, directions)
  {
  }
  /* The values of the present keyword, one of the five */
  void read(Keywords &in);
  /* Before a run, in which the fix moves the group of this bit. Errors: groups that do not exist, or overlap;
   * and those of Spin, Torques and Squirmers */
  void init(const Hydrodynamics &hydro, int groupbit);
  /* The keyword that holds somebody, as errors name it, or nothing */
  std::string holds() const;

  /* Torques and strokes of this step. turned: as Torques has it */
  void find(const Torques::Turned &turned);
  /* Ends the run where what LAMMPS has put into f and torque is no number; of those held it counts for
   * nothing. */
  void check_loads(const Hydrodynamics &hydro) const;

  /* Its centre does not go, or as fix move says; that, or pinned; as fix move says */
  bool is_held(int i) const { return atom->mask[i] & held.bit; }
  bool stays(int i) const { return atom->mask[i] & (held.bit | pinned.bit); }
  bool is_moved(int i) const { return is_held(i) && (atom->mask[i] & moved_bits); }
  bool moves_any() const { return moved_bits != 0; }
  /* When a run begins, and in its first step, when fix move has moved them: errors if it leaves one of them
   * free in a direction (NULL) in which a force then moves it without the fluid */
  void note_start();
  void check_moved();
  /* Is anything known of anybody? What is of atom i, and that of its velocity and angular velocity [6] */
  bool holds_any() const { return held.on() || pinned.on() || spin.on(); }
  sd_body_known known(int i, double *V) const;
  /* In the middle of a step, [3 nlocal]: velocities of those that fix move moves; empty: those of atoms */
  std::vector<double> moved_with;

  /* Force and torque [6] on atom i, noise apart, as they are in this step */
  void load(int i, double *FT) const;
  /* What atom i does as a swimmer. false: it is none */
  bool stroke(int i, sd_squirmer_stroke &stroke) const { return squirmers.stroke(i, stroke); }
  /* All of that for a solve. change: loads go on by so many times what they have changed since the step
   * before; drives stand as long as what is given. */
  Given given(double change) const;
  /* What a solve has found of atom i: angular velocity, and the torque of the fluid */
  void note_found(int i, const double *W, const double *by_fluid, double change)
  {
    if (spin.on()) note_spin(i, W, by_fluid, change);
  }
  /* Positions have advanced. */
  void advance() { spin.advance(); }

  /* Rows and number of those overloaded (spin.h) */
  AtomRows &overloaded() { return spin.overloaded; }
  double count_overloaded() const { return spin.count_overloaded(); }

 private:
  const Voice voice;
  Directions &directions;
  KeywordGroup held, pinned;
  /* the groups that fix move moves, if somebody is held */
  int moved_bits = 0;
  /* [3 nlocal] velocities at the beginning of a run; empty: there is nothing to check */
  std::vector<double> at_start;
  Spin spin;
  Torques torques;
  Squirmers squirmers;

  void push(int i, double change, double *FT) const;
  void note_spin(int i, const double *W, const double *by_fluid, double change);
  void refuse_pinned(const Hydrodynamics &hydro) const;
};

}    // namespace StokesDyn
#endif
