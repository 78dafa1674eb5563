#include "fix_hydro_vans.h"

#include "fixes.h"
#include "lammps_compat.h"
#include "ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "force.h"
#include "group.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

FixHydroVans::Columns::Columns(const VansSettings &set, const Resume &resume)
{
  const auto add = [this](int &column, size_t bytes) {
    column = all;
    all += (int) (bytes / sizeof(double));
  };
  all += resume.columns();
  if (set.conserve) add(account, sizeof(sd_vans_account));
  if (set.overlap_once) add(lost, sizeof(double));
  if (set.fluctuates()) add(eddy, VansFluctuations::carried(set) * sizeof(double));
  if (set.law.added_mass > 0.0) add(motion, sizeof(sd_vans_motion));
}

FixHydroVans::FixHydroVans(LAMMPS *lmp, int narg, char **arg) :
    RowsFix(lmp, narg, arg), set(lmp, words(narg, arg)), stream(set), out(OUTPUTS),
    resume(lmp, false), column(set, resume), memo(column.all), fluctuations(stream), overlaps(set.voice)
{
  nevery = set.every;
  check_box();
  // Yade's limits are 1e-5 m/s and 10 s; a velocity of 1 is 1 m/s in units si, micro and nano.
  const std::string units = update->unit_style;
  stream.fluid.least_slip = units == "cgs" ? 1e-3 : 1e-5;
  stream.fluid.longest_life = units == "micro" ? 1e7 : units == "nano" ? 1e10 : 10.0;

  if (set.upflow) set.law.upward = stream.upward.data();
  if (set.law.added_mass > 0.0) set.law.rate = stream.rate.data();
  vector_flag = 1;
  size_vector = VECTOR_SIZE;
  array_flag = 1;
  size_array_rows = set.ncell();
  size_array_cols = ARRAY_COLUMNS;
  global_freq = 1;
  extvector = 0;
  extarray = 0;
  restart_global = 1;
  dynamic_group_allow = 1;
  set.law.flux = stream.flux = set.flux.number();
  keep({&out, &memo}, &out, true);
  find_classes();
}

int FixHydroVans::setmask()
{
  return FixConst::POST_FORCE | FixConst::END_OF_STEP;
}

double FixHydroVans::area() const
{
  return set.area > 0.0 ? set.area : domain->xprd * domain->yprd;
}

/* ---- checks ---------------------------------------------------------------------------------- */

void FixHydroVans::check_box() const
{
  if (set.has_grains() && !atom->radius_flag)
    set.voice.fail("an atom style with radius is needed (sphere), unless couple fluid");
  if (force->ftm2v != 1.0)
    set.voice.fail(std::string("units ") + update->unit_style +
                   ": use lj, si, cgs, micro or nano, in which force is mass times acceleration");
  if (domain->dimension != 3)
    set.voice.fail("dimension 2: the stream needs three dimensions, z up");
  for (int d = 0; d < 2; d++)
    if (set.averages() && set.area == 0.0 &&
        (domain->boundary[d][0] >= 2 || domain->boundary[d][1] >= 2))
      set.voice.fail(std::string("keyword area: the box is shrink-wrapped along ") + "xy"[d] +
                     ", so that its area follows the grains: give the area of the stream");
}

/* A run with 'pre no' may find them deleted or made anew. */
void FixHydroVans::find_region()
{
  region = set.region.empty() ? nullptr : Compat::region_of_step(domain, update, set.region);
  if (!set.region.empty() && !region)
    set.voice.fail("keyword region: region '" + set.region + "' does not exist");
  const int average_group = group->find(set.average.c_str());
  if (average_group < 0)
    set.voice.fail("keyword average: group '" + set.average + "' does not exist");
  average_bit = group->bitmask[average_group];
}

