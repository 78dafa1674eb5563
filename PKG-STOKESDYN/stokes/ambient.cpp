#include "ambient.h"

#include "halo.h"
#include "keywords.h"
#include "lammps_compat.h"

#include "sd_linear.h"

#include "atom.h"
#include "domain.h"
#include "fix.h"
#include "force.h"
#include "group.h"
#include "modify.h"
#include "region.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace LAMMPS_NS;

namespace StokesDyn {

static bool finite(const double *v)
{
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

void Ambient::init()
{
  region = nullptr;
  if (!settings.region.empty() && !(region = Compat::region(domain, settings.region)))
    voice.fail("keyword region: region '" + settings.region + "' does not exist");
  igroup = group->find(settings.group);
  if (igroup < 0)
    voice.fail("keyword group: group '" + settings.group + "' does not exist");
  groupbit = group->bitmask[igroup];
  settings.visc.init(lmp);
  for (Field &field : settings.velocity) field.init(lmp);
  for (Field &field : settings.vorticity) field.init(lmp);
}

bool Ambient::numbers_only() const
{
  bool plain = !settings.visc.is_variable() && !settings.box;
  for (int d = 0; d < 3; d++)
    plain = plain && !settings.velocity[d].is_variable() && !settings.vorticity[d].is_variable();
  return plain;
}

static bool is_series(const FlowFile *grid)
{
  return grid && grid->grid.axis[SD_GRID_TIME].n > 1;
}

bool Ambient::steady() const
{
  return numbers_only() && !is_series(settings.grid.get());
}

bool Ambient::varies() const
{
  bool varies = settings.grid || settings.box;
  for (const auto &field : settings.velocity) varies = varies || field.is_atom_style();
  return varies;
}

void Ambient::numbers(double *nine) const
{
  nine[0] = settings.visc.number();
  for (int d = 0; d < 3; d++) {
    nine[1 + d] = settings.velocity[d].number();
    nine[4 + d] = settings.vorticity[d].number();
  }
  const FlowFile *grid = settings.grid.get();
  nine[7] = grid ? grid->fingerprint : 0.0;
  nine[8] = is_series(grid) ? now : 0.0;
}

void Ambient::read(bool with_spins, Derivatives derivatives, double time)
{
  spins = with_spins;
  wanted = derivatives;
  now = time;
  read_fluid(derivatives);
  check();
}

void Ambient::check() const
{
  const bigint none = MAXBIGINT;
  bigint mine = none;
  for (int i : those)
    if (const int f = fault(i)) mine = std::min(mine, (bigint) atom->tag[i] * 16 + f);
  const bigint first = smallest_of_all(world, mine);
  if (first != none) complain(first);
}

void Ambient::read_fluid(Derivatives derivatives)
{
  const int n = atom->nlocal;
  const bool u_varies = varies(), with_gradients = derivatives >= FIRST;
  if (!numbers_only()) modify->clearstep_compute();
  motion = u_varies ? motion_of_box(voice) : BoxMotion();

  eta.resize(settings.visc.is_atom_style() || settings.grid_has_visc ? n + 1 : 0);
  settings.visc.evaluate(lmp, igroup, eta.empty() ? nullptr : eta.data(), 1);
  for (double &value : eta) value *= force->vxmu2f;
  eta_uniform = settings.visc.number() * force->vxmu2f;

  u.resize(u_varies ? 3 * (size_t) n + 3 : 0);
  // The grid is looked up for those that take part.
  if (settings.grid && those.size() < (size_t) n) std::fill(u.begin(), u.end(), 0.0);
  for (int d = 0; d < 3; d++) {
    double *out = u.empty() || settings.grid || settings.box ? nullptr : u.data() + d;
    settings.velocity[d].evaluate(lmp, igroup, out, 3);
    u_uniform[d] = settings.velocity[d].number();
  }
  const bool nonuniform = u_varies || settings.has_vorticity;
  w.assign(nonuniform && (spins || with_gradients) ? 3 * (size_t) n + 3 : 0, 0.0);
  gradient.assign(nonuniform && with_gradients ? 9 * (size_t) n + 9 : 0, 0.0);
  if (settings.grid)
    read_grid();
  else if (settings.box)
    read_box(!gradient.empty());
  else if (u_varies && !w.empty())
    read_gradient();
  if (settings.has_vorticity) read_vorticity();
  const bool curved = u_varies && !settings.box && derivatives >= SECOND;
  curvature.assign(curved ? SD_FLOW_SECOND * ((size_t) n + 1) : 0, 0.0);
  if (curved) read_curvature();
  find_jumps();
  if (!numbers_only()) modify->addstep_compute(update->ntimestep + 1);
}

/* The same gradient everywhere */
void Ambient::read_box(bool with_gradients)
{
  double rotation[3];
  sd_flow_rotation(motion.gradient, rotation);
  for (size_t i : those) {
    motion.at(atom->x[i], &u[3 * i]);
    if (!w.empty()) std::copy_n(rotation, 3, &w[3 * i]);
    if (with_gradients) std::copy_n(motion.gradient, 9, &gradient[9 * i]);
  }
}

/* Fluid velocity [3 nlocal] at the atoms displaced by a vector, in radii of each or as it is. What is no
 * formula in x, y, z, or a number stored per atom, stays as it is; so does component `but`. */
std::vector<double> Ambient::velocity_at(const double by[3], bool in_radii, int but)
{
  return velocity_at([&](int i, double *x) {
    for (int d = 0; d < 3; d++) x[d] += by[d] * (in_radii ? atom->radius[i] : 1.0);
  }, but);
}

std::vector<double> Ambient::velocity_at(const std::function<void(int, double *)> &move, int but)
{
  std::vector<double> values = u;
  const Places kept(atom);
  for (int i = 0; i < atom->nlocal; i++) move(i, atom->x[i]);
  for (int d = 0; d < 3; d++)
    if (settings.velocity[d].is_atom_style() && d != but)
      settings.velocity[d].evaluate(lmp, igroup, values.data() + d, 3);
  if (!settings.grid) return values;
  sd_flow_frame frame;
  sd_flow_grid_frame(&settings.grid->grid, now, &frame);    // read_grid() has looked at the time
  for (size_t i : those) {
    double x[3], value[4];
    in_the_box((int) i, x);
    sd_flow_grid_at(&settings.grid->grid, &frame, 1, x, value, nullptr);
    std::copy_n(value, 3, &values[3 * i]);
  }
  return values;
}

static void edge_of_box(const Domain *domain, int q, double edge[3])
{
  const int step[3] = {q == 0, q == 1, q == 2};
  std::fill_n(edge, 3, 0.0);
  sd_add_edges(domain->h, step, edge);
}

/* Of the components that are formulas: sums [3] of what they grow by along an edge, over this rank's
 * spheres; most [2] the largest growth beyond the one expected [3], and velocity. */
void Ambient::growth_along(const double edge[3], const double expected[3], double sums[3],
                           double most[2])
{
  const std::vector<double> there = velocity_at(edge, false);
  for (size_t i : those)
    for (size_t p = 0; p < 3; p++) {
      if (!settings.velocity[p].is_atom_style()) continue;
      const double here = u[3 * i + p], growth = there[3 * i + p] - here;
      most[0] = std::max(most[0], std::fabs(growth - expected[p]));
      most[1] = std::max(most[1], std::fabs(here));
      sums[p] += growth;
    }
}

/* In a run of no steps fix deform has no rate for some of its styles. */
double Ambient::misfit()
{
  const bool no_rate = motion.deforms && update->endstep == update->beginstep;
  if (u.empty() || settings.grid || settings.box || no_rate) return 0.0;
  double most[2] = {0.0, 0.0}, sums[3] = {0.0}, edge[3], of_box[3];
  modify->clearstep_compute();
  for (int q = 0; q < 3; q++) {
    if (!domain->periodicity[q]) continue;    // along it nobody sees an image
    edge_of_box(domain, q, edge);
    sd_multiply3(motion.gradient, edge, of_box);
    growth_along(edge, of_box, sums, most);
  }
  modify->addstep_compute(update->ntimestep + 1);
  MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, world);
  return most[0] > 0.0 ? most[0] / std::max(most[0], most[1]) : 0.0;
}

/* Which components are stored for atoms: they are of atom style, are the same at another place, and are not
 * one number for all of several spheres, as a constant formula would be. */
void Ambient::find_stored(const std::vector<double> &elsewhere, bool stored[3]) const
{
  double seen[9];    // of each component: is it another one there, largest value, largest -value
  std::fill_n(seen, 9, -INFINITY);
  for (size_t i : those)
    for (size_t d = 0; d < 3; d++) {
      const double here = u[3 * i + d];
      seen[d] = std::max(seen[d], here != elsewhere[3 * i + d] ? 1.0 : 0.0);
      seen[3 + d] = std::max(seen[3 + d], here);
      seen[6 + d] = std::max(seen[6 + d], -here);
    }
  double spheres = (double) those.size();
  MPI_Allreduce(MPI_IN_PLACE, seen, 9, MPI_DOUBLE, MPI_MAX, world);
  MPI_Allreduce(MPI_IN_PLACE, &spheres, 1, MPI_DOUBLE, MPI_SUM, world);
  for (int d = 0; d < 3; d++)
    stored[d] = settings.velocity[d].is_atom_style() && seen[d] <= 0.0 &&
        (spheres < 2.0 || seen[3 + d] > -seen[6 + d]);
}

void Ambient::look_at_plane(int axis, double at, double of_largest[2])
{
  double most[3] = {0.0, 0.0, 0.0};    // along it, across it, and at the spheres
  std::fill_n(of_largest, 2, 0.0);
  if (settings.box) return;
  if (u.empty()) {    // of numbers everybody knows without looking
    for (int d = 0; d < 3; d++)
      if (settings.velocity[d].is_variable())
        most[d == axis] = std::max(most[d == axis], std::fabs(u_uniform[d]));
  } else {
    bool stored[3];
    modify->clearstep_compute();
    const std::vector<double> there = velocity_at([&](int, double *x) { x[axis] = at; }, -1);
    modify->addstep_compute(update->ntimestep + 1);
    find_stored(there, stored);
    for (size_t i : those)
      for (int d = 0; d < 3; d++) {
        if (stored[d] || !std::isfinite(there[3 * i + d])) continue;    // or beyond a grid
        most[d == axis] = std::max(most[d == axis], std::fabs(there[3 * i + d]));
        most[2] = std::max(most[2], std::fabs(u[3 * i + d]));
      }
  }
  MPI_Allreduce(MPI_IN_PLACE, most, 3, MPI_DOUBLE, MPI_MAX, world);
  for (int k = 0; k < 2; k++)
    if (most[k] > 0.0) of_largest[k] = most[k] / std::max(most[k], most[2]);
}

/* The mean over all spheres, since in a flow that goes with the box it is the same for each; the
 * edges have no other components. */
void Ambient::find_jumps()
{
  static const int OF[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};    // velocity, edge
  static const double NOTHING[3] = {0.0, 0.0, 0.0};
  jumping = false;
  std::fill_n(jump, 6, 0.0);
  if (!domain->deform_flag || u.empty() || settings.grid) return;
  double sums[3][3] = {{0.0}}, most[2] = {0.0, 0.0}, count = 1.0, edge[3];
  for (int q = 0; q < 3; q++) {
    edge_of_box(domain, q, edge);
    if (settings.box)
      sd_multiply3(motion.gradient, edge, sums[q]);
    else if (domain->periodicity[q])
      growth_along(edge, NOTHING, sums[q], most);
  }
  if (!settings.box) {
    MPI_Allreduce(MPI_IN_PLACE, sums, 9, MPI_DOUBLE, MPI_SUM, world);
    MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, world);
    count = sum_of_all(world, (double) those.size());
  }
  jumping = settings.box || most[0] > 1e-9 * most[1];
  for (int k = 0; k < 6; k++) jump[k] = jumping ? sums[OF[k][1]][OF[k][0]] / count : 0.0;
}

