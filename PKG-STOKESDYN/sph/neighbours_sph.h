/* Which commands of LAMMPS go with the SPH styles. */
#ifndef SD_NEIGHBOURS_SPH_H
#define SD_NEIGHBOURS_SPH_H

#include "neighbours.h"

#include <vector>

namespace StokesDyn {

/* Facts of a run; the page says them in the words that stand here. */
enum SphFact : unsigned {
  CONTINUITY = 1 << 0,    // with fix sph/density/continuity
  GRAINS = 1 << 1,        // with fix sph/grains
  TENSION = 1 << 2,       // with fix sph/tension
};

/* Sorts of particles: those of fix wall/adami/sph, all others that the pair style computes, and
 * grains of fix sph/grains. */
enum SphSort : unsigned { WATER = 1 << 0, WALL = 1 << 1, GRAIN = 1 << 2 };

extern const std::vector<Neighbour> sph_neighbours;

}    // namespace StokesDyn
#endif