/* What the keywords name must still be there. */
void FixHydroVans::find_names()
{
  find_region();
  for (const Given &each : givens()) each.field.init(lmp);
  if (set.overlap_once && !atom->molecule)
    set.voice.fail("keyword overlap: molecule IDs are needed to know the clumps");
  find_classes();
}

void FixHydroVans::init()
{
  if (update->whichflag == 2)
    set.voice.fail("minimize cannot be used with it: the force depends on velocities");
  if (utils::strmatch(update->integrate_style, "^respa"))
    set.voice.fail("run_style respa is not supported");
  check_box();
  find_names();
  if (set.classes && set.averages() && stream.class_radii.empty())
    set.voice.warn("keyword classes: the run begins without grains to average, so that it has no classes; they are "
                   "made from the grains that there are when a run begins");
  if (!set.has_grains()) check_radius();
  if (set.solves()) tell_steps();
  if (set.couple == VansSettings::TWO) tell_sizes();
  tell_roughness();
  tell_smooth();
  tell_lid();
  check_others();
  look_at_neighbours();
  tell_fall();
  tell_overlap();
  tell_weight();
}

/* A solve with a drag that is given. */
void FixHydroVans::check_radius()
{
  const double *drag = stream.row(SD_VANS_DRAG);
  if (stream.fluid.radius == 0.0 && !set.classes &&
      std::any_of(drag, drag + stream.ncell(), [](double f) { return f != 0.0; }))
    set.voice.fail("keyword radius: couple fluid with a drag needs the radius of the grains");
}

