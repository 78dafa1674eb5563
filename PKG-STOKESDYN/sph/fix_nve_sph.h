/* fix nve/sph and fix nve/sph/stationary: time integration of SPH particles. See
 * doc/fix_nve_sph.md. */
#ifndef SD_FIX_NVE_SPH_H
#define SD_FIX_NVE_SPH_H

#include "end_of_run.h"
#include "sph.h"

namespace StokesDyn {

class FixNveSph : public SphFix {
 public:
  static constexpr const char *STYLE = "nve/sph";

  FixNveSph(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override;
  void setup_pre_exchange() override;
  void setup_pre_force(int vflag) override { pre_force(vflag); }
  void initial_integrate(int) override;
  void pre_force(int) override;
  void final_integrate() override;
  void post_run() override;

  /* Has this run gone on from the end of the last one, with nothing changed? */
  bool resumes() const { return goes_on; }

 private:
  bool goes_on = false;
  /* of the atoms and their ghosts: vest is the difference to v, not yet the estimate itself */
  bool relative = false;

  EndOfRun end;
  void write_state(NamedState &) override;
  void read_state(const NamedState &) override;
};

class FixNveSphStationary : public SphFix {
 public:
  static constexpr const char *STYLE = "nve/sph/stationary";

  FixNveSphStationary(LAMMPS_NS::LAMMPS *, int, char **);
};

}    // namespace StokesDyn
#endif
