/* fix stokes_dynamics/overdamped: motion without inertia of spheres and rigid clumps. See
 * doc/fix_stokes_dynamics_overdamped.md.
 *
 *   initial_integrate   positions of the next step, from the velocities of this one and the last
 *   [lists, ghosts, forces of all styles and fixes]
 *   final_integrate     velocities, of the positions just reached; likewise in setup, last of all */
#ifndef SD_FIX_STOKES_DYNAMICS_OVERDAMPED_H
#define SD_FIX_STOKES_DYNAMICS_OVERDAMPED_H

#include "rows_fix.h"
#include "velocities.h"

namespace StokesDyn {

class Hydrodynamics;

class FixStokesDynamicsOverdamped : public RowsFix {
 public:
  static constexpr const char *STYLE = "stokes_dynamics/overdamped";

  /* Before a run: is there such a fix? Then it will find the velocities after the setup of all
   * others. */
  static bool prepare(LAMMPS_NS::LAMMPS *lmp);

  FixStokesDynamicsOverdamped(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void after_setup();
  void initial_integrate(int) override;
  void final_integrate() override;
  void end_of_step() override;

  double compute_scalar() override;
  double compute_vector(int) override;

  void write_restart(FILE *) override;
  void restart(char *) override;

 private:
  enum { AB2, EULER } scheme = AB2;
  struct {
    int every = 0;    // 0: the step is the user's
    double tmin, tmax, xmax;
  } adapt;

  /* velocity of a free sphere, U and W of its clump, in the step before the one that the atom
   * stands in */
  AtomRows before;
  /* v less that of the fluid, force, torque */
  AtomArray output;
  /* also in restart files: the step of the velocities (-1: never), its length; the length that
   * adapt wants next */
  struct {
    double step = -1, dt = 0.0, next_dt = 0.0;
  } last;
  bool from_file = false;

  /* of this rank: largest displacement over radius in the last step, and the largest change of
   * velocity by it; in the step before */
  double displaced = 0.0, changed = 0.0, changed_before = 0.0;
  int doublings = 0;
  bool warned_growth = false, announced = false;

  bool restored() const override { return last.step >= 0; }
  Hydrodynamics &hydrodynamics() const;
  bool goes_on(const Hydrodynamics &) const;
  void announce();
  void find_velocities(Hydrodynamics &);
  void check_selection(const Hydrodynamics &) const;
  double weight(int i) const;
  void moves(int i, double distance, double change);
  void move_free(int i);
  void move_clumps(Hydrodynamics &);
  std::vector<double> velocities_before() const;
  void watch();
  double fastest() const;
  double error_figure() const;
  double smallest_gap() const;
};

/* Internal: in setup, fixes add their forces one after the other as they were defined, and
 * velocities must wait for all. This one is always the last. */
class FixStokesDynamicsLast : public LAMMPS_NS::Fix {
 public:
  static constexpr const char *STYLE = "STOKES_DYNAMICS/LAST";
  static constexpr const char *ID = "STOKES_DYNAMICS_LAST";

  FixStokesDynamicsLast(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg) {}
  int setmask() override { return 0; }
  void setup(int) override;
};

}    // namespace StokesDyn
#endif
