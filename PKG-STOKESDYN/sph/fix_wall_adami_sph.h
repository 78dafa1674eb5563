/* fix wall/adami/sph: fixed particles that carry the pressure of the fluid before them, with or
 * without slip. See doc/fix_wall_adami_sph.md. */
#ifndef SD_FIX_WALL_ADAMI_SPH_H
#define SD_FIX_WALL_ADAMI_SPH_H

#include "sph.h"

namespace StokesDyn {

class FixWallAdamiSph : public WallFix {
 public:
  static constexpr const char *STYLE = "wall/adami/sph";

  FixWallAdamiSph(LAMMPS_NS::LAMMPS *, int, char **);
  void init() override;
  void post_force(int) override;

  /* Per mass, as wall particle i sees it: gravity, with own_acceleration less that of the particle,
   * a mean over the time tau; once a step. */
  const double *body_force(int i, double tau);
  bool slip = false, suction = true;
  BodyForce gravity;

 private:
  bool own_acceleration = false;
  double b[3] = {0.0, 0.0, 0.0};
  /* velocity at the last force, acceleration */
  AtomArray motion;
};

}    // namespace StokesDyn
#endif
