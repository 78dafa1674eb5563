#include "fix_check_timestep_sph.h"

#include "keywords.h"
#include "pair_sph_artvisc_tenscorr.h"
#include "ranks.h"
#include "sd_sph_step.h"

#include "atom.h"
#include "update.h"

#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixCheckTimestepSph::FixCheckTimestepSph(LAMMPS *lmp, int narg, char **arg) :
    SphFix(lmp, narg, arg)
{
  if (narg < 5) voice.fail("the form is: check/timestep/sph N fraction [warn|stop]");
  Keywords in = keywords(narg, arg);
  nevery = in.positional("N").integer(1);
  fraction = in.positional("fraction").positive();
  stop = in.take("stop");
  if (!stop) in.take("warn");
  in.parse({});
  scalar_flag = 1;
  vector_flag = 1;
  size_vector = 2;
  global_freq = nevery;
  extscalar = 0;
  extvector = 0;
}

int FixCheckTimestepSph::setmask()
{
  return FixConst::END_OF_STEP;
}

void FixCheckTimestepSph::setup(int /*vflag*/)
{
  end_of_step();
}

void FixCheckTimestepSph::end_of_step()
{
  pair = PairSph::prepared(voice);
  pair->largest_approach(largest);
  double mine = HUGE_VAL;
  tagint who = MAXTAGINT;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const int type = atom->type[i];
    if (!pair->has_sound_speed(type))
      voice.fail_one("type " + std::to_string(type) + " has no speed of sound: pair_coeff " +
                     std::to_string(type) + " " + std::to_string(type) + " c VALUE");
    const double here = sd_sph_step_limit(pair->explicit_friction(), pair->smoothing_length(type),
                                          pair->sound_speed(type), largest[i], pair->viscosity(i), atom->rho[i]);
    if (here < mine || (here == mine && atom->tag[i] < who)) {
      mine = here;
      who = atom->tag[i];
    }
  }
  limit = smallest_of_all(world, mine);
  const tagint first = smallest_of_all(world, mine == limit ? who : MAXTAGINT);
  if (!std::isfinite(limit)) {    // nobody in the group
    limit = worst = ratio = 0.0;
    return;
  }
  worst = (double) first;
  ratio = update->dt / limit;
  if (ratio <= fraction) return;
  const std::string message = "the time step " + text(update->dt) + " is " + text(ratio) +
      " of the limit " + text(limit) + " of atom " + std::to_string(first) + ", more than " +
      text(fraction);
  if (stop) voice.at_step().fail(message);
  voice.at_step().warn(message);
}
