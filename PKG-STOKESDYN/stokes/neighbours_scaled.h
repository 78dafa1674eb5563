/* pair_style hybrid/scaled, which tells its factors to restart files only. */
#ifndef SD_NEIGHBOURS_SCALED_H
#define SD_NEIGHBOURS_SCALED_H

#include "neighbours.h"

#include <string>

namespace StokesDyn {

/* Does the guest scale forces of pair_style stokes_dynamics? says: by what, a number or a variable */
bool scales_us(const Guest &guest, std::string &says);

}    // namespace StokesDyn
#endif
