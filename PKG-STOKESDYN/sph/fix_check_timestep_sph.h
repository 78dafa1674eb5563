/* fix check/timestep/sph: is the time step small enough? See doc/fix_check_timestep_sph.md. */
#ifndef SD_FIX_CHECK_TIMESTEP_SPH_H
#define SD_FIX_CHECK_TIMESTEP_SPH_H

#include "sph.h"

#include <vector>

namespace StokesDyn {

class FixCheckTimestepSph : public SphFix {
 public:
  static constexpr const char *STYLE = "check/timestep/sph";

  FixCheckTimestepSph(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override;
  void setup(int) override;
  void end_of_step() override;
  double compute_scalar() override { return ratio; }
  double compute_vector(int k) override { return k == 0 ? limit : worst; }

 private:
  double fraction = 0.0;
  bool stop = false;
  // smallest limit, number of its particle, time step over limit
  double limit = 0.0, worst = 0.0, ratio = 0.0;
  std::vector<double> largest;
};

}    // namespace StokesDyn
#endif
