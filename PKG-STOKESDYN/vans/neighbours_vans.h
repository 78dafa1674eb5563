/* Which commands of LAMMPS go with fix hydro/vans. */
#ifndef SD_NEIGHBOURS_VANS_H
#define SD_NEIGHBOURS_VANS_H

#include "neighbours.h"

#include <vector>

namespace StokesDyn {

/* Facts of a run; the page says them in the words that stand here. */
enum VansFact : unsigned {
  LANGEVIN = 1 << 0,    // with fluctuation langevin
  DRAGS = 1 << 1,       // the water drags grains
};

extern const std::vector<Neighbour> vans_neighbours;

}    // namespace StokesDyn
#endif
