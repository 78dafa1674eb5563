/* Settings of LAMMPS that keep particles of SPH from being neighbours. Water then flows through its walls
 * or through itself, and nothing else would say so. Wall particles among themselves may be kept apart. */
#ifndef SD_LOST_PAIRS_H
#define SD_LOST_PAIRS_H

#include "neighbours.h"

namespace StokesDyn {

/* Each for a row of the table of neighbours (Neighbour::matters): does this setting lose a pair of which one
 * particle is no wall? says: what is lost. On all ranks together, when a run has been prepared. */

/* neigh_modify exclude type, group, molecule, molecule/intra, molecule/inter */
bool loses_by_exclude(const Guest &guest, std::string &says);
/* neigh_modify include */
bool loses_by_include(const Guest &guest, std::string &says);
/* comm_modify group */
bool loses_ghosts(const Guest &guest, std::string &says);
/* special_bonds with factors of 0 */
bool loses_by_bonds(const Guest &guest, std::string &says);
/* pair_coeff of a hybrid that gives two types to other styles alone */
bool loses_by_types(const Guest &guest, std::string &says);

}    // namespace StokesDyn
#endif
