#include "fix_sph_friction.h"

#include "compute_sph_energy.h"
#include "fixes.h"

#include "update.h"

using namespace LAMMPS_NS;
using namespace StokesDyn;

int FixSphFriction::setmask()
{
  return FixConst::POST_FORCE;
}

/* The velocities of a run that begins are those of the end of a step, half a step after those that its force
 * would have started from. Energies have been measured without this force. */
void FixSphFriction::setup(int vflag)
{
  PairSph::of(voice)->rub_implicitly(0.5 * update->dt);
  for (auto *fix : fixes_of<FixSphEnergy>(lmp)) fix->setup(vflag);
}

void FixSphFriction::post_force(int /*vflag*/)
{
  PairSph::of(voice)->rub_implicitly(update->dt);
}
