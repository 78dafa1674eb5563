#include "ambient.h"

#include "copy.h"
#include "deform_checks.h"
#include "keywords.h"
#include "lammps_compat.h"
#include "places.h"
#include "ranks.h"

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

using namespace LAMMPS_NS;

namespace StokesDyn {

static bool finite(const double *v)
{
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

/* A run with 'pre no' may find them deleted or made anew. */
void Ambient::find_names()
{
  region = nullptr;
  if (!settings.region.empty() && !(region = Compat::region_of_step(domain, update, settings.region)))
    voice.fail("keyword region: region '" + settings.region + "' does not exist");
  igroup = group->find(settings.group);
  if (igroup < 0)
    voice.fail("keyword group: group '" + settings.group + "' does not exist");
  groupbit = group->bitmask[igroup];
}

void Ambient::init()
{
  find_names();
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

void Ambient::read(bool with_spins, Derivatives derivatives, double time, double steps)
{
  later = steps;
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
  motion = u_varies ? motion_of_box(voice, later) : BoxMotion();
  if (settings.box && !told_volume) told_volume = warn_of_volume(voice, motion);

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
  sd_flow_rotation(motion.flow.gradient, rotation);
  for (size_t i : those) {
    sd_box_flow_at(&motion.flow, atom->x[i], &u[3 * i]);
    if (!w.empty()) std::copy_n(rotation, 3, &w[3 * i]);
    if (with_gradients) std::copy_n(motion.flow.gradient, 9, &gradient[9 * i]);
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
    image_in_box(domain, atom->x[i], x);
    sd_flow_grid_at(&settings.grid->grid, &frame, 1, x, value, nullptr);
    std::copy_n(value, 3, &values[3 * i]);
  }
  return values;
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
    for (size_t k = 0; k < count; k++) image_in_box(domain, atom->x[those[begin + k]], x + 3 * k);
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
  find_names();
  fill_group();
  const bool stands = group_stands();
  if (stands && !region) return;
  if (!stands) {
    members_found.set(epochs.groups);
    members.clear();
    for (int i = 0; i < atom->nlocal; i++)
      if (atom->mask[i] & groupbit) members.push_back(i);
  }
  std::vector<int> chosen;
  if (region) region->prematch();
  for (int i : members) {
    double x[3];
    if (region) image_in_box(domain, atom->x[i], x);
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

std::vector<char> Ambient::chosen_now()
{
  find_names();
  std::vector<char> chosen(atom->nlocal + 1, 0);
  if (region) region->prematch();
  for (int i = 0; i < atom->nlocal; i++) {
    const double *x = atom->x[i];
    chosen[i] = (atom->mask[i] & groupbit) && (!region || region->match(x[0], x[1], x[2]));
  }
  return chosen;
}

enum Fault { NONE, POSITION, FAR_OUT, VELOCITY, RADIUS, VISCOSITY, FLUID_VELOCITY, FLUID_VORTICITY };

int Ambient::fault(int i) const
{
  // 0 times a number is 0 unless it is infinite or not a number: nearly always this one test is enough.
  const double *x = atom_row(atom->x, i), *v = atom_row(atom->v, i), *fluid = velocity(i), a = atom->radius[i];
  double sum = x[0] + x[1] + x[2] + a + v[0] + v[1] + v[2] + viscosity(i) + fluid[0] + fluid[1] +
      fluid[2];
  if (spins) sum += atom->omega[i][0] + atom->omega[i][1] + atom->omega[i][2];
  const double *rotation = w.empty() ? nullptr : &w[3 * (size_t) i];
  if (rotation) sum += rotation[0] + rotation[1] + rotation[2];
  if (0.0 * sum == 0.0 && a > 0.0 && viscosity(i) > 0.0) return far_out(domain, atom->x[i]) ? FAR_OUT : NONE;

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
      image_in_box(domain, atom->x[i], mine + PLACE);
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