/* Atoms that two fixes of this style push. */
void FixHydroVans::check_others() const
{
  if (!set.has_grains()) return;
  for (const Fix *other : fixes_of(lmp, style)) {
    if (other == this) break;    // every pair once
    bigint mine = 0, all;
    for (int i = 0; i < atom->nlocal; i++)
      mine += (atom->mask[i] & groupbit) && (atom->mask[i] & other->groupbit);
    MPI_Allreduce(&mine, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
    if (all > 0)
      set.voice.warn(std::to_string(all) + " atoms are in the groups of fix " + other->id +
                     " and of fix " + id + ": they feel drag and buoyancy twice");
  }
}

double FixHydroVans::phi_at_surface()
{
  return stream.phi()[stream.wet.ncell - 2];
}

/* A bed up to the surface, or a mesh that misses most of the grains, is a mistake in the mesh and
 * not a state of the run. */
void FixHydroVans::check_mesh()
{
  const Voice what = set.voice.of("keyword mesh");
  const int N = stream.ncell();
  const double z_ref = set.mesh.z_ref;
  if (phi_at_surface() > 0.5 * set.fluid.phi_max)
    what.fail("the bed reaches the surface of the water: phi = " + text(phi_at_surface()) +
              " in the slice below z = " + text(stream.surface()) +
              "; the mesh must be high enough for the bed and the water above it");
  select(average_bit);
  double volume[2] = {0, 0}, all[2];
  for (int i = 0; i < atom->nlocal; i++) {
    if (!take[i]) continue;
    const double V = atom->radius[i] * atom->radius[i] * atom->radius[i];
    const int p = sd_vans_slice_of(&set.mesh, atom->x[i][2]);
    volume[0] += V;
    if (p < 0 || p >= N) volume[1] += V;
  }
  MPI_Allreduce(volume, all, 2, MPI_DOUBLE, MPI_SUM, world);
  if (all[1] > 0.5 * all[0])
    what.fail("from z = " + text(z_ref) + " to " + text(z_ref + set.edge[N]) + " it misses " +
              text(100 * all[1] / all[0]) + " % of the grains");
}

/* ---- a step ---------------------------------------------------------------------------------- */

void FixHydroVans::setup(int vflag)
{
  // those of the last coupling stand, in a run that goes on as in one that is not interrupted
  if ((last_step < 0 || !variables_known) && variables_matter()) read_variables();
  if (last_step < 0) feel_pressure();
  set.law.dpdx = stream.felt;
  if (set.overlap_once && !set.averages()) count_overlaps();
  if (set.averages() && !(stream.averaged && stream.classes_averaged)) {
    average();
    stream.profile_changed();
    if (set.couple == VansSettings::TWO) check_mesh();
    tell_waves();
  }
  if (set.fluctuates() && fluctuations.eddies.renewals == 0.0) {
    read_variables();
    renew_fluctuations(0.0, true);
  }
  looked_step = -1;
  // reset_timestep gives the step where the last run ended another number
  if (last_step >= 0) last_step = update->ntimestep;
  post_force(vflag);
  tell_stiff();
}

void FixHydroVans::post_force(int /*vflag*/)
{
  const bool after = last_step >= 0 && update->whichflag == 1 && update->ntimestep > update->firststep;
  const Moment moment = update->ntimestep == last_step ? AGAIN : after ? STEP : ANEW;
  if (moment == STEP) elapsed += update->dt;
  last_step = update->ntimestep;
  summed_step = -1;
  const Sums before = local;
  local = Sums();
  if (!set.has_grains()) return;
  find_region();
  look_at_gravity();
  select(groupbit);
  if (set.law.added_mass > 0.0) find_accelerations(moment);
  local.outside = forces(grains(), true);
  for (int i = 0; i < atom->nlocal; i++) push(i, moment);
  press(moment, before);
  check_forces();
}

/* Adds the force to atom i and to the sums, and books it. */
void FixHydroVans::push(int i, Moment moment)
{
  if (!take[i]) {
    if (out.has(i)) std::fill_n(out.writable(i) + FORCE, 3, 0.0);
    if (!memo.has(i)) return;
    memo.row(i)[Columns::SOLVED] = 0.0;
    if (set.conserve) account(i)->force = 0.0;
    return;
  }
  double *row = memo.writable(i), *Fi = &F[3 * (size_t) i], drag = drag_x[i];
  const double *left = row + Columns::LEFT;
  sd_vans_account *books = set.conserve ? account(i) : nullptr;
  if (books) {
    Fi[0] += books->shear;
    drag += books->shear;
  }
  if (moment == AGAIN && row[Columns::SOLVED] != 0.0 && resume.placed(i, left) && resume.moving(i, left)) {
    std::copy_n(out[i] + FORCE, 3, Fi);
    if (books) drag = books->force;
  }
  row[Columns::SOLVED] = 1.0;
  if (books) {
    if (moment == STEP) sd_vans_account_step(books, drag, update->dt);
    books->force = drag;
  }
  std::copy_n(Fi, 3, out.writable(i) + FORCE);
  for (int d = 0; d < 3; d++) {
    atom->f[i][d] += Fi[d];
    local.force[d] += Fi[d];
  }
  local.drag += drag;
}

void FixHydroVans::check_forces() const
{
  if (std::isfinite(local.force[0] + local.force[1] + local.force[2])) return;
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++)
      if (take[i] && !std::isfinite(out[i][FORCE + d]))
        set.voice.fail_one("the force on atom " + std::to_string(atom->tag[i]) +
                           " is not finite, because its position, velocity or radius, or the "
                           "velocity of the water there, is not finite");
}

void FixHydroVans::find_accelerations(Moment moment)
{
  acceleration.assign(3 * (size_t) atom->nlocal + 3, 0.0);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!take[i]) continue;
    sd_vans_motion *motion = (sd_vans_motion *) (memo.writable(i) + column.motion);
    if (moment == STEP)
      sd_vans_motion_step(motion, atom->v[i], update->dt, &acceleration[3 * (size_t) i]);
    else if (moment == ANEW || motion->span == 0.0)
      sd_vans_motion_begin(motion, atom->v[i]);
  }
}

/* To the grains, before the first coupling. */
bool FixHydroVans::variables_matter() const
{
  return set.flux.is_variable() || (set.has_grains() && set.dpdx.is_variable()) ||
      std::any_of(std::begin(set.gravity), std::end(set.gravity),
                  [](const Field &component) { return component.is_variable(); });
}

