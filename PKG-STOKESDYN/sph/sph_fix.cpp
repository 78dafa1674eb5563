#include "sph_fix.h"

#include "ranks.h"
#include "sph.h"

#include "atom.h"

using namespace LAMMPS_NS;
using namespace StokesDyn;

SphFix::SphFix(LAMMPS *lmp, int narg, char **arg) :
    RowsFix(lmp, narg, arg), voice(lmp, "Fix " + std::string(style))
{
  Sph::require_scene(voice);
}

void SphFix::init()
{
  pair = Sph::require_pair(voice);
}

Keywords SphFix::keywords(int narg, char **arg) const
{
  return Keywords(lmp, voice.command, words(narg, arg), 3);
}

void SphOutputFix::begin()
{
  maxexchange = values.most_packed();
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
  for (int i = 0; i < atom->nlocal; i++) *values.give(i) = numbers[i];
}

void BodyForce::parse(Keywords &in)
{
  for (Field &part : parts) part = Field::parse(in);
}

void BodyForce::init(const Voice &of)
{
  for (Field &part : parts) {
    part.init(of.lmp, of.command);
    if (part.is_atom_style()) of.fail("the variable must be of equal style: one for all");
  }
}

void BodyForce::find(LAMMPS *lmp)
{
  for (int d = 0; d < 3; d++) g[d] = parts[d].evaluate(lmp);
}

WallFix::WallFix(LAMMPS *lmp, int narg, char **arg) :
    RowsFix(lmp, narg, arg), voice(lmp, "Fix " + std::string(style))
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

Keywords WallFix::keywords(int narg, char **arg) const
{
  return Keywords(lmp, voice.command, words(narg, arg), 3);
}

double WallFix::compute_vector(int k)
{
  return sum_of_all(world, on_wall[k]);
}
