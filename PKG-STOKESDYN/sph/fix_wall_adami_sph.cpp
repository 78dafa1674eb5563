#include "fix_wall_adami_sph.h"

#include "keywords.h"

#include "atom.h"

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixWallAdamiSph::FixWallAdamiSph(LAMMPS *lmp, int narg, char **arg) : SphFix(lmp, narg, arg)
{
  Keywords in(lmp, command, words(narg, arg), 3);
  in.parse({
      {"gravity", [&] { for (Field &g : gravity) g = Field::parse(in); }},
      {"slip", [&] { slip = in.yes_no(); }},
  });
  dynamic_group_allow = 1;
  vector_flag = 1;
  size_vector = 3;
  global_freq = 1;
  extvector = 1;
}

int FixWallAdamiSph::setmask()
{
  return FixConst::POST_FORCE;
}

void FixWallAdamiSph::init()
{
  SphFix::init();
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

void FixWallAdamiSph::setup(int vflag)
{
  post_force(vflag);
}

/* The force of the fluid on the wall. */
void FixWallAdamiSph::post_force(int /*vflag*/)
{
  for (double &t : total) t = 0.0;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit)
      for (int d = 0; d < 3; d++) total[d] += atom->f[i][d];
}

double FixWallAdamiSph::compute_vector(int k)
{
  double all;
  MPI_Allreduce(&total[k], &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}
