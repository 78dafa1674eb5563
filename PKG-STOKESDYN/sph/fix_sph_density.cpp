#include "fix_sph_density.h"

#include "keywords.h"
#include "sph.h"

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixSphDensityContinuity::FixSphDensityContinuity(LAMMPS *lmp, int narg, char **arg) :
    FixSphOutput(lmp, narg, arg)
{
  Keywords in(lmp, "Fix " + std::string(STYLE), words(narg, arg), 3);
  in.parse({{"delta", [&] { delta = in.not_negative(); }}});
  begin();
}

FixSphDensitySummation::FixSphDensitySummation(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg)
{
  const std::string command = "Fix " + std::string(STYLE);
  Sph::require_scene(lmp, command);
  if (narg > 3) fail(lmp, command + ": unknown keyword '" + arg[3] + "'");
}

void FixSphDensitySummation::init()
{
  Sph::require_pair(lmp, "Fix " + std::string(STYLE));
}

FixSphDensityCorr::FixSphDensityCorr(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  const std::string command = "Fix " + std::string(STYLE);
  Sph::require_scene(lmp, command);
  Keywords in(lmp, command, words(narg, arg), 3);
  if (!in.next() || !in.is("shepard"))
    fail(lmp, command + ": the form is: sph/density/corr shepard every N");
  if (!in.next() || !in.is("every"))
    fail(lmp, command + ": keyword every is missing: shepard every N");
  every = in.integer(1);
  in.parse({});
}

void FixSphDensityCorr::init()
{
  Sph::require_pair(lmp, "Fix " + std::string(STYLE));
}
