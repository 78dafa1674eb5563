#include "neighbours_vans.h"

#include "fix_hydro_vans.h"

using namespace LAMMPS_NS;

namespace StokesDyn {

static bool stands_before_stream(const Guest &guest, std::string & /*says*/)
{
  return !stands_behind(guest, FixHydroVans::STYLE);
}

const std::vector<Neighbour> &vans_neighbours()
{
  using N = Neighbour;
  static const std::vector<Neighbour> table = {
      {N::FIX, "wall/reflect*", LANGEVIN, N::WARNING,
       "turns grains back, but not the fluctuation that carries them to its wall: light grains gather "
       "there. Let no wall/reflect stand in the water or at its surface, where this fix turns the "
       "fluctuation itself"},
      {N::FIX, "freeze setforce planeforce lineforce", 0, N::WARNING,
       "stands before this fix in the input, whose forces then move what it holds: define it behind",
       stands_before_stream},
  };
  return table;
}

}    // namespace StokesDyn
