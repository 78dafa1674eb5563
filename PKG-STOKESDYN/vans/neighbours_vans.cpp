#include "neighbours_vans.h"

namespace StokesDyn {

const std::vector<Neighbour> &vans_neighbours()
{
  using N = Neighbour;
  static const std::vector<Neighbour> table = {
      {N::FIX, "wall/reflect*", LANGEVIN, N::WARNING,
       "turns grains back, but not the fluctuation that carries them to its wall: light grains gather "
       "there. Let no wall/reflect stand in the water or at its surface, where this fix turns the "
       "fluctuation itself"},
  };
  return table;
}

}    // namespace StokesDyn
