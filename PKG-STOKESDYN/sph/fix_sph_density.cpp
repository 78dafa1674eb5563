#include "fix_sph_density.h"

#include "keywords.h"

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixSphDensityContinuity::FixSphDensityContinuity(LAMMPS *lmp, int narg, char **arg) :
    SphOutputFix(lmp, narg, arg)
{
  Keywords in(lmp, command, words(narg, arg), 3);
  in.parse({
      {"delta", [&] { delta = in.not_negative(); }},
      {"volume", [&] { volume = in.yes_no(); }},
  });
  begin();
}

FixSphDensitySummation::FixSphDensitySummation(LAMMPS *lmp, int narg, char **arg) :
    SphFix(lmp, narg, arg)
{
  Keywords(lmp, command, words(narg, arg), 3).parse({});
}

FixSphDensityCorr::FixSphDensityCorr(LAMMPS *lmp, int narg, char **arg) : SphFix(lmp, narg, arg)
{
  Keywords in(lmp, command, words(narg, arg), 3);
  if (!in.next() || !in.is("shepard"))
    fail(lmp, command + ": the form is: sph/density/corr shepard every N");
  if (!in.next() || !in.is("every"))
    fail(lmp, command + ": keyword every is missing: shepard every N");
  every = in.integer(1);
  in.parse({});
}
