/* How many ghost atoms a length asks LAMMPS for, before it sets out to make them. */
#ifndef SD_GHOSTS_H
#define SD_GHOSTS_H

#include "lammps.h"

#include <string>

namespace StokesDyn {

/* Of a cut-off and the skin beyond it: in boxes (in periodic directions alone), the atoms of all
 * periodic images within it, and whether LAMMPS could ever come to an end with them: no counter of
 * its own may overflow, and where the length is more than ten periodic boxes ten million are enough
 * (a box of one sphere, or a mistake in units). */
struct GhostNeed {
  double boxes, periodic_boxes, atoms;
  bool endless;
};
GhostNeed ghosts_for(LAMMPS_NS::LAMMPS *lmp, double length);

/* An error if they have no end: "<what> is <n> times the box, which is more than LAMMPS can make ghost
 * atoms for: is it in other units?<way_out>" */
void refuse_endless_ghosts(LAMMPS_NS::LAMMPS *lmp, const std::string &what, double length,
                           const std::string &way_out = "");

}    // namespace StokesDyn
#endif