void FixHydroVans::take_gravity()
{
  for (int d = 0; d < 3; d++) set.law.g[d] = set.gravity[d].number();
  if (stream.fluid.held) return;
  stream.fluid.gx = set.law.g[0];
  stream.drive = sd_vans_drive(&stream.fluid);
}

std::vector<FixHydroVans::Given> FixHydroVans::givens()
{
  return {{set.dpdx, stream.fluid.dpdx, -HUGE_VAL, "pressure_gradient", ""},
          {set.u_top, stream.fluid.u_top, -HUGE_VAL, "surface", "speed "},
          {set.fluctuations.intensity, fluctuations.intensity, 0.0, "intensity", ""},
          {set.flux, stream.flux, -HUGE_VAL, "upflow", ""},
          {set.discharge, stream.fluid.discharge, -HUGE_VAL, "discharge", ""},
          {set.gravity[0], set.law.g[0], -HUGE_VAL, "gravity", "gx "},
          {set.gravity[1], set.law.g[1], -HUGE_VAL, "gravity", "gy "},
          {set.gravity[2], set.law.g[2], -HUGE_VAL, "gravity", "gz "}};
}

void FixHydroVans::read_variables()
{
  const std::vector<Given> all = givens();
  if (std::none_of(all.begin(), all.end(), [](const Given &each) { return each.field.is_variable(); }))
    return;
  modify->clearstep_compute();
  for (const Given &each : all) {
    if (!each.field.is_variable()) continue;
    each.value = each.field.evaluate(lmp);
    const Voice what = set.voice.at_step().of(std::string("keyword ") + each.keyword);
    const std::string now = each.part + text(each.value);
    if (!std::isfinite(each.value)) what.fail(now + " is not a finite number");
    if (each.value < each.least) what.fail(now + " must be >= 0");
  }
  modify->addstep_compute(update->ntimestep + nevery);
  take_gravity();
  set.law.flux = stream.flux;
  variables_known = true;
}

void FixHydroVans::end_of_step()
{
  read_variables();
  if (set.averages()) average();
  else if (set.overlap_once) count_overlaps();
  tell_stiff();
  if (set.couple == VansSettings::ONE) stream.profile_changed();
  if (set.couple == VansSettings::TWO && phi_at_surface() > 0.5 * set.fluid.phi_max)
    stream.told.warn(VansTold::FULL, "keyword mesh: since step " + std::to_string(update->ntimestep) +
                                         " the bed reaches the surface of the water at z = " + text(stream.surface()) +
                                         ", so that no stream is above it: give the mesh more slices");
  if (set.solves() && set.period > 0.0)
    couple(set.period, set.dt);
  else if (set.solves())
    couple(elapsed, 0.1 * elapsed);
  end_interval();
  if (set.averages() || set.solves()) stream.sample();
  tell_outside();
}

void FixHydroVans::post_run()
{
  for (int i = 0; i < atom->nlocal; i++) record(i);
}

void FixHydroVans::record(int i)
{
  if (memo.has(i)) resume.record(i, memo.row(i) + Columns::LEFT);
}

void FixHydroVans::sum_up()
{
  if (summed_step == update->ntimestep) return;
  MPI_Allreduce(&local, &global, sizeof(Sums) / sizeof(double), MPI_DOUBLE, MPI_SUM, world);
  summed_step = update->ntimestep;
}

void FixHydroVans::tell_outside()
{
  if (stream.told.has(VansTold::OUTSIDE) || !set.has_grains()) return;
  sum_up();
  if (!(global.outside > 0.0)) return;
  stream.told.warn(VansTold::OUTSIDE,
                   text(global.outside) + " grains are outside the mesh: " +
                       (set.yade() ? "no force acts on them"
                                   : "those above it feel the velocity of the surface, those below it feel water at "
                                     "rest"));
}
