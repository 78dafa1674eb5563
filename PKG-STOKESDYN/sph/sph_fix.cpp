#include "sph_fix.h"

#include "sph.h"

#include "atom.h"

using namespace LAMMPS_NS;
using namespace StokesDyn;

SphFix::SphFix(LAMMPS *lmp, int narg, char **arg) :
    RowsFix(lmp, narg, arg), command("Fix " + std::string(style))
{
  Sph::require_scene(lmp, command);
}

void SphFix::init()
{
  pair = Sph::require_pair(lmp, command);
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

WallFix::WallFix(LAMMPS *lmp, int narg, char **arg) :
    RowsFix(lmp, narg, arg), command("Fix " + std::string(style))
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
  double all;
  MPI_Allreduce(&on_wall[k], &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}
