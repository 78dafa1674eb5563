#include "neighbours_vans.h"

#include "fix_hydro_vans.h"

#include "domain.h"
#include "pair.h"

#include <cstdio>
#include <memory>

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

/* A restart file has the viscosity of these pair styles, flaglog and flagfld first. */
static bool drags_each(const Guest &guest, std::string &says)
{
  double viscosity;
  int flags[2];
  std::unique_ptr<FILE, int (*)(FILE *)> file(tmpfile(), fclose);
  if (!file) return false;
  guest.pair->write_restart_settings(file.get());
  rewind(file.get());
  if (fread(&viscosity, sizeof(viscosity), 1, file.get()) != 1 || fread(flags, sizeof(int), 2, file.get()) != 2)
    return false;
  says = std::to_string(flags[1]);
  return flags[1] == 1;
}

static bool has_no_ends(const Guest &guest, std::string & /*says*/)
{
  return guest.lmp->domain->zperiodic;
}

using N = Neighbour;

const std::vector<Neighbour> vans_neighbours = {
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
    {N::FIX, "rigid*", DRAGS, N::WARNING,
     "has a drag of its own (keyword langevin) on grains that the water drags as well, so that drag counts twice: "
     "leave langevin out; for fluctuations of the water use the keyword fluctuation", has_bath},
    {N::PAIR, "lubricate lubricate/poly", DRAGS, N::WARNING,
     "has a drag of its own on each grain (flagfld {}), and the water drags grains as well, so that drag counts "
     "twice: give it flagfld 0", drags_each},
    {N::FIX, "nvt* npt* nvk temp/* rigid/nvt* rigid/npt* bocs hmc momentum* viscosity thermal/conductivity heat ehex",
     DRAGS, N::WARNING,
     "changes velocities of grains, of which the water feels nothing, so that grains neither fall nor go as the "
     "stream has it, and momentum is lost: take it out"},
    {N::FIX, "damping/cundall", DRAGS, N::WARNING,
     "stands behind this fix in the input and makes forces larger that oppose a velocity, and so also the drag of "
     "the water: define it before", stands_behind_stream},
    {N::FIX, "srd", DRAGS, N::WARNING,
     "has a fluid of its own: its big particles must be none of the grains that this water drags; this cannot be "
     "checked", nullptr, N::ANYWHERE},
    {N::COMMAND, "neigh_modify", DRAGS, N::ERROR,
     "has {}: its forces of all steps add up, as LAMMPS clears those of the group alone: name a group with all "
     "grains of this fix, or take it out", leaves_out},
    {N::COMMAND, "timestep", 0, N::ERROR,
     "is {}, and neither drag nor the friction of the water have a way back: use a positive one", runs_back,
     N::ANYWHERE},
    {N::COMMAND, "boundary", DRAGS, N::WARNING,
     "is periodic along z: a grain that leaves the box through its top comes back at its bottom, and touches what is "
     "there; the stream has a bottom and a top: use p p f", has_no_ends},
};

}    // namespace StokesDyn
