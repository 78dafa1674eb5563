#include "compute_sph_energy.h"

#include "fix_sph_energy.h"
#include "lammps_compat.h"
#include "sph.h"

#include "group.h"
#include "modify.h"
#include "update.h"

#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

ComputeSphEnergy::ComputeSphEnergy(LAMMPS *lmp, int narg, char **arg) :
    Compute(lmp, narg, arg), voice(lmp, "Compute sph/energy"),
    memory_id(std::string(id) + "_SPH_ENERGY")
{
  Keywords(lmp, voice.command, words(narg, arg), 3).parse({});
  if (Compat::fix(modify, memory_id))
    voice.fail("the fix ID " + memory_id + " is taken; give that fix another ID");
  modify->add_fix(memory_id + " " + group->names[igroup] + " " + FixSphEnergy::STYLE);
  scalar_flag = vector_flag = 1;
  extscalar = extvector = 1;
  size_vector = FixSphEnergy::VALUES;
  vector = new double[FixSphEnergy::VALUES]();
}

ComputeSphEnergy::~ComputeSphEnergy()
{
  if (modify->nfix && Compat::fix(modify, memory_id)) modify->delete_fix(memory_id);
  delete[] vector;
}

void ComputeSphEnergy::init()
{
  Sph::require_pair(voice);
}

void ComputeSphEnergy::compute_vector()
{
  invoked_vector = update->ntimestep;
  Fix *fix = Compat::fix(modify, memory_id);
  if (!fix) voice.fail("the fix " + memory_id + " has been deleted, but this compute needs it");
  static_cast<FixSphEnergy *>(fix)->values(vector);
}

double ComputeSphEnergy::compute_scalar()
{
  compute_vector();
  invoked_scalar = update->ntimestep;
  scalar = vector[FixSphEnergy::KINETIC] + vector[FixSphEnergy::POTENTIAL] +
      vector[FixSphEnergy::ELASTIC];
  return scalar;
}
