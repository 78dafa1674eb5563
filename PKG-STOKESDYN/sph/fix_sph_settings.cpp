#include "fix_sph_settings.h"

#include "atom.h"

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixSphPressure::FixSphPressure(LAMMPS *lmp, int narg, char **arg) :
    SphOutputFix(lmp, narg, arg)
{
  Keywords in = keywords(narg, arg);
  if (!in.next()) voice.fail("the equation of state is missing: absolut, relativ or Tait");
  if (in.is("absolut")) {
    state.kind = SD_SPH_ABSOLUT;
    state.B = in.value("B").positive();
  } else if (in.is("relativ") || in.is("Tait")) {
    state.kind = in.is("Tait") ? SD_SPH_TAIT : SD_SPH_RELATIV;
    state.B = in.value("B").positive();
    state.rho0 = in.value("rho0").positive();
    if (state.kind == SD_SPH_TAIT) state.gamma = in.value("gamma").positive();
    if (in.more() && in.peek() != "tension") state.P0 = in.number();
  } else
    in.unknown({"absolut", "relativ", "Tait"});
  in.parse({{"tension", [&] { state.no_tension = !in.yes_no(); }}});
  if (state.no_tension && state.kind == SD_SPH_ABSOLUT)
    voice.fail("keyword tension: absolut has no negative pressure; leave it out");
  begin();
}

void FixSphPressure::set_arrays(int i)
{
  SphOutputFix::set_arrays(i);
  if ((atom->mask[i] & groupbit) && atom->rho[i] == 0.0) atom->rho[i] = state.rho0;
}

FixSphDensityContinuity::FixSphDensityContinuity(LAMMPS *lmp, int narg, char **arg) :
    SphOutputFix(lmp, narg, arg)
{
  Keywords in = keywords(narg, arg);
  in.parse({
      {"delta", [&] { delta = in.not_negative(); }},
      {"volume", [&] { volume = in.yes_no(); }},
  });
  begin();
}

FixSphDensitySummation::FixSphDensitySummation(LAMMPS *lmp, int narg, char **arg) :
    SphFix(lmp, narg, arg)
{
  keywords(narg, arg).parse({});
}

FixSphDensityCorr::FixSphDensityCorr(LAMMPS *lmp, int narg, char **arg) : SphFix(lmp, narg, arg)
{
  Keywords in = keywords(narg, arg);
  if (!in.next() || !in.is("shepard")) voice.fail("the form is: sph/density/corr shepard every N");
  if (!in.next() || !in.is("every")) voice.fail("keyword every is missing: shepard every N");
  every = in.integer(1);
  in.parse({});
}

FixPropertyGlobal::FixPropertyGlobal(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  Keywords in(lmp, "Fix property/global", words(narg, arg), 3);
  const size_t which = in.positional("property").choice({"speedOfSound", "sl"});
  property = which == 0 ? "speedOfSound" : "sl";
  in.positional("kind").choice({"peratomtype"});
  in.positional(property);
  for (int type = 1; type <= atom->ntypes; type++) of_type.push_back(in.positive());
  in.parse({});
}