/* By central differences over one radius to either side. Values stored per atom do not follow, and
 * their gradient comes out as 0. A vorticity that is given needs none of this, and a rotation no
 * component along its own direction. */
void Ambient::read_gradient()
{
  if (gradient.empty() && settings.has_vorticity) return;
  for (size_t q = 0; q < 3; q++) {
    const int but = gradient.empty() ? (int) q : -1;
    double by[3] = {0.0, 0.0, 0.0};
    by[q] = 1.0;
    const std::vector<double> ahead = velocity_at(by, true, but);
    by[q] = -1.0;
    const std::vector<double> behind = velocity_at(by, true, but);
    for (size_t i = 0; i < (size_t) atom->nlocal; i++) {
      double G[9] = {0.0}, rotation[3];
      for (size_t p = 0; p < 3; p++)
        G[3 * p + q] = sd_flow_slope(ahead[3 * i + p], behind[3 * i + p], atom->radius[i]);
      sd_flow_rotation(G, rotation);
      for (size_t p = 0; p < 3; p++) {
        w[3 * i + p] += rotation[p];
        if (!gradient.empty()) gradient[9 * i + 3 * p + q] = G[3 * p + q];
      }
    }
  }
}

void Ambient::read_vorticity()
{
  for (int d = 0; d < 3; d++) settings.vorticity[d].evaluate(lmp, igroup, w.data() + d, 3);
  if (!gradient.empty())
    for (int i = 0; i < atom->nlocal; i++)
      sd_flow_set_vorticity(&w[3 * (size_t) i], &gradient[9 * (size_t) i]);
  for (double &value : w) value *= 0.5;
}

