#include "neighbours_sph.h"

#include "fix_sph_grains.h"
#include "lost_pairs.h"
#include "pair_sph_artvisc_tenscorr.h"
#include "ranks.h"

#include "atom.h"
#include "fix.h"
#include "force.h"
#include "group.h"
#include "update.h"

using namespace LAMMPS_NS;

namespace StokesDyn {

// --- what the name of a style does not tell ------------------------------------------------------

static bool lets_sound_grow(const Guest &guest, std::string &says)
{
  const auto *pair = static_cast<const PairSph *>(guest.lmp->force->pair_match(Sph::PAIR_STYLE, 1));
  const double limit = pair->growth_limit(guest.fix->groupbit);
  says = text(limit);
  return guest.lmp->update->dt > limit * (1.0 + 1e-9);
}

static bool moves_a_part(const Guest &guest, std::string & /*says*/)
{
  const auto *pair = static_cast<const PairSph *>(guest.lmp->force->pair_match(Sph::PAIR_STYLE, 1));
  const int *mask = guest.lmp->atom->mask, bit = guest.fix->groupbit;
  return first_atom(guest.lmp, [=](int i) { return pair->is_particle(i) && !(mask[i] & bit); }) != 0;
}

static bool is_dynamic(const Guest &guest, std::string &says)
{
  const Group *group = guest.lmp->group;
  says = group->names[guest.fix->igroup];
  return group->dynamic[guest.fix->igroup] != 0;
}

static bool stands_behind_grains(const Guest &guest, std::string & /*says*/)
{
  return stands_behind(guest, FixSphGrains::STYLE);
}

static bool stands_before_grains(const Guest &guest, std::string &says)
{
  return !stands_behind_grains(guest, says);
}

// --- the table -----------------------------------------------------------------------------------

using N = Neighbour;

const std::vector<Neighbour> sph_neighbours = {
    // another density, another pressure
    {N::PAIR, "sph/rhosum sph/taitwater* sph/idealgas sph/lj rheo*", 0, N::ERROR,
     "sets the density or adds the pressure of particles for which pair_style sph/artVisc/tensCorr "
     "does that: take one of the two out, or give them other types"},
    {N::FIX, "rheo*", 0, N::ERROR,
     "moves particles and advances their density, which is the task of fix nve/sph here: take it "
     "out, or use pair_style rheo"},
    // who sees whom
    {N::COMMAND, "neigh_modify", 0, N::ERROR,
     "has {}: take it out; only particles of fix wall/adami/sph may be kept from each other", loses_by_exclude,
     N::ANYWHERE},
    {N::COMMAND, "neigh_modify", 0, N::ERROR,
     "has {}: name a group with all particles of water and walls, or take it out", loses_by_include, N::ANYWHERE},
    {N::COMMAND, "comm_modify", 0, N::ERROR,
     "has {}: name a group with all particles of water and walls, or take it out", loses_ghosts, N::ANYWHERE},
    {N::COMMAND, "special_bonds", 0, N::ERROR,
     "has a factor 0 and keeps {} from those that it is bonded to, which it must see: use special_bonds lj/coul "
     "1 1 1", loses_by_bonds, N::ANYWHERE},
    {N::COMMAND, "pair_coeff", 0, N::WARNING,
     "leaves out {}: where they meet, one flows through the other. Use pair_coeff I J sph/artVisc/tensCorr for "
     "both types", loses_by_types, N::ANYWHERE},
    // another motion
    {N::FIX, "sph", CONTINUITY, N::WARNING,
     "lets sound grow at time steps above {} (3 alpha h/(8 c) in two dimensions, less in three), "
     "until the water boils: use fix nve/sph", lets_sound_grow, WATER},
    {N::FIX, "nve/sph nve/sph/stationary wall/adami/sph sph/grains", 0, N::ERROR,
     "has the dynamic group {}, which is empty when the first forces are computed, and in some LAMMPS is always "
     "that of the step before: use a group of fixed members, made anew between runs", is_dynamic, N::ANYWHERE},
    {N::FIX, "recenter", 0, N::WARNING,
     "moves some of the particles without a velocity, so that the density knows nothing of it: name a group with "
     "all particles of water and walls, or take it out", moves_a_part},
    {N::FIX, "temp/* langevin* heat ehex", 0, N::WARNING,
     "changes velocities of the water, which are its flow: take it out before the run that counts", nullptr, WATER},
    {N::COMMAND, "timestep", 0, N::ERROR,
     "is {}, and friction would drive velocities apart on the way back: use a positive one", runs_back, N::ANYWHERE},
    // walls
    {N::FIX, "wall/reflect* wall/lj* wall/harmonic* wall/morse wall/table wall/lepton wall/colloid "
             "wall/region wall/gran*", 0, N::WARNING,
     "is no wall for water: there is nothing behind it that has a pressure, so that the water boils "
     "beside it: use particles of a wall (fix wall/adami/sph)", nullptr, WATER},
    {N::FIX, "rigid*", TENSION, N::WARNING,
     "moves a body that feels the pressure of the water, but not the pull of its surface at the contact line: "
     "what floats by surface tension sinks", nullptr, WALL},
    // grains
    {N::FIX, "hydro/vans viscous* langevin* lb/*", GRAINS, N::ERROR,
     "drags grains that the water of SPH drags already: take it out, or give it other atoms", nullptr, GRAIN},
    // what goes together
    {N::FIX, "gravity addforce efield spring* drag wall/gran*", GRAINS, N::ERROR,
     "stands behind fix sph/grains in the input, whose drag is implicit, so that it must know all other forces: "
     "define it before", stands_behind_grains, GRAIN | WATER},
    {N::FIX, "freeze setforce planeforce lineforce", GRAINS, N::ERROR,
     "stands before fix sph/grains in the input, whose forces then move what it holds: define it behind",
     stands_before_grains, GRAIN},
    {N::FIX, "wall/gran* gravity nve/sphere freeze", GRAINS, N::FINE, "goes with grains in the water", nullptr, GRAIN},
    {N::PAIR, "sph/heatconduction", 0, N::FINE, "changes the energy of particles alone"},
    {N::PAIR, "gran/* granular lj/* zero", 0, N::FINE,
     "acts between bodies of wall particles below hybrid or hybrid/overlay"},
    {N::FIX, "wall/*", 0, N::FINE, "goes with bodies of particles of a wall"},
};

}    // namespace StokesDyn
