/* fix sph/outlet: see doc/fix_sph_inlet.md. */
#ifndef SD_FIX_SPH_OUTLET_H
#define SD_FIX_SPH_OUTLET_H

#include "fix_sph_opening.h"

namespace StokesDyn {

/* Particles of its layer move across the plane as the fluid before them does, and have a given pressure.
 * They are deleted at its end. */
class FixSphOutlet : public FixSphOpening {
 public:
  static constexpr const char *STYLE = "sph/outlet";

  FixSphOutlet(LAMMPS_NS::LAMMPS *, int, char **);
  void setup_pre_exchange() override;
  void pre_exchange() override;
  void post_integrate() override;
  bool gives_pressure() const override { return true; }
};

}    // namespace StokesDyn
#endif
