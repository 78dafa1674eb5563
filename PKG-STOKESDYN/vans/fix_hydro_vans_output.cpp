#include "fix_hydro_vans.h"

#include "vans_files.h"

#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

/* ---- vector and array ------------------------------------------------------------------------ */

double FixHydroVans::compute_vector(int k)
{
  const auto &ledger = stream.ledger;
  const double largest = stream.largest_stress();
  if (k >= VECTOR_SIZE) return of_class((k - VECTOR_SIZE) / CLASS_NUMBERS, (k - VECTOR_SIZE) % CLASS_NUMBERS);
  if (k <= FORCE_Z || k == TOTAL_DRAG || k == OUTSIDE || k == PRESSED) sum_up();
  switch (k) {
    case FORCE_X:
    case FORCE_Y:
    case FORCE_Z: return global.force[k - FORCE_X];
    case TOTAL_DRAG: return global.drag;
    case OUTSIDE: return global.outside;
    case PRESSED: return global.pressed;
    case TRANSPORT: return stream.transport();
    case FRICTION_VELOCITY: return std::sqrt(std::fabs(largest) / set.fluid.rho);
    case LARGEST_STRESS: return largest;
    case SHIELDS: {
      const double *g = set.law.g, size = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]),
                   scale = (mean.density - set.fluid.rho) * size * 2.0 * mean.radius;
      return scale > 0.0 ? largest / scale : 0.0;
    }
    case BED: return fluctuations.bed_elevation();
    case MOMENTUM:
      return area() *
          sd_vans_momentum(&stream.wet, set.fluid.rho, stream.phi(), stream.U.data());
    case TRANSIT: return ledger.transit;
    case DRIVING: return ledger.driving;
    case BOTTOM: return ledger.bottom;
    case WALLS: return ledger.walls;
    case SURFACE: return ledger.surface;
    case OTHERS: return ledger.others;
    case DISCHARGE:
      return sd_vans_momentum(&stream.wet, 1.0, stream.phi(), stream.U.data());
    case DRIVE: return stream.drive;
    case ELEVATION: return stream.surface();
    case VOLUME: return sd_vans_volume(&stream.wet, stream.phi());
    case WALL_SHARE:
      return sd_vans_wall_share(&stream.wet, &stream.fluid, stream.phi(), stream.U.data(),
                                stream.drive);
    case MEAN_TRANSPORT:
    case TRANSPORT_ERROR:
    case MEAN_STRESS:
    case STRESS_ERROR: return steady(k);
  }
  return 0.0;
}

double FixHydroVans::of_class(int c, int number) const
{
  if ((size_t) c >= stream.class_radii.size()) return 0.0;
  const double *profile = &stream.class_grain[(size_t) c * SD_VANS_ROWS * stream.ncell()];
  if (number == CLASS_RADIUS) return stream.class_radii[c];
  if (number == CLASS_TRANSPORT) return sd_vans_transport(&set.mesh, profile);
  return set.mesh.z_ref + sd_vans_mean_height(&set.mesh, profile);
}

/* Means over the steady part of the run, and their errors. */
double FixHydroVans::steady(int k) const
{
  double mean, error;
  sd_vans_series_mean(&stream.series, k >= MEAN_STRESS, &mean, &error);
  return k == MEAN_TRANSPORT || k == MEAN_STRESS ? mean : error;
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
  if (set.upflow && k >= size_array_cols - 2)
    return k == size_array_cols - 2 ? stream.upward[n] : stream.pressure[n];
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

/* profile file NAME | profile values U_0 ... U_N */
void FixHydroVans::modify_profile(Keywords &in, const Voice &what)
{
  const size_t needed = stream.U.size();
  if (in.choice({"file", "values"}) == 0) {
    stream.U = read_profile(what, in.word(), stream.ncell());
    return;
  }
  if (in.left() != needed)
    what.fail(std::to_string(in.left()) + " values, ncell + 1 = " + std::to_string(needed) +
              " are needed");
  for (double &value : stream.U) value = in.number();
}

/* LAMMPS hands over all words that are left: those of one keyword are taken. After profile and
 * given the forces of the last step do not stand any more; average and solve do what the end of a
 * step does. */
int FixHydroVans::modify_param(int narg, char **arg)
{
  const std::string command = "fix_modify " + std::string(id), key = arg[0];
  const Voice what(lmp, command + ": keyword " + key);
  Keywords in(lmp, command, words(narg, arg), 1);
  in.positional(key);
  if (key == "profile") {
    modify_profile(in, what);
    stream.rest();
    stream.profile_changed();
    last_step = -1;
  } else if (key == "given") {
    stream.take_given(read_given(what, in.word(), stream.ncell(), set.class_radii.size()));
    if (!set.has_grains()) check_radius();
    last_step = -1;
  } else if (key == "gravity") {
    set.take_gravity(in);
    for (Field &component : set.gravity) component.init(lmp);
    take_gravity();
    last_step = -1;
  } else if (key == "steady") {
    in.choice({"anew"});
    stream.series = {};
  } else if (key == "average") {
    if (!set.averages()) what.fail("couple none and fluid have no averages");
    find_names();
    average();
    stream.profile_changed();
  } else if (key == "solve") {
    const double T = in.value("period").positive(), dt = in.value("dt").positive();
    set.check_solve(what, T, dt);
    find_names();
    read_variables();
    if (set.averages() && !(stream.averaged && stream.classes_averaged)) average();
    check_radius();
    solve_on_demand(T, dt);
  } else
    return 0;
  return narg - (int) in.left();
}

/* ---- restart --------------------------------------------------------------------------------- */

/* What the columns of memo are. */
static std::vector<double> layout(const VansSettings &set)
{
  std::vector<double> columns = {(double) set.conserve, (double) set.overlap_once,
                                 set.fluctuations.kind == VansSettings::Fluctuations::LANGEVIN
                                     ? 2.0
                                     : (double) set.fluctuates()};
  if (set.law.added_mass > 0.0) columns.push_back(1.0);
  return columns;
}

std::vector<SavedNumbers> FixHydroVans::saved()
{
  return {{"elapsed", &elapsed},
          {"eddies", &fluctuations.eddies.age, 3},
          {"mean", &mean.radius, 2},
          {"pressed", &local.pressure, 2, true}};
}

void FixHydroVans::write_state(NamedState &state)
{
  state.put("columns", layout(set));
  state.put("last_step", (double) last_step);
  state.put("handed", handed);
  if (variables_known) state.put("variables", {set.law.g[0], set.law.g[1], set.law.g[2], set.law.flux});
  stream.save(state);
}

/* Of the last coupling, where this fix has variables as well. */
void FixHydroVans::take_variables(const std::vector<double> &last)
{
  variables_known = last.size() == 4;
  if (!variables_known) return;
  for (int d = 0; d < 3; d++)
    if (set.gravity[d].is_variable()) set.law.g[d] = last[d];
  if (set.flux.is_variable()) set.law.flux = stream.flux = last[3];
}

void FixHydroVans::read_state(const NamedState &state)
{
  stream.load(state);
  last_step = (bigint) state.get("last_step", -1.0);
  handed = state.get("handed", HUGE_VAL);
  take_variables(state.get("variables"));
  if (state.get("columns") != layout(set))
    set.voice.warn("the restart file was written with other keywords (conserve, overlap, "
                   "fluctuation or added_mass): what each grain carried is dropped, and its "
                   "outstanding momentum, fluctuation and acceleration begin anew");
}
