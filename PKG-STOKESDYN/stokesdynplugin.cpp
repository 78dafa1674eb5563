/* All styles of the plugin, as LAMMPS registers them. Built into stokesdynstyles.so, which
 * stokesdynloader.c opens when it has made sure that this is the LAMMPS that the styles were
 * compiled for. */
#include "comm.h"
#include "force.h"
#include "lammps.h"
#include "library.h"
#include "modify.h"

#include "compute_sph_energy.h"
#include "compute_sph_probe.h"
#include "compute_stokes_dynamics_stress.h"
#include "fix_check_timestep_sph.h"
#include "fix_hydro_vans.h"
#include "fix_nve_sph.h"
#include "fix_sph_friction.h"
#include "fix_sph_grains.h"
#include "fix_sph_inlet.h"
#include "fix_sph_outlet.h"
#include "fix_sph_settings.h"
#include "fix_sph_shift.h"
#include "fix_sph_tension.h"
#include "fix_stokes_dynamics.h"
#include "fix_stokes_dynamics_field.h"
#include "fix_stokes_dynamics_overdamped.h"
#include "fix_stokes_dynamics_state.h"
#include "fix_wall_sph.h"
#include "guard.h"
#include "lammps_plugin_interface.h"
#include "pair_sph_artvisc_tenscorr.h"
#include "pair_stokes_dynamics.h"

#include <mpi.h>

#include <cstdio>
#include <cstdlib>
#include <string>
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

template <class Style> static void *make_compute(LAMMPS *lmp, int narg, char **arg)
{
  return guarded(lmp, "Compute", Style::STYLE,
                 [=] { return static_cast<Compute *>(new GuardedCompute<Style>(lmp, narg, arg)); });
}

static PluginStyle entry(const char *kind, const char *name, const char *info)
{
  PluginStyle plugin = {};
  plugin.version = SD_LAMMPS_VERSION;
  plugin.author = "the PKG-STOKESDYN developers";
  plugin.style = kind;
  plugin.name = name;
  plugin.info = info;
  return plugin;
}

template <class Style> static PluginStyle pair(const char *info)
{
  PluginStyle plugin = entry("pair", Style::STYLE, info);
  plugin.creator.of_pair = &make_pair<Style>;
  return plugin;
}

template <class Style> static PluginStyle fix(const char *info)
{
  PluginStyle plugin = entry("fix", Style::STYLE, info);
  plugin.creator.of_command = &make_fix<Style>;
  return plugin;
}

template <class Style> static PluginStyle compute(const char *info)
{
  PluginStyle plugin = entry("compute", Style::STYLE, info);
  plugin.creator.of_command = &make_compute<Style>;
  return plugin;
}

static std::vector<PluginStyle> styles()
{
  return {pair<PairStokesDynamics>("Stokes drag with hydrodynamic interactions"),
          fix<FixStokesDynamics>("applies or reports the force of pair_style stokes_dynamics"),
          fix<FixStokesDynamicsField>("writes the flow around spheres for ParaView"),
          fix<FixStokesDynamicsOverdamped>("Stokes dynamics without inertia"),
          fix<FixStokesDynamicsLast>("internal: end of a step without inertia"),
          fix<FixStokesDynamicsState>("internal: memory of pair_style stokes_dynamics"),
          compute<ComputeStokesDynamicsStress>("stress of a suspension of shells of points"),
          fix<FixHydroVans>("one-dimensional turbulent stream over a granular bed")};
}

static std::vector<PluginStyle> sph_styles()
{
  return {pair<PairSph>("weakly compressible SPH"),
          fix<FixSphPressure>("SPH: equation of state"),
          fix<FixSphDensityContinuity>("SPH: density from continuity"),
          fix<FixSphDensitySummation>("SPH: density from summation"),
          fix<FixSphDensityCorr>("SPH: Shepard filter of the density"),
          fix<FixNveSph>("SPH: time integration"),
          fix<FixPropertyGlobal>("SPH: speed of sound and smoothing length by type"),
          fix<FixSphShift>("internal: memory of the SPH pair style"),
          fix<FixSphFriction>("internal: implicit friction of the SPH pair style"),
          fix<FixSphEnergy>("internal: memory of compute sph/energy"),
          compute<ComputeSphEnergy>("SPH: kinetic, potential, elastic and dissipated energy"),
          compute<ComputeSphProbe>("SPH: pressure at points, height of the free surface"),
          compute<ComputeSphSurface>("SPH: free surface"),
          fix<FixNveSphStationary>("SPH: density of particles at rest"),
          fix<FixWallAdamiSph>("SPH: walls of particles"),
          fix<FixSphGrains>("SPH: grains smaller than h in the water"),
          fix<FixSphTension>("SPH: surface tension and contact angle"),
          fix<FixSphInlet>("SPH: a layer of particles that flows in"),
          fix<FixSphOutlet>("SPH: a layer that takes particles out"),
          fix<FixWallSph>("SPH: repulsive planes and cylinder"),
          fix<FixWallRegionSph>("SPH: repulsive surface of a region"),
          fix<FixCheckTimestepSph>("SPH: checks the time step")};
}

