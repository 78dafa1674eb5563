#include "fix_wall_adami_sph.h"

#include "keywords.h"
#include "sd_sph_wall.h"
#include "sph.h"

#include "atom.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixWallAdamiSph::FixWallAdamiSph(LAMMPS *lmp, int narg, char **arg) :
    WallFix(lmp, narg, arg), motion(6)
{
  Sph::require_scene(voice);
  Keywords in = keywords(narg, arg);
  in.parse({
      {"gravity",
       [&] {
         gravity.parse(in);
       }},
      {"slip",
       [&] {
         slip = in.yes_no();
       }},
      {"suction",
       [&] {
         suction = in.yes_no();
       }},
      {"own_acceleration",
       [&] {
         own_acceleration = in.yes_no();
       }},
  });
  if (own_acceleration) keep({&motion}, nullptr, true);
}

void FixWallAdamiSph::init()
{
  Sph::require_pair(voice);
  gravity.init(lmp);
}

const double *FixWallAdamiSph::body_force(int i, double tau)
{
  if (!own_acceleration) return gravity.now();
  const bool is_new = !motion.has(i);
  double *row = motion.give(i);
  if (is_new) std::copy_n(atom->v[i], 3, row);
  if (!update->setupflag) sd_sph_wall_acceleration(atom->v[i], update->dt, tau, row, row + 3);
  for (int d = 0; d < 3; d++) b[d] = gravity.now()[d] - row[3 + d];
  return b;
}

void FixWallAdamiSph::post_force(int /*vflag*/)
{
  for (double &f : on_wall) f = 0.0;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit)
      for (int d = 0; d < 3; d++) on_wall[d] += atom->f[i][d];
}
