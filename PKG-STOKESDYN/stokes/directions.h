/* Directions of spheres, mu of atom_style dipole, for fix stokes_dynamics/overdamped: they turn with
 * their spheres, by the rotation of the vector dt W (sd_pose.h), W as the scheme takes velocities, or
 * with their clumps. Its length is mu[3], as LAMMPS keeps it. They are turned where positions
 * advance, before LAMMPS tells other ranks of them. Without mu nothing is done. */
#ifndef SD_STOKES_DIRECTIONS_H
#define SD_STOKES_DIRECTIONS_H

#include "rows_fix.h"

#include "atom.h"
#include "pointers.h"

#include <vector>

namespace StokesDyn {

class Directions : protected LAMMPS_NS::Pointers {
 public:
  /* [6] of a sphere: W now, and that of the step before */
  AtomRows turning;

  explicit Directions(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp), turning(6) {}

  /* Does the atom style have any? */
  bool on() const { return atom->mu_flag; }

  /* What a solve has found */
  void look(int i, const double W[3]);
  /* A whole step dt by W of now and before, whose change counts by weight (sd_mean_velocity), and
   * noise [3] times scale */
  void step(int i, double dt, double weight, double scale, const double *noise);
  /* By the vector dt W; by a rotation R */
  void turn(int i, const double W[3], double dt);
  void turn(int i, const double R[9]);

  /* Those of the atoms of this rank, and back: nobody migrates in between. */
  std::vector<double> all() const;
  void restore(const std::vector<double> &from);

 private:
  bool has(int i) const { return on() && atom->mu[i][3] > 0.0; }
};

}    // namespace StokesDyn
#endif
