/* What each part of a step of pair_style sph/artVisc/tensCorr works on: densities, walls, viscosities, forces
 * and checks are parts. */
#ifndef SD_SPH_PART_H
#define SD_SPH_PART_H

#include "sph_rows.h"

namespace StokesDyn {

class SphPart : protected LAMMPS_NS::Pointers {
 public:
  SphPart(const SphCoefficients &settings, const SphRoles &roles, SphRows &rows, GhostExchange &ghosts) :
      Pointers(settings.voice.lmp), settings(settings), roles(roles), rows(rows), ghosts(ghosts),
      voice(settings.voice)
  {
  }

 protected:
  const SphCoefficients &settings;
  const SphRoles &roles;
  SphRows &rows;
  GhostExchange &ghosts;
  const Voice &voice;
};

}    // namespace StokesDyn
#endif
