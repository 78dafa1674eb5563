#include "fix_hydro_vans.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "memory.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static const std::string COMMAND = VansSettings::COMMAND;

/* ---- output --------------------------------------------------------------------------------- */

void FixHydroVans::sum_up()
{
  if (summed_step == update->ntimestep) return;
  MPI_Allreduce(local, global, 5, MPI_DOUBLE, MPI_SUM, world);
  summed_step = update->ntimestep;
}

double FixHydroVans::compute_vector(int k)
{
  const auto &ledger = stream->ledger;
  const auto of_grains = [this](int i) {
    sum_up();
    return global[i];
  };
  switch (k) {
    case FORCE_X:
    case FORCE_Y:
    case FORCE_Z: return of_grains(k - FORCE_X);
    case TOTAL_DRAG: return of_grains(3);
    case OUTSIDE: return of_grains(4);
    case TRANSPORT: return stream->transport();
    case FRICTION_VELOCITY:
      return std::sqrt(std::max(stream->largest_stress(), 0.0) / set.rho);
    case LARGEST_STRESS: return stream->largest_stress();
    case SHIELDS: {
      const double g = std::sqrt(set.g[0] * set.g[0] + set.g[1] * set.g[1] + set.g[2] * set.g[2]),
                   scale = (mean_density - set.rho) * g * 2.0 * mean_radius;
      return scale > 0.0 ? stream->largest_stress() / scale : 0.0;
    }
    case BED: return stream->bed_elevation();
    case MOMENTUM: return stream->momentum(area());
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
  const size_t N = stream->ncell();
  switch (k) {
    case Z: return set.z_ref + 0.5 * (stream->mesh.edge[n] + stream->mesh.edge[n + 1]);
    case VELOCITY: return stream->U[n + 1];
    case EXCHANGE: return stream->b[n];
    case EDDY_VISCOSITY: return stream->nut[n];
    case STRESS: return stream->stress[n];
  }
  if (k < ARRAY_COLUMNS) return stream->grain[(k - PHI) * N + n];
  const size_t at = (size_t) (k - ARRAY_COLUMNS) * N + n;
  return at < stream->class_grain.size() ? stream->class_grain[at] : 0.0;
}

/* fix_modify ID profile file NAME | profile values U_0 ... U_N */
int FixHydroVans::modify_param(int narg, char **arg)
{
  if (strcmp(arg[0], "profile") != 0) return 0;
  const std::string what = "fix_modify " + std::string(id) + ": keyword profile";
  if (narg < 2) fail(lmp, what + ": file NAME or values U_0 ... U_N are needed");
  const int needed = stream->ncell() + 1;
  if (strcmp(arg[1], "file") == 0 && narg >= 3) {
    stream->U = read_profile(lmp, what, arg[2], stream->ncell());
    narg = 3;
  } else if (strcmp(arg[1], "values") == 0) {
    if (narg != needed + 2)
      fail(lmp,
           what + ": " + std::to_string(narg - 2) +
               " values, ncell + 1 = " + std::to_string(needed) + " are needed");
    Keywords in(lmp, "fix_modify " + std::string(id), words(narg, arg), 1);
    in.next();
    for (double &value : stream->U) value = in.number();
  } else
    fail(lmp, what + ": '" + arg[1] + "' is none of: file, values");
  stream->profile_changed();
  last_step = -1;    // the forces of the last step do not stand any more
  return narg;
}

/* "velocity" [ncell+1], "phi", "stress" [ncell]; scalars "density", "viscosity", "ncell" is the
 * number of rows of the array. */
void *FixHydroVans::extract(const char *name, int &dim)
{
  dim = 1;
  if (strcmp(name, "velocity") == 0) return stream->U.data();
  if (strcmp(name, "phi") == 0) return stream->phi();
  if (strcmp(name, "stress") == 0) return stream->stress.data();
  dim = 0;
  if (strcmp(name, "density") == 0) return &set.rho;
  if (strcmp(name, "viscosity") == 0) return &set.eta;
  return nullptr;
}

double FixHydroVans::memory_usage()
{
  return (double) atom->nmax * (OUTPUTS + columns) * sizeof(double) +
      (double) (40 + SD_VANS_ROWS * stream->class_radii.size()) * stream->ncell() * sizeof(double);
}

/* ---- what follows the atoms ------------------------------------------------------------------ */

void FixHydroVans::grow_arrays(int nmax)
{
  memory->grow(array_atom, nmax, OUTPUTS, "hydro/vans:array_atom");
  memory->grow(memo, nmax, columns, "hydro/vans:memo");
}

void FixHydroVans::copy_arrays(int i, int j, int /*delflag*/)
{
  memcpy(array_atom[j], array_atom[i], OUTPUTS * sizeof(double));
  memcpy(memo[j], memo[i], columns * sizeof(double));
}

void FixHydroVans::set_arrays(int i)
{
  memset(array_atom[i], 0, OUTPUTS * sizeof(double));
  memset(memo[i], 0, columns * sizeof(double));
  if (weight_column >= 0) memo[i][weight_column] = 1.0;
}

int FixHydroVans::pack_exchange(int i, double *buf)
{
  memcpy(buf, array_atom[i], OUTPUTS * sizeof(double));
  memcpy(buf + OUTPUTS, memo[i], columns * sizeof(double));
  return OUTPUTS + columns;
}

int FixHydroVans::unpack_exchange(int nlocal, double *buf)
{
  memcpy(array_atom[nlocal], buf, OUTPUTS * sizeof(double));
  memcpy(memo[nlocal], buf + OUTPUTS, columns * sizeof(double));
  return OUTPUTS + columns;
}

int FixHydroVans::pack_restart(int i, double *buf)
{
  resume.record(i, memo[i] + LEFT);
  buf[0] = OUTPUTS + columns + 1;
  pack_exchange(i, buf + 1);
  return OUTPUTS + columns + 1;
}

void FixHydroVans::unpack_restart(int nlocal, int nth)
{
  double *extra = atom->extra[nlocal];
  int m = 0;
  for (int i = 0; i < nth; i++) m += static_cast<int>(extra[m]);
  if (static_cast<int>(extra[m]) == OUTPUTS + columns + 1)
    unpack_exchange(nlocal, extra + m + 1);
  else
    set_arrays(nlocal);    // other columns: restart() has said so
}

/* What the columns of memo are. */
static std::vector<double> layout(const VansSettings &set)
{
  return {(double) set.conserve, (double) set.overlap_once,
          (double) (set.fluctuation != VansSettings::NO_FLUCTUATION)};
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
  stream->save(state);
  state.write(fp);
}

void FixHydroVans::restart(char *buf)
{
  NamedState state(STYLE);
  if (!state.read(lmp, buf)) return;
  stream->load(state);
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
  if (state.get("columns") != layout(set) && comm->me == 0)
    error->warning(FLERR,
                   COMMAND + ": the restart file was written with other keywords (conserve, "
                             "overlap or fluctuation): what each grain carried is not taken, "
                             "momentum on its way and fluctuations begin anew");
}
