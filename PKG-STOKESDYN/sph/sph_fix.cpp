#include "sph_fix.h"

#include "sph.h"

#include "atom.h"
#include "memory.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace StokesDyn;

SphFix::SphFix(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), command("Fix " + std::string(style))
{
  Sph::require_scene(lmp, command);
}

void SphFix::init()
{
  pair = Sph::require_pair(lmp, command);
}

SphOutputFix::SphOutputFix(LAMMPS *lmp, int narg, char **arg) : SphFix(lmp, narg, arg)
{
  peratom_flag = 1;
  size_peratom_cols = 0;
  peratom_freq = 1;
  create_attribute = 1;
  maxexchange = 1;
}

void SphOutputFix::begin()
{
  grow_arrays(atom->nmax);
  std::fill_n(vector_atom, atom->nlocal, 0.0);
  atom->add_callback(Atom::GROW);
}

SphOutputFix::~SphOutputFix()
{
  if (!vector_atom) return;    // the words of the command were refused
  atom->delete_callback(id, Atom::GROW);
  memory->destroy(vector_atom);
}

double SphOutputFix::memory_usage()
{
  return sizeof(double) * (double) atom->nmax;
}

void SphOutputFix::grow_arrays(int nmax)
{
  memory->grow(vector_atom, nmax, "sph:output");
}

int SphOutputFix::pack_exchange(int i, double *buf)
{
  buf[0] = vector_atom[i];
  return 1;
}

int SphOutputFix::unpack_exchange(int i, double *buf)
{
  vector_atom[i] = buf[0];
  return 1;
}

void SphOutputFix::output(const double *values)
{
  std::copy_n(values, atom->nlocal, vector_atom);
}
