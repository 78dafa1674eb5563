/* Internal fix: implicit friction of pair_style sph/artVisc/tensCorr is made when all that acts on the
 * particles is known, so this fix is always the last. */
#ifndef SD_FIX_SPH_FRICTION_H
#define SD_FIX_SPH_FRICTION_H

#include "fix.h"

namespace StokesDyn {

class FixSphFriction : public LAMMPS_NS::Fix {
 public:
  static constexpr const char *STYLE = "SPH/FRICTION";

  /* When LAMMPS prepares a run: made anew, behind all others, or none is left. */
  static void provide(LAMMPS_NS::LAMMPS *lmp, bool wanted);

  FixSphFriction(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg) {}
  int setmask() override;
  void setup(int) override;
  void post_force(int) override;
};

}    // namespace StokesDyn
#endif