/* By second differences. Values stored per atom do not follow, and have none. */
void Ambient::read_curvature()
{
  std::vector<double> bend(SD_FLOW_SECOND * ((size_t) atom->nlocal + 1), 0.0);
  for (int e = 0; e < SD_FLOW_DIRECTIONS; e++)
    for (const double side : {SD_FLOW_STEP, -SD_FLOW_STEP}) {
      double by[3];
      for (int d = 0; d < 3; d++) by[d] = side * sd_flow_around[e][d];
      const std::vector<double> there = velocity_at(by, true);
      for (size_t i : those)
        for (size_t p = 0; p < 3; p++)
          bend[SD_FLOW_SECOND * i + 6 * p + e] += there[3 * i + p] - u[3 * i + p];
    }
  for (size_t i : those) {
    const double *from = &bend[SD_FLOW_SECOND * i];
    const bool known = std::isfinite(std::accumulate(from, from + SD_FLOW_SECOND, 0.0));
    for (int p = 0; p < 3 && known; p++)
      sd_flow_curvature(from + 6 * p, SD_FLOW_STEP * atom->radius[i],
                        &curvature[SD_FLOW_SECOND * i + 6 * p]);
  }
}

/* An atom and its images are one place, and where LAMMPS keeps it depends on when it last looked.
 * Nearly all are inside, so that there is no branch for each side. */
