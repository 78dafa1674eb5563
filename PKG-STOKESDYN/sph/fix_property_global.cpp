#include "fix_property_global.h"

#include "keywords.h"

#include "atom.h"

using namespace LAMMPS_NS;
using namespace StokesDyn;

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
