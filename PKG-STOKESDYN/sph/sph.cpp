#include "sph.h"

#include "ranks.h"

#include "atom.h"
#include "force.h"
#include "update.h"

#include <algorithm>

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

  Pair *require_pair(const Voice &voice)
  {
    Pair *found = voice.lmp->force->pair ? voice.lmp->force->pair_match(PAIR_STYLE, 1) : nullptr;
    if (!found) voice.fail("there is no pair_style " + std::string(PAIR_STYLE));
    return found;
  }

  double mass(LAMMPS *lmp, int i)
  {
    const Atom *atom = lmp->atom;
    return atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]];
  }

}    // namespace Sph

// --- fixes ---------------------------------------------------------------------------------------

SphFix::SphFix(LAMMPS *lmp, int narg, char **arg) : GhostRows(lmp, narg, arg)
{
  Sph::require_scene(voice);
}

void SphFix::init()
{
  Sph::require_pair(voice);
}

void SphOutputFix::begin()
{
  keep({&values}, nullptr, false);
  peratom_flag = 1;
  size_peratom_cols = 0;
  peratom_freq = 1;
}

void SphOutputFix::grow_arrays(int nmax)
{
  RowsFix::grow_arrays(nmax);
  vector_atom = values.array()[0];
}

void SphOutputFix::output(const double *numbers)
{
  for (int i = 0; i < atom->nlocal; i++) *values.writable(i) = numbers[i];
}

void BodyForce::parse(Keywords &in)
{
  for (Field &part : parts) part = Field::parse(in, Field::ONE_FOR_ALL);
}

void BodyForce::init(LAMMPS *lmp)
{
  for (Field &part : parts) part.init(lmp);
}

void BodyForce::find(LAMMPS *lmp)
{
  for (int d = 0; d < 3; d++) g[d] = parts[d].evaluate(lmp);
}

bool BodyForce::varies() const
{
  return std::any_of(parts, parts + 3, [](const Field &part) { return part.is_variable(); });
}

WallFix::WallFix(LAMMPS *lmp, int narg, char **arg) : RowsFix(lmp, narg, arg)
{
  dynamic_group_allow = 1;
  vector_flag = 1;
  size_vector = 3;
  global_freq = 1;
  extvector = 1;
}

int WallFix::setmask()
{
  return FixConst::POST_FORCE;
}

double WallFix::compute_vector(int k)
{
  return sum_of_all(world, on_wall[k]);
}

}    // namespace StokesDyn
