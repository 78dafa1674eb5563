/* Which commands of LAMMPS go with the SPH styles. */
#ifndef SD_NEIGHBOURS_SPH_H
#define SD_NEIGHBOURS_SPH_H

#include "neighbours.h"

#include <vector>

namespace StokesDyn {

/* Facts of a run; the page says them in the words that stand here. */
enum SphFact : unsigned {
  CONTINUITY = 1 << 0,    // with fix sph/density/continuity
};

/* Sorts of particles: those of fix wall/adami/sph, and all others that the pair style computes. */
enum SphSort : unsigned { WATER = 1 << 0, WALL = 1 << 1 };

const std::vector<Neighbour> &sph_neighbours();

}    // namespace StokesDyn
#endif
