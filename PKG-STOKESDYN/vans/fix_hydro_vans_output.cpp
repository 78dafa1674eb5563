#include "fix_hydro_vans.h"

#include "atom.h"
#include "comm.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

/* ---- vector and array ------------------------------------------------------------------------ */

double FixHydroVans::compute_vector(int k)
{
  const auto &ledger = stream.ledger;
  const double largest = stream.largest_stress();
  if (k <= FORCE_Z || k == TOTAL_DRAG || k == OUTSIDE) sum_up();
  switch (k) {
    case FORCE_X:
    case FORCE_Y:
    case FORCE_Z: return global.force[k - FORCE_X];
    case TOTAL_DRAG: return global.drag;
    case OUTSIDE: return global.outside;
    case TRANSPORT: return sd_vans_transport(&set.mesh, stream.grain.data());
    case FRICTION_VELOCITY: return std::sqrt(std::max(largest, 0.0) / set.fluid.rho);
    case LARGEST_STRESS: return largest;
    case SHIELDS: {
      const double *g = set.law.g, size = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]),
                   scale = (mean_density - set.fluid.rho) * size * 2.0 * mean_radius;
      return scale > 0.0 ? largest / scale : 0.0;
    }
    case BED: return stream.bed_elevation();
    case MOMENTUM:
      return area() *
          sd_vans_momentum(&set.mesh, set.fluid.rho, stream.phi(), stream.U.data());
    case TRANSIT: return ledger.transit;
    case DRIVING: return ledger.driving;
    case BOTTOM: return ledger.bottom;
    case WALLS: return ledger.walls;
    case SURFACE: return ledger.surface;
    case OTHERS: return ledger.others;
  }
  return 0.0;
}

double FixHydroVans::compute_array(int n, int k)
{
  const size_t N = stream.ncell();
  switch (k) {
    case Z: return set.mesh.z_ref + 0.5 * (set.edge[n] + set.edge[n + 1]);
    case VELOCITY: return stream.U[n + 1];
    case EXCHANGE: return stream.b[n];
    case EDDY_VISCOSITY: return stream.nut[n];
    case STRESS: return stream.stress[n];
  }
  if (k < ARRAY_COLUMNS) return stream.grain[(k - PHI) * N + n];
  const size_t at = (size_t) (k - ARRAY_COLUMNS) * N + n;
  return at < stream.class_grain.size() ? stream.class_grain[at] : 0.0;
}

/* "velocity" [ncell+1], "phi", "stress" [ncell]; scalars "density", "viscosity". "ncell" is the
 * number of rows of the array. */
void *FixHydroVans::extract(const char *name, int &dim)
{
  dim = 1;
  if (strcmp(name, "velocity") == 0) return stream.U.data();
  if (strcmp(name, "phi") == 0) return stream.phi();
  if (strcmp(name, "stress") == 0) return stream.stress.data();
  dim = 0;
  if (strcmp(name, "density") == 0) return &set.fluid.rho;
  if (strcmp(name, "viscosity") == 0) return &set.fluid.eta;
  return nullptr;
}

double FixHydroVans::memory_usage()
{
  const double slices = stream.ncell(), classes = (double) stream.class_radii.size();
  return RowsFix::memory_usage() + (40.0 + SD_VANS_ROWS * classes) * slices * sizeof(double);
}

/* ---- between runs ---------------------------------------------------------------------------- */

/* fix_modify ID profile file NAME | profile values U_0 ... U_N */
int FixHydroVans::modify_param(int narg, char **arg)
{
  if (strcmp(arg[0], "profile") != 0) return 0;
  const std::string command = "fix_modify " + std::string(id);
  const Voice what(lmp, command + ": keyword profile");
  if (narg < 2) what.fail("file NAME or values U_0 ... U_N are needed");
  const int needed = stream.ncell() + 1;
  if (strcmp(arg[1], "file") == 0 && narg >= 3) {
    stream.U = read_profile(what, arg[2], stream.ncell());
    narg = 3;
  } else if (strcmp(arg[1], "values") == 0) {
    if (narg != needed + 2)
      what.fail(std::to_string(narg - 2) + " values, ncell + 1 = " + std::to_string(needed) +
                " are needed");
    Keywords in(lmp, command, words(narg, arg), 2);
    for (double &value : stream.U) value = in.positional("profile").number();
  } else
    what.fail(std::string("'") + arg[1] + "' is none of: file, values");
  stream.profile_changed();
  last_step = -1;    // the forces of the last step do not stand any more
  return narg;
}

/* ---- restart --------------------------------------------------------------------------------- */

/* What the columns of memo are. */
static std::vector<double> layout(const VansSettings &set)
{
  return {(double) set.conserve, (double) set.overlap_once, (double) set.fluctuates()};
}

void FixHydroVans::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  NamedState state(STYLE);
  state.put("columns", layout(set));
  state.put("last_step", (double) last_step);
  state.put("elapsed", elapsed);
  state.put("eddies", {eddy_age, eddy_period, renewals});
  state.put("mean", {mean_radius, mean_density});
  stream.save(state);
  state.write(fp);
}

void FixHydroVans::restart(char *buf)
{
  NamedState state(STYLE);
  if (!state.read(lmp, buf)) return;
  stream.load(state);
  last_step = (bigint) state.get("last_step", -1.0);
  elapsed = state.get("elapsed", 0.0);
  double eddies[3], mean[2];
  if (state.get("eddies", eddies, 3)) {
    eddy_age = eddies[0];
    eddy_period = eddies[1];
    renewals = eddies[2];
  }
  if (state.get("mean", mean, 2)) {
    mean_radius = mean[0];
    mean_density = mean[1];
  }
  if (state.get("columns") != layout(set))
    set.voice.warn("the restart file was written with other keywords (conserve, overlap or "
                   "fluctuation): what each grain carried is not taken, momentum on its way and "
                   "fluctuations begin anew");
}
