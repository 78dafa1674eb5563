#include "fix_wall_adami_sph.h"

#include "keywords.h"
#include "sph.h"

#include "atom.h"

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixWallAdamiSph::FixWallAdamiSph(LAMMPS *lmp, int narg, char **arg) : WallFix(lmp, narg, arg)
{
  Sph::require_scene(lmp, command);
  Keywords in(lmp, command, words(narg, arg), 3);
  in.parse({
      {"gravity", [&] { for (Field &g : gravity) g = Field::parse(in); }},
      {"slip", [&] { slip = in.yes_no(); }},
  });
}

void FixWallAdamiSph::init()
{
  Sph::require_pair(lmp, command);
  for (Field &g : gravity) {
    g.init(lmp, command + ": keyword gravity");
    if (g.is_atom_style())
      fail(lmp, command + ": keyword gravity: the variable must be of equal style: one for all");
  }
}

const double *FixWallAdamiSph::body_force()
{
  for (int d = 0; d < 3; d++) b[d] = gravity[d].evaluate(lmp);
  return b;
}

void FixWallAdamiSph::post_force(int /*vflag*/)
{
  for (double &f : on_wall) f = 0.0;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit)
      for (int d = 0; d < 3; d++) on_wall[d] += atom->f[i][d];
}
