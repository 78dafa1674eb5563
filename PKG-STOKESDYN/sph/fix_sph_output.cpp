#include "fix_sph_output.h"

#include "sph.h"

#include "atom.h"
#include "memory.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixSphOutput::FixSphOutput(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  Sph::require_scene(lmp, "Fix " + std::string(style));
  peratom_flag = 1;
  size_peratom_cols = 0;
  peratom_freq = 1;
  create_attribute = 1;
  maxexchange = 1;
}

void FixSphOutput::begin()
{
  grow_arrays(atom->nmax);
  std::fill_n(vector_atom, atom->nlocal, 0.0);
  atom->add_callback(Atom::GROW);
}

FixSphOutput::~FixSphOutput()
{
  if (!vector_atom) return;    // the words of the command were refused
  atom->delete_callback(id, Atom::GROW);
  memory->destroy(vector_atom);
}

void FixSphOutput::init()
{
  Sph::require_pair(lmp, "Fix " + std::string(style));
}

double FixSphOutput::memory_usage()
{
  return sizeof(double) * (double) atom->nmax;
}

void FixSphOutput::grow_arrays(int nmax)
{
  memory->grow(vector_atom, nmax, "sph:output");
}

int FixSphOutput::pack_exchange(int i, double *buf)
{
  buf[0] = vector_atom[i];
  return 1;
}

int FixSphOutput::unpack_exchange(int i, double *buf)
{
  vector_atom[i] = buf[0];
  return 1;
}

void FixSphOutput::output(const double *values)
{
  std::copy_n(values, atom->nlocal, vector_atom);
}
