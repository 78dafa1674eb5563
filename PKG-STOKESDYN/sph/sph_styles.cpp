#include "sph_styles.h"

#include "library.h"

#include "fix_check_timestep_sph.h"
#include "fix_nve_sph.h"
#include "fix_sph_density.h"
#include "fix_sph_pressure.h"
#include "fix_wall_adami_sph.h"
#include "fix_wall_sph.h"
#include "pair_sph_artvisc_tenscorr.h"

#include <cstdio>

#include <mpi.h>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static void *make_pair(LAMMPS *lmp)
{
  return static_cast<Pair *>(new PairSph(lmp));
}

template <class Style> static void *make_fix(LAMMPS *lmp, int narg, char **arg)
{
  return static_cast<Fix *>(new Style(lmp, narg, arg));
}

void StokesDyn::enroll_sph_styles(void *lmp, lammpsplugin_t plugin, lammpsplugin_regfunc enroll)
{
  if (!lammps_has_style(lmp, "atom", "sph")) {
    int me = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &me);
    if (me == 0) {
      printf("stokesdynplugin.so: this LAMMPS has no atom_style sph, so the SPH styles are not "
             "loaded; they need a LAMMPS with the "
             "SPH package\n");
      fflush(stdout);
    }
    return;
  }
  plugin.style = "pair";
  plugin.name = PairSph::STYLE;
  plugin.info = "weakly compressible SPH: pair_style sph/artVisc/tensCorr";
  plugin.creator.v1 = (lammpsplugin_factory1 *) make_pair;
  enroll(&plugin, lmp);

  const struct {
    const char *name, *info;
    void *(*creator)(LAMMPS *, int, char **);
  } fixes[] = {
      {FixSphPressure::STYLE, "SPH: equation of state", make_fix<FixSphPressure>},
      {FixSphDensityContinuity::STYLE, "SPH: density from continuity",
       make_fix<FixSphDensityContinuity>},
      {FixSphDensitySummation::STYLE, "SPH: density from summation",
       make_fix<FixSphDensitySummation>},
      {FixSphDensityCorr::STYLE, "SPH: Shepard filter of the density", make_fix<FixSphDensityCorr>},
      {FixNveSph::STYLE, "SPH: time integration", make_fix<FixNveSph>},
      {FixNveSphStationary::STYLE, "SPH: density of particles at rest",
       make_fix<FixNveSphStationary>},
      {FixWallAdamiSph::STYLE, "SPH: walls of particles", make_fix<FixWallAdamiSph>},
      {FixWallSph::STYLE, "SPH: repulsive planes and cylinder", make_fix<FixWallSph>},
      {FixWallRegionSph::STYLE, "SPH: repulsive surface of a region", make_fix<FixWallRegionSph>},
      {FixCheckTimestepSph::STYLE, "SPH: checks the time step", make_fix<FixCheckTimestepSph>},
  };
  plugin.style = "fix";
  for (const auto &fix : fixes) {
    plugin.name = fix.name;
    plugin.info = fix.info;
    plugin.creator.v2 = (lammpsplugin_factory2 *) fix.creator;
    enroll(&plugin, lmp);
  }
}
