/* All styles of the plugin, as LAMMPS registers them. Built into stokesdynstyles.so, which
 * stokesdynloader.c opens when it has made sure that this is the LAMMPS that the styles were
 * compiled for. */
#include "comm.h"
#include "lammps.h"
#include "lammpsplugin.h"
#include "library.h"
#include "version.h"

#include "fix_check_timestep_sph.h"
#include "fix_hydro_vans.h"
#include "fix_nve_sph.h"
#include "fix_property_global.h"
#include "fix_sph_density.h"
#include "fix_sph_pressure.h"
#include "fix_sph_shift.h"
#include "fix_stokes_dynamics.h"
#include "fix_stokes_dynamics_overdamped.h"
#include "fix_stokes_dynamics_state.h"
#include "fix_wall_adami_sph.h"
#include "fix_wall_sph.h"
#include "guard.h"
#include "pair_sph_artvisc_tenscorr.h"
#include "pair_stokes_dynamics.h"

#include <cstdio>
#include <vector>

using namespace LAMMPS_NS;
using namespace StokesDyn;

template <class Style> static void *make_pair(LAMMPS *lmp)
{
  return guarded(lmp, "Pair style", Style::STYLE,
                 [=] { return static_cast<Pair *>(new GuardedPair<Style>(lmp)); });
}

template <class Style> static void *make_fix(LAMMPS *lmp, int narg, char **arg)
{
  return guarded(lmp, "Fix", Style::STYLE,
                 [=] { return static_cast<Fix *>(new GuardedFix<Style>(lmp, narg, arg)); });
}

static lammpsplugin_t entry(const char *kind, const char *name, const char *info)
{
  lammpsplugin_t plugin = {};
  plugin.version = LAMMPS_VERSION;
  plugin.author = "the PKG-STOKESDYN developers";
  plugin.style = kind;
  plugin.name = name;
  plugin.info = info;
  return plugin;
}

template <class Style> static lammpsplugin_t pair(const char *info)
{
  lammpsplugin_t plugin = entry("pair", Style::STYLE, info);
  plugin.creator.v1 = (lammpsplugin_factory1 *) &make_pair<Style>;
  return plugin;
}

template <class Style> static lammpsplugin_t fix(const char *info)
{
  lammpsplugin_t plugin = entry("fix", Style::STYLE, info);
  plugin.creator.v2 = (lammpsplugin_factory2 *) &make_fix<Style>;
  return plugin;
}

static std::vector<lammpsplugin_t> styles()
{
  return {pair<PairStokesDynamics>("Stokes drag with hydrodynamic interactions: pair_style stokes_dynamics"),
          fix<FixStokesDynamics>("Stokes drag with hydrodynamic interactions: fix stokes_dynamics"),
          fix<FixStokesDynamicsOverdamped>("Stokes dynamics without inertia: fix stokes_dynamics/overdamped"),
          fix<FixStokesDynamicsLast>("Stokes dynamics without inertia: comes last"),
          fix<FixStokesDynamicsState>("Stokes drag with hydrodynamic interactions: memory of the pair style"),
          fix<FixHydroVans>("One-dimensional turbulent stream over a granular bed: fix hydro/vans")};
}

static std::vector<lammpsplugin_t> sph_styles()
{
  return {pair<PairSph>("weakly compressible SPH: pair_style sph/artVisc/tensCorr"),
          fix<FixSphPressure>("SPH: equation of state"),
          fix<FixSphDensityContinuity>("SPH: density from continuity"),
          fix<FixSphDensitySummation>("SPH: density from summation"),
          fix<FixSphDensityCorr>("SPH: Shepard filter of the density"),
          fix<FixNveSph>("SPH: time integration"),
          fix<FixPropertyGlobal>("SPH: speed of sound and smoothing length by type"),
          fix<FixSphShift>("SPH: memory of the pair style"),
          fix<FixNveSphStationary>("SPH: density of particles at rest"),
          fix<FixWallAdamiSph>("SPH: walls of particles"),
          fix<FixWallSph>("SPH: repulsive planes and cylinder"),
          fix<FixWallRegionSph>("SPH: repulsive surface of a region"),
          fix<FixCheckTimestepSph>("SPH: checks the time step")};
}

extern "C" __attribute__((visibility("default"))) void lammpsplugin_init(void *lmp, void *handle,
                                                                         void *regfunc)
{
  LAMMPS *host = static_cast<LAMMPS *>(lmp);
  if (host->comm->me == 0)
    for (FILE *out : {host->screen, host->logfile})
      if (out) fprintf(out, "PKG-STOKESDYN " SD_VERSION ", built for LAMMPS %s\n", LAMMPS_VERSION);
  std::vector<lammpsplugin_t> all = styles();
  if (lammps_has_style(lmp, "atom", "sph")) {
    const auto sph = sph_styles();
    all.insert(all.end(), sph.begin(), sph.end());
  } else if (lammps_extract_setting(lmp, "universe_rank") == 0) {
    printf("stokesdynplugin.so: this LAMMPS has no atom_style sph, so the SPH styles are not "
           "loaded; they need a LAMMPS with the SPH package\n");
    fflush(stdout);
  }
  for (lammpsplugin_t &plugin : all) {
    plugin.handle = handle;
    ((lammpsplugin_regfunc) regfunc)(&plugin, lmp);
  }
}
