#include "sph.h"

#include "keywords.h"
#include "pair_sph_artvisc_tenscorr.h"

#include "atom.h"
#include "force.h"
#include "modify.h"
#include "update.h"

#include <cstring>

using namespace LAMMPS_NS;

namespace StokesDyn {
namespace Sph {

  void require_scene(LAMMPS *lmp, const std::string &command)
  {
    if (!lmp->atom->rho_flag || !lmp->atom->vest_flag)
      fail(lmp,
           command +
               ": the atom style has no density; use atom_style sph, which needs a LAMMPS with the "
               "SPH package");
    if (lmp->force->ftm2v != 1.0)
      fail(lmp,
           command + ": units " + lmp->update->unit_style +
               ": force is not mass x acceleration there, and pressure and density have units of "
               "their own; use units lj, si, cgs, micro or nano");
  }

  PairSph *require_pair(LAMMPS *lmp, const std::string &command)
  {
    auto *pair = lmp->force->pair
        ? static_cast<PairSph *>(lmp->force->pair_match(PairSph::STYLE, 1))
        : nullptr;
    if (!pair) fail(lmp, command + ": there is no pair_style " + PairSph::STYLE);
    return pair;
  }

  std::vector<Fix *> integrators(LAMMPS *lmp)
  {
    std::vector<Fix *> found;
    for (int i = 0; i < lmp->modify->nfix; i++) {
      Fix *fix = lmp->modify->fix[i];
      if (fix->time_integrate && strcmp(fix->style, "move") != 0 && !strstr(fix->style, "rigid") &&
          !strstr(fix->style, "stationary"))
        found.push_back(fix);
    }
    return found;
  }

  int groups(const std::vector<Fix *> &fixes)
  {
    int bits = 0;
    for (const auto *fix : fixes) bits |= fix->groupbit;
    return bits;
  }

  double mass(LAMMPS *lmp, int i)
  {
    const Atom *atom = lmp->atom;
    return atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]];
  }

}    // namespace Sph
}    // namespace StokesDyn