/* LAMMPS prints a line for each style that it takes in. One line for all of them says more: while
 * this lives, only our own lines come out. */
class OneLine {
  LAMMPS *lammps;
  FILE *screen, *logfile;

 public:
  explicit OneLine(LAMMPS *host) : lammps(host), screen(host->screen), logfile(host->logfile)
  {
    lammps->screen = lammps->logfile = nullptr;
  }
  ~OneLine()
  {
    lammps->screen = screen;
    lammps->logfile = logfile;
  }
  void print(const std::string &line) const
  {
    if (lammps->comm->me == 0)
      for (FILE *out : {screen, logfile})
        if (out) fputs((line + "\n").c_str(), out);
  }
};

/* Calls use(table, creator) for the table where this LAMMPS looks up styles of this kind, with our own
 * creator in the type of that table. */
template <class Use> static bool in_table(LAMMPS *lmp, const PluginStyle &plugin, const Use &use)
{
  const std::string kind = plugin.style;
  if (kind == "pair") return use(*lmp->force->pair_map, (Force::PairCreator) plugin.creator.of_pair);
  if (kind == "fix") return use(*lmp->modify->fix_map, (Modify::FixCreator) plugin.creator.of_command);
  return use(*lmp->modify->compute_map, (Modify::ComputeCreator) plugin.creator.of_command);
}

/* Is this the style that this LAMMPS makes? */
static bool has(LAMMPS *lmp, const PluginStyle &plugin)
{
  return in_table(lmp, plugin, [&](const auto &table, auto ours) {
    const auto found = table.find(plugin.name);
    return found != table.end() && found->second == ours;
  });
}

/* Is a style of this name on the list of plugins, which all LAMMPS of a process share? */
static bool listed(const PluginStyle &wanted)
{
  char kind[64] = "", name[64] = "";
  for (int k = 0; k < lammps_plugin_count(); k++)
    if (lammps_plugin_name(k, kind, name, sizeof(name) - 1) &&
        kind == std::string(wanted.style) && name == std::string(wanted.name))
      return true;
  return false;
}

/* LAMMPS takes no style in that is on the list, although it is another LAMMPS that has it: it then gets
 * ours here, in its own table. The creators stay: stokesdynstyles.so is never closed. */
static void give(LAMMPS *lmp, PluginStyle plugin, void *handle, PluginRegister *take_in)
{
  if (listed(plugin)) {
    in_table(lmp, plugin, [&](auto &table, auto ours) { return (table[plugin.name] = ours) != nullptr; });
    return;
  }
  plugin.handle = handle;
  take_in(&plugin, lmp);
}

/* Where an mpirun of another MPI has started this process, each process is alone in its own world: all
 * would be rank 0 and write the same files. The reason and the way out; empty: all is well. */
static std::string started_by_another_mpi()
{
  int size;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  for (const char *variable : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    const char *count = getenv(variable);
    if (size > 1 || !count || atoi(count) < 2) continue;
    return std::string("mpirun has started ") + count + " processes (" + variable +
        "), and each of them is alone: this LAMMPS has another MPI, or none. Use the mpirun that belongs "
        "to this LAMMPS ('. build/env.sh' finds it); if each is to run for itself, unset " + variable;
  }
  return "";
}

/* The first of those processes speaks for all. */
static void refuse(const std::string &why)
{
  for (const char *variable : {"OMPI_COMM_WORLD_RANK", "PMI_RANK"})
    if (const char *rank = getenv(variable); rank && atoi(rank) > 0) return;
  printf("ERROR: stokesdynplugin.so is not loaded: %s\n", why.c_str());
  fflush(stdout);
}

extern "C" __attribute__((visibility("default"))) void lammpsplugin_init(void *host, void *handle,
                                                                         void *regfunc)
{
  LAMMPS *lmp = static_cast<LAMMPS *>(host);
  const std::string other_mpi = started_by_another_mpi();
  if (!other_mpi.empty()) return refuse(other_mpi);
  const OneLine out(lmp);
  const bool sph = lammps_has_style(lmp, "atom", "sph");
  std::vector<PluginStyle> all = styles();
  if (sph) {
    const auto more = sph_styles();
    all.insert(all.end(), more.begin(), more.end());
  }
  bool complete = true;
  for (const PluginStyle &plugin : all) {
    if (has(lmp, plugin)) continue;
    complete = false;
    if (lammps_has_style(lmp, plugin.style, plugin.name))
      out.print(std::string("WARNING: the plugin takes the place of ") + plugin.style + " style " +
                plugin.name + " of LAMMPS");
    give(lmp, plugin, handle, (PluginRegister *) regfunc);
  }
  const std::string version = "PKG-STOKESDYN " SD_VERSION;
  if (complete) {
    out.print(version + " is loaded already");
    return;
  }
  out.print(version + ", built for LAMMPS " SD_LAMMPS_VERSION ": stokes_dynamics, hydro/vans" +
            (sph ? ", sph" : ""));
  if (!sph)
    out.print("stokesdynplugin.so: this LAMMPS has no atom_style sph, so the SPH styles are not "
              "loaded; they need a LAMMPS with the SPH package");
}
