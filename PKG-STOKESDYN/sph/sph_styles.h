/* Registers the SPH styles, if this LAMMPS has the atom style they work on: a plugin cannot supply one. Says
 * so if not. */
#ifndef SD_SPH_STYLES_H
#define SD_SPH_STYLES_H

#include "lammps.h"
#include "lammpsplugin.h"

namespace StokesDyn {

void enroll_sph_styles(void *lmp, lammpsplugin_t plugin, lammpsplugin_regfunc enroll);

}    // namespace StokesDyn
#endif
