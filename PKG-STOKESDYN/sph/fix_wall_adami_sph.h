/* fix wall/adami/sph: fixed particles that carry the pressure of the fluid before them, with or
 * without slip. See doc/fix_wall_adami_sph.md. */
#ifndef SD_FIX_WALL_ADAMI_SPH_H
#define SD_FIX_WALL_ADAMI_SPH_H

#include "field.h"
#include "sph_fix.h"

namespace StokesDyn {

class FixWallAdamiSph : public WallFix {
 public:
  static constexpr const char *STYLE = "wall/adami/sph";

  FixWallAdamiSph(LAMMPS_NS::LAMMPS *, int, char **);
  void init() override;
  void post_force(int) override;

  /* per mass, as the wall sees it; now */
  const double *body_force();
  bool slip = false;

 private:
  Field gravity[3];
  double b[3] = {0.0, 0.0, 0.0};
};

}    // namespace StokesDyn
#endif
