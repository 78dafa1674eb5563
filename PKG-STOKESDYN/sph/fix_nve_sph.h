/* fix nve/sph and fix nve/sph/stationary: time integration of SPH particles. See doc/fix_nve_sph.md. */
#ifndef SD_FIX_NVE_SPH_H
#define SD_FIX_NVE_SPH_H

#include "fix.h"

#include <cstdint>

namespace StokesDyn {

class FixNveSph : public LAMMPS_NS::Fix {
 public:
  static constexpr const char *STYLE = "nve/sph";

  FixNveSph(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void initial_integrate(int) override;
  void final_integrate() override;
  void post_run() override;
  void reset_dt() override;
  void write_restart(FILE *) override;
  void restart(char *) override;

  /* At set-up: nobody has changed a velocity since this fix did, so vest still is the estimate the unbroken
   * run would use. Collective. */
  bool resumes() const;

 private:
  struct State {
    double format, step;
    uint64_t velocities;
  } left = {1.0, -1.0, 0};
  double dtv = 0.0, dtf = 0.0;
  State state_now() const;
};

class FixNveSphStationary : public LAMMPS_NS::Fix {
 public:
  static constexpr const char *STYLE = "nve/sph/stationary";

  FixNveSphStationary(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override { return 0; }
  void init() override;
};

}    // namespace StokesDyn
#endif
