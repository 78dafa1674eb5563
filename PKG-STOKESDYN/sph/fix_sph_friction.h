/* Internal fix: implicit friction of pair_style sph/artVisc/tensCorr is made when all that acts on the
 * particles is known, so this fix is always the last: the pair style makes it anew before each run. */
#ifndef SD_FIX_SPH_FRICTION_H
#define SD_FIX_SPH_FRICTION_H

#include "pair_sph_artvisc_tenscorr.h"

namespace StokesDyn {

class FixSphFriction : public SphFix {
 public:
  static constexpr const char *STYLE = PairSph::FRICTION_STYLE;

  using SphFix::SphFix;
  int setmask() override;
  void setup(int) override;
  void post_force(int) override;
};

}    // namespace StokesDyn
#endif
