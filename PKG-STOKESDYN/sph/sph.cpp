#include "sph.h"

#include "pair_sph_artvisc_tenscorr.h"

#include "atom.h"
#include "force.h"
#include "modify.h"
#include "update.h"

#include <cstring>

using namespace LAMMPS_NS;

namespace StokesDyn {
namespace Sph {

  void require_scene(const Voice &voice)
  {
    const LAMMPS *lmp = voice.lmp;
    if (!lmp->atom->rho_flag || !lmp->atom->vest_flag)
      voice.fail("the atom style has no density; use atom_style sph, which needs a LAMMPS with the "
                 "SPH package");
    if (lmp->force->ftm2v != 1.0)
      voice.fail(std::string("units ") + lmp->update->unit_style +
                 ": force is not mass x acceleration there, and pressure and density have units of "
                 "their own; use units lj, si, cgs, micro or nano");
  }

  PairSph *require_pair(const Voice &voice)
  {
    Pair *found = voice.lmp->force->pair ? voice.lmp->force->pair_match(PairSph::STYLE, 1)
                                         : nullptr;
    if (!found) voice.fail("there is no pair_style " + std::string(PairSph::STYLE));
    return static_cast<PairSph *>(found);
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
