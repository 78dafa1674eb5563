/* fix stokes_dynamics: adds the force of pair_style stokes_dynamics where the pair style does not, and reports it.
 * See doc/fix_stokes_dynamics.md. */
#ifndef SD_FIX_STOKES_DYNAMICS_H
#define SD_FIX_STOKES_DYNAMICS_H

#include "fix.h"

namespace StokesDyn {

class PairStokesDynamics;

class FixStokesDynamics : public LAMMPS_NS::Fix {
 public:
  static constexpr const char *STYLE = "stokes_dynamics";

  FixStokesDynamics(LAMMPS_NS::LAMMPS *, int, char **);
  ~FixStokesDynamics() override;
  int setmask() override;
  void init() override;
  void setup(int) override;
  void post_force(int) override;
  double compute_scalar() override;
  double compute_vector(int) override;
  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  double memory_usage() override;

  /* Does this fix add the force, given whether the pair style does? */
  bool applies(bool pair_adds) const { return apply == YES || (apply == UNSAID && !pair_adds); }

 private:
  enum { NO, YES, UNSAID } apply = UNSAID;
  enum { NCOLUMNS = 9 };    // Fx Fy Fz v'x v'y v'z Tx Ty Tz
  PairStokesDynamics *pair = nullptr;
  double total[4];    // F and dissipation of the group, this rank
  PairStokesDynamics *find_pair();
};

}    // namespace StokesDyn
#endif
