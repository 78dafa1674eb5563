#include "fix_sph_density.h"

#include "keywords.h"

using namespace LAMMPS_NS;
using namespace StokesDyn;

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
