/* fix sph/density/continuity, sph/density/summation, sph/density/corr: where the density comes
 * from. The sums themselves run inside the pair style. See doc/fix_sph_density.md. */
#ifndef SD_FIX_SPH_DENSITY_H
#define SD_FIX_SPH_DENSITY_H

#include "sph_fix.h"

namespace StokesDyn {

class FixSphDensityContinuity : public SphOutputFix {
 public:
  static constexpr const char *STYLE = "sph/density/continuity";
  FixSphDensityContinuity(LAMMPS_NS::LAMMPS *, int, char **);
  // density diffusion
  double delta = 0.0;
  // fluids of different density
  bool volume = false;
};

class FixSphDensitySummation : public SphFix {
 public:
  static constexpr const char *STYLE = "sph/density/summation";
  FixSphDensitySummation(LAMMPS_NS::LAMMPS *, int, char **);
};

class FixSphDensityCorr : public SphFix {
 public:
  static constexpr const char *STYLE = "sph/density/corr";
  FixSphDensityCorr(LAMMPS_NS::LAMMPS *, int, char **);
  LAMMPS_NS::bigint every = 1;
};

}    // namespace StokesDyn
#endif