inline void Ambient::in_the_box(int i, double *x) const
{
  const double *from = atom->x[i], *lo = domain->boxlo, *hi = domain->boxhi;
  bool inside = !domain->triclinic;
  for (int d = 0; d < 3; d++) {
    inside &= (from[d] >= lo[d]) & (from[d] < hi[d]);
    x[d] = from[d];
  }
  // remap() goes box by box, for ever if x is infinite: fault() tells of those
  if (!inside && finite(x) && !far_out(i)) domain->remap(x);
}

/* Velocity, viscosity and gradient of those that take part. Where the grid has none they are NaN,
 * and fault() tells. */
void Ambient::read_grid()
{
  const sd_flow_grid &grid = settings.grid->grid;
  sd_flow_frame frame;
  if (sd_flow_grid_frame(&grid, now, &frame) != SD_OK) {
    const sd_grid_axis &axis = grid.axis[SD_GRID_TIME];
    voice.of("keyword fluid_velocity")
        .at_step()
        .fail("the time " + text(now) + " is outside of the series in '" + settings.grid->path +
              "', which goes from " + text(axis.at[0]) + " to " + text(axis.at[axis.n - 1]) +
              "; end the line of its axis with clamp or periodic to go on");
  }
  // so many at once that memory keeps up, and few enough for the stack
  constexpr size_t BLOCK = 64;
  double x[3 * BLOCK], value[4 * BLOCK], G[9 * BLOCK];
  const bool with_gradients = !w.empty();
  for (size_t begin = 0; begin < those.size(); begin += BLOCK) {
    const size_t count = std::min(BLOCK, those.size() - begin);
    for (size_t k = 0; k < count; k++) in_the_box(those[begin + k], x + 3 * k);
    sd_flow_grid_at(&grid, &frame, (int) count, x, value, with_gradients ? G : nullptr);
    for (size_t k = 0; k < count; k++) {
      const size_t i = those[begin + k];
      const double *row = value + grid.columns * k;
      for (int d = 0; d < 3; d++) u[3 * i + d] = row[d];
      if (settings.grid_has_visc) eta[i] = row[3] * force->vxmu2f;
      if (with_gradients) sd_flow_rotation(G + 9 * k, &w[3 * i]);
      if (!gradient.empty()) std::copy_n(G + 9 * k, 9, &gradient[9 * i]);
    }
  }
}

