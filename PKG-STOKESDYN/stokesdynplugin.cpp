/* Registers the styles with LAMMPS, after making sure that it is the LAMMPS this file was compiled for: class layouts differ in every
 * release, and a plugin of another release loads without complaint and then reads wrong members. Only LAMMPS's C functions are
 * used for that, since they do not depend on any layout. */
#include "lammpsplugin.h"
#include "library.h"
#include "version.h"

#include "fix_hydro_vans.h"
#include "fix_stokes_dynamics.h"
#include "fix_stokes_dynamics_state.h"
#include "pair_stokes_dynamics.h"
#include "sph_styles.h"

#include <cstdio>
#include <string>

#include <mpi.h>

using namespace LAMMPS_NS;
using namespace StokesDyn;

template <class Style> static void *make_pair(LAMMPS *lmp)
{
  return static_cast<Pair *>(new Style(lmp));
}

template <class Style> static void *make_fix(LAMMPS *lmp, int narg, char **arg)
{
  return static_cast<Fix *>(new Style(lmp, narg, arg));
}

/* Empty if the host fits, else what differs. */
static std::string mismatch(void *lmp)
{
  const int version = lammps_version(lmp);
  if (version != SD_LAMMPS_NUM)
    return "it was built for LAMMPS " SD_LAMMPS_VERSION " (" + std::to_string(SD_LAMMPS_NUM) +
        "), this is LAMMPS " + std::to_string(version);
  const struct {
    const char *name;
    int ours;
  } sizes[] = {
      {"bigint", sizeof(bigint)}, {"tagint", sizeof(tagint)}, {"imageint", sizeof(imageint)}};
  for (const auto &size : sizes) {
    const int theirs = lammps_extract_setting(lmp, size.name);
    if (theirs != size.ours)
      return "its " + std::string(size.name) + " has " + std::to_string(size.ours) +
          " bytes, that of this LAMMPS " + std::to_string(theirs) +
          " (build it with -D LAMMPS_SIZES=smallbig or bigbig, as LAMMPS was)";
  }
  if ((lammps_config_has_mpi_support() != 0) != (SD_LAMMPS_MPI != 0))
    return SD_LAMMPS_MPI ? "it was built with MPI, this LAMMPS without"
                         : "it was built without MPI, this LAMMPS with";
#if defined(LAMMPS_EXCEPTIONS)
  if (!lammps_config_has_exceptions())
    return "it was built with exceptions, this LAMMPS without (build it with -D "
           "LAMMPS_EXCEPTIONS=OFF)";
#endif
  return "";
}

extern "C" __attribute__((visibility("default"))) void lammpsplugin_init(void *lmp, void *handle,
                                                                         void *regfunc)
{
  const std::string why = mismatch(lmp);
  if (!why.empty()) {
    int me = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &me);
    if (me == 0) {
      printf("ERROR: stokesdynplugin.so is not loaded: %s. Build the plugin for this LAMMPS: cmake "
             "-S cmake -B build -D LAMMPS_SOURCE_DIR=DIR\n",
             why.c_str());
      fflush(stdout);
    }
    return;
  }

  lammpsplugin_t plugin = {};
  plugin.version = LAMMPS_VERSION;
  plugin.author = "the PKG-STOKESDYN developers";
  plugin.handle = handle;
  auto enroll = (lammpsplugin_regfunc) regfunc;

  plugin.style = "pair";
  plugin.name = PairStokesDynamics::STYLE;
  plugin.info = "Stokes drag with hydrodynamic interactions: pair_style stokes_dynamics";
  plugin.creator.v1 = (lammpsplugin_factory1 *) &make_pair<PairStokesDynamics>;
  enroll(&plugin, lmp);

  plugin.style = "fix";
  plugin.name = FixStokesDynamics::STYLE;
  plugin.info = "Stokes drag with hydrodynamic interactions: fix stokes_dynamics";
  plugin.creator.v2 = (lammpsplugin_factory2 *) &make_fix<FixStokesDynamics>;
  enroll(&plugin, lmp);

  plugin.name = FixStokesDynamicsState::STYLE;
  plugin.info = "Stokes drag with hydrodynamic interactions: memory of the pair style";
  plugin.creator.v2 = (lammpsplugin_factory2 *) &make_fix<FixStokesDynamicsState>;
  enroll(&plugin, lmp);

  plugin.name = FixHydroVans::STYLE;
  plugin.info = "One-dimensional turbulent stream over a granular bed: fix hydro/vans";
  plugin.creator.v2 = (lammpsplugin_factory2 *) &make_fix<FixHydroVans>;
  enroll(&plugin, lmp);

  enroll_sph_styles(lmp, plugin, enroll);
}
