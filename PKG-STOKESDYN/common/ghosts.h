/* How many ghost atoms a length asks LAMMPS for, before it sets out to make them. */
#ifndef SD_GHOSTS_H
#define SD_GHOSTS_H

#include "lammps.h"

#include <string>

namespace StokesDyn {

/* A cut-off (the skin is added) for which LAMMPS would make ghosts without end: no counter of its own
 * may overflow, and where the length is more than ten periodic boxes ten million atoms in all images
 * are enough. Error: "<what> is <n> times the box, which is more than LAMMPS can make ghost atoms for:
 * is it in other units?" */
void refuse_endless_ghosts(LAMMPS_NS::LAMMPS *lmp, const std::string &what, double length);

}    // namespace StokesDyn
#endif
