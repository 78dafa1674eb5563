#include "neighbours_vans.h"

#include "fix_hydro_vans.h"

using namespace LAMMPS_NS;

namespace StokesDyn {

static bool stands_before_stream(const Guest &guest, std::string & /*says*/)
{
  return !stands_behind(guest, FixHydroVans::STYLE);
}

static bool stands_behind_stream(const Guest &guest, std::string & /*says*/)
{
  return stands_behind(guest, FixHydroVans::STYLE);
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
      {N::FIX, "rigid* poems shake rattle", DRAGS, N::WARNING,
       "stands before this fix in the input, so that it reads forces before those of the water are added, and every "
       "run begins with a kick: define it behind", stands_before_stream},
      {N::FIX, "viscous langevin* gld gle gjf ffl ttm* nve/dotc/langevin electron/stopping* brownian* lb/*", DRAGS,
       N::WARNING,
       "adds a drag to grains that the water drags as well, so that drag counts twice: take it out; for fluctuations "
       "of the water use the keyword fluctuation"},
      {N::FIX, "nvt* npt* nvk temp/* momentum*", DRAGS, N::WARNING,
       "changes velocities of grains, of which the water feels nothing, so that grains neither fall nor go as the "
       "stream has it, and momentum is lost: take it out"},
      {N::FIX, "damping/cundall", DRAGS, N::WARNING,
       "stands behind this fix in the input and makes forces larger that oppose a velocity, and so also the drag of "
       "the water: define it before", stands_behind_stream},
      {N::FIX, "srd", DRAGS, N::WARNING,
       "has a fluid of its own: its big particles must be none of the grains that this water drags; this cannot be "
       "checked", nullptr, N::ANYWHERE},
      {N::COMMAND, "timestep", 0, N::ERROR,
       "is {}, and neither drag nor the friction of the water have a way back: use a positive one", runs_back,
       N::ANYWHERE},
  };
  return table;
}

}    // namespace StokesDyn
