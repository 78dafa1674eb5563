/* fix sph/density/continuity, sph/density/summation, sph/density/corr: where the density comes
 * from. The sums themselves run inside the pair style. See doc/fix_sph_density.md. */
#ifndef SD_FIX_SPH_DENSITY_H
#define SD_FIX_SPH_DENSITY_H

#include "fix_sph_output.h"

namespace StokesDyn {

class FixSphDensityContinuity : public FixSphOutput {
 public:
  static constexpr const char *STYLE = "sph/density/continuity";
  FixSphDensityContinuity(LAMMPS_NS::LAMMPS *, int, char **);
  // density diffusion
  double delta = 0.0;
};

class FixSphDensitySummation : public LAMMPS_NS::Fix {
 public:
  static constexpr const char *STYLE = "sph/density/summation";
  FixSphDensitySummation(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override { return 0; }
  void init() override;
};

class FixSphDensityCorr : public LAMMPS_NS::Fix {
 public:
  static constexpr const char *STYLE = "sph/density/corr";
  FixSphDensityCorr(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override { return 0; }
  void init() override;
  LAMMPS_NS::bigint every = 1;
};

}    // namespace StokesDyn
#endif
