#include "fix_sph_friction.h"

#include "compute_sph_energy.h"
#include "fixes.h"
#include "lammps_compat.h"
#include "pair_sph_artvisc_tenscorr.h"

#include "force.h"
#include "modify.h"
#include "update.h"

using namespace LAMMPS_NS;
using namespace StokesDyn;

static const char *const FRICTION_ID = "SPH_FRICTION";

void FixSphFriction::provide(LAMMPS *lmp, bool wanted)
{
  if (Compat::fix(lmp->modify, FRICTION_ID)) lmp->modify->delete_fix(FRICTION_ID);
  if (wanted) lmp->modify->add_fix(std::string(FRICTION_ID) + " all " + STYLE);
}

int FixSphFriction::setmask()
{
  return FixConst::POST_FORCE;
}

/* The velocities of a run that begins are those of the end of a step, half a step after those that its force
 * would have started from. Energies have been measured without this force. */
void FixSphFriction::setup(int vflag)
{
  static_cast<PairSph *>(force->pair_match(PairSph::STYLE, 1))->rub_implicitly(0.5 * update->dt);
  for (auto *fix : fixes_of<FixSphEnergy>(lmp)) fix->setup(vflag);
}

void FixSphFriction::post_force(int /*vflag*/)
{
  static_cast<PairSph *>(force->pair_match(PairSph::STYLE, 1))->rub_implicitly(update->dt);
}
