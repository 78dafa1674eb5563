/* Directions of spheres for fix stokes_dynamics/overdamped: mu of atom_style dipole, the quaternion of
 * atom_style ellipsoid, and quat of atom styles that have one for each atom (bpm/sphere). They turn with
 * their spheres, by the rotation of the vector dt W (sd_pose.h), W as the scheme takes velocities, or
 * with their clumps. The length of mu is mu[3], as LAMMPS keeps it, that of a quaternion 1. They are
 * turned where positions advance, before LAMMPS tells other ranks of them. Without any nothing is done. */
#ifndef SD_STOKES_DIRECTIONS_H
#define SD_STOKES_DIRECTIONS_H

#include "rows_fix.h"

#include "sd_pose.h"

#include "atom.h"
#include "pointers.h"

#include <vector>

namespace LAMMPS_NS {
class AtomVecEllipsoid;
}

namespace StokesDyn {

class Directions : protected LAMMPS_NS::Pointers {
 public:
  /* [10] of a sphere: W now, and that of the step before; where fix move moves some, its quaternion as it
   * was when W was found */
  AtomRows turning;

  explicit Directions(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp), turning(10) {}
  /* Before a run. moved: are there spheres that fix move moves? */
  void init(bool moved);

  /* Does the atom style have any? */
  bool on() const;

  /* The quaternion of atom i, which turns its axes to those of space. false: it has none */
  bool quaternion(int i, double q[4]) const;
  /* Its direction, of length 1: mu, or without one the z axis of the quaternion. false: none */
  bool direction(int i, double e[3]) const;

  /* What a solve has found */
  void note_found(int i, const double W[3]);
  /* The turn w [3] of a whole step: by W of now and before, and y [3] of the noise (nullptr: none). W of now
   * is that of before then. Without a direction 0 */
  void turn_of_step(int i, const sd_step &step, const double *y, double w[3]);
  /* By the vector dt W; by a rotation R */
  void turn(int i, const double W[3], double dt);
  void turn(int i, const double R[9]);
  /* The same by W, of a sphere that fix move has moved: its option rotate has turned the quaternion of an
   * ellipsoid by now, other options have not. */
  void turn_moved(int i, const double W[3], double dt);

  /* Those of the atoms of this rank, and back: nobody migrates in between. */
  std::vector<double> all() const;
  void restore(const std::vector<double> &from);

 private:
  /* of atom_style ellipsoid; LAMMPS looks it up by name */
  LAMMPS_NS::AtomVecEllipsoid *ellipsoids = nullptr;
  bool any_moved = false;

  bool has_moment(int i) const { return atom->mu_flag && atom->mu[i][3] > 0.0; }
  void set_quaternion(int i, const double q[4]);
};

}    // namespace StokesDyn
#endif
