/* fix sph/pressure: the equation of state. See doc/fix_sph_pressure.md. */
#ifndef SD_FIX_SPH_PRESSURE_H
#define SD_FIX_SPH_PRESSURE_H

#include "sph_fix.h"
#include "sd_sph_pressure.h"

namespace StokesDyn {

class FixSphPressure : public SphOutputFix {
 public:
  static constexpr const char *STYLE = "sph/pressure";

  FixSphPressure(LAMMPS_NS::LAMMPS *, int, char **);
  /* A particle that is made (fix deposit, create_atoms) has no density: it gets rho0, if the
   * equation of state has one. */
  void set_arrays(int) override;

  sd_sph_state state = {};
};

}    // namespace StokesDyn
#endif