/* Has the group the atoms that it had, at the places in memory where they were? LAMMPS moves atoms
 * when it re-neighbours, users change groups between runs (also before one with 'pre no'). */
bool Ambient::group_stands() const
{
  return members_found.is(epochs.groups) && !group->dynamic[igroup] &&
      takes_part.size() == (size_t) atom->nlocal;
}

/* LAMMPS finds the atoms of a dynamic group in setup() of a fix of its own after the first forces of a
 * run, and in steps before the forces (2022) or after them (2025). Asked here, it has those of this
 * step in any version. */
void Ambient::fill_group()
{
  if (!group->dynamic[igroup]) return;
  Fix *finder = Compat::fix(modify, "GROUP_" + settings.group);
  if (finder && (update->setupflag || update->ntimestep % finder->nevery == 0)) finder->setup(0);
}

/* A group that stands costs nothing, however many atoms are not in it. Of those in it each may enter
 * or leave the region in any step: by its place in the box, as LAMMPS wraps it only when it
 * re-neighbours. */
void Ambient::select()
{
  fill_group();
  const bool stands = group_stands();
  if (stands && !region) return;
  if (!stands) {
    members_found.take(epochs.groups);
    members.clear();
    for (int i = 0; i < atom->nlocal; i++)
      if (atom->mask[i] & groupbit) members.push_back(i);
  }
  std::vector<int> chosen;
  if (region) region->prematch();
  for (int i : members) {
    double x[3];
    if (region) in_the_box(i, x);
    // A position that is no number is in no region: it takes part, so that the fault is seen.
    if (!region || !std::isfinite(x[0] + x[1] + x[2]) || region->match(x[0], x[1], x[2]))
      chosen.push_back(i);
  }
  if (stands && chosen == those) return;
  those.swap(chosen);
  takes_part.assign(atom->nlocal, 0);
  for (int i : those) takes_part[i] = 1;
  epochs.selection.advance();
}

std::vector<char> Ambient::chosen_now() const
{
  std::vector<char> chosen(atom->nlocal + 1, 0);
  if (region) region->prematch();
  for (int i = 0; i < atom->nlocal; i++) {
    const double *x = atom->x[i];
    chosen[i] = (atom->mask[i] & groupbit) && (!region || region->match(x[0], x[1], x[2]));
  }
  return chosen;
}

enum Fault { NONE, POSITION, FAR_OUT, VELOCITY, RADIUS, VISCOSITY, FLUID_VELOCITY, FLUID_VORTICITY };

/* More than one length of a periodic box outside of it: LAMMPS wraps an atom by one length, and
 * between two wrappings it moves by half the skin in any run that means something. */
bool Ambient::far_out(int i) const
{
  const double *lo = domain->triclinic ? domain->boxlo_bound : domain->boxlo;
  const double *hi = domain->triclinic ? domain->boxhi_bound : domain->boxhi;
  for (int d = 0; d < 3; d++)
    if (domain->periodicity[d] && !(atom->x[i][d] >= lo[d] - domain->prd[d] &&
                                    atom->x[i][d] <= hi[d] + domain->prd[d]))
      return true;
  return false;
}

