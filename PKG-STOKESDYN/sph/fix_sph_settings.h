/* The fixes that hold settings of pair_style sph/artVisc/tensCorr, which runs the sums itself. */
#ifndef SD_FIX_SPH_SETTINGS_H
#define SD_FIX_SPH_SETTINGS_H

#include "sd_sph_pressure.h"
#include "sph.h"

#include <string>
#include <vector>

namespace StokesDyn {

/* fix sph/pressure: the equation of state. See doc/fix_sph_pressure.md. */
class FixSphPressure : public SphOutputFix {
 public:
  static constexpr const char *STYLE = "sph/pressure";

  FixSphPressure(LAMMPS_NS::LAMMPS *, int, char **);
  /* A particle that is made (fix deposit, create_atoms) has no density: it gets rho0, if the
   * equation of state has one. */
  void set_arrays(int) override;

  sd_sph_state state = {};
};

/* fix sph/density/continuity, sph/density/summation, sph/density/corr: where the density comes from.
 * See doc/fix_sph_density.md. */
class FixSphDensityContinuity : public SphOutputFix {
 public:
  static constexpr const char *STYLE = "sph/density/continuity";
  FixSphDensityContinuity(LAMMPS_NS::LAMMPS *, int, char **);
  void post_run() override { computed = -1; }
  // the latest step of this run whose forces the pair style has computed; -1: none
  LAMMPS_NS::bigint computed = -1;
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

/* fix property/global: speed of sound and smoothing length by type, as inputs of LIGGGHTS give them.
 * See doc/pair_sph_artvisc_tenscorr.md. */
class FixPropertyGlobal : public LAMMPS_NS::Fix {
 public:
  static constexpr const char *STYLE = "property/global";

  FixPropertyGlobal(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override { return 0; }

  // speedOfSound or sl, and its value for types 1, 2, ...
  std::string property;
  std::vector<double> of_type;
};

}    // namespace StokesDyn
#endif