int Ambient::fault(int i) const
{
  // 0 times a number is 0 unless it is infinite or not a number: nearly always this one test is enough.
  const double *x = atom->x[i], *v = atom->v[i], *fluid = velocity(i), a = atom->radius[i];
  double sum = x[0] + x[1] + x[2] + a + v[0] + v[1] + v[2] + viscosity(i) + fluid[0] + fluid[1] +
      fluid[2];
  if (spins) sum += atom->omega[i][0] + atom->omega[i][1] + atom->omega[i][2];
  const double *rotation = w.empty() ? nullptr : &w[3 * (size_t) i];
  if (rotation) sum += rotation[0] + rotation[1] + rotation[2];
  if (0.0 * sum == 0.0 && a > 0.0 && viscosity(i) > 0.0) return far_out(i) ? FAR_OUT : NONE;

  // Velocity first: it spoils the position in the same step.
  if (!finite(v) || (spins && !finite(atom->omega[i]))) return VELOCITY;
  if (!finite(x)) return POSITION;
  if (!(a > 0.0) || !std::isfinite(a)) return RADIUS;
  if (!finite(fluid)) return FLUID_VELOCITY;
  if (!(viscosity(i) > 0.0) || !std::isfinite(viscosity(i))) return VISCOSITY;
  return rotation && !finite(rotation) ? FLUID_VORTICITY : NONE;
}

/* What is in a grid file is finite, so it has no velocity only where it ends. */
std::string Ambient::outside_of_grid(const double *x) const
{
  if (!settings.grid) return "the fluid velocity there is not a finite number";
  static const char *const NAME[] = {"x", "y", "z"};
  std::string where = "its position " + text(x[0]) + " " + text(x[1]) + " " + text(x[2]) +
      " is outside of the grid in '" + settings.grid->path + "'";
  for (int d = 0; d < 3; d++) {
    const sd_grid_axis &axis = settings.grid->grid.axis[d];
    const double first = axis.at[0], last = axis.at[axis.n - 1];
    if (axis.n > 1 && axis.outside == SD_OUTSIDE_NONE && !(x[d] >= first && x[d] <= last))
      where += std::string(", whose ") + NAME[d] + " goes from " + text(first) + " to " + text(last);
  }
  return where + "; end the line of an axis with clamp or periodic to go on";
}

/* One rank has found a faulty atom; all ranks end the run with the name of the first. */
void Ambient::complain(long long first) const
{
  enum { VALUE, PLACE, KNOWN = PLACE + 3 };
  double mine[KNOWN] = {0.0}, sum[KNOWN];
  for (int i : those)
    if (atom->tag[i] == first / 16 && fault(i) == first % 16) {
      mine[VALUE] = first % 16 == RADIUS ? atom->radius[i] : viscosity(i) / force->vxmu2f;
      in_the_box(i, mine + PLACE);
    }
  MPI_Allreduce(mine, sum, KNOWN, MPI_DOUBLE, MPI_SUM, world);
  const int fault = first % 16;
  const std::string why[] = {
      "",
      "its position is not a finite number",
      "its position is more than a box length outside of the periodic box: the run has blown up; is "
      "the time step too long, or a number in other units?",
      "its velocity is not a finite number",
      "its radius " + text(sum[VALUE]) + " must be > 0 (keyword group selects the spheres)",
      "keyword visc: its viscosity " + text(sum[VALUE]) + " must be > 0",
      "keyword fluid_velocity: " + outside_of_grid(sum + PLACE),
      "keyword fluid_vorticity: the vorticity of the fluid there is not a finite number"};
  voice.fail("step " + std::to_string(update->ntimestep) + ", atom " + std::to_string(first / 16) +
             ": " + why[fault]);
}

double Ambient::memory_usage() const
{
  return takes_part.capacity() +
      sizeof(int) * ((double) members.capacity() + (double) those.capacity()) +
      sizeof(double) *
      ((double) eta.capacity() + u.capacity() + w.capacity() + gradient.capacity() +
       curvature.capacity());
}

}    // namespace StokesDyn
