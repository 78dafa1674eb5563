#include "fix_hydro_vans.h"

#include "lammps_compat.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "group.h"
#include "memory.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static const std::string COMMAND = VansSettings::COMMAND;
static const double PI = 3.14159265358979323846;
static constexpr size_t MAX_CLASSES = 32;

/* Columns of the global array, before those of the classes. */
enum { Z, VELOCITY, PHI, GRAIN_X, GRAIN_Y, GRAIN_Z, DRAG_PER_GRAIN, EXCHANGE, EDDY_VISCOSITY, STRESS, ARRAY_COLUMNS };

/* Entries of the global vector. */
enum {
  FORCE_X,
  FORCE_Y,
  FORCE_Z,
  TRANSPORT,
  FRICTION_VELOCITY,
  LARGEST_STRESS,
  OUTSIDE,
  SHIELDS,
  TOTAL_DRAG,
  BED,
  MOMENTUM,
  TRANSIT,
  DRIVING,
  BOTTOM,
  WALLS,
  SURFACE,
  OTHERS,
  VECTOR_SIZE
};

FixHydroVans::FixHydroVans(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  const auto args = words(narg, arg);
  double every;
  if (narg < 4 || !is_number(args[3], every) || every != std::floor(every) || every < 1 || every > 1e9)
    fail(lmp,
         COMMAND + ": the number of steps N after the style must be an integer >= 1" +
             (narg < 4 ? "" : ", not '" + args[3] + "'"));
  nevery = (int) every;
  set.parse(lmp, args, 4);
  if (has_grains() && !atom->radius_flag)
    fail(lmp, COMMAND + ": an atom style with radius is needed (sphere), unless couple fluid");

  if (set.conserve) drag_column = columns, columns += MOMENTUM_COLUMNS;
  if (set.overlap_once) weight_column = columns, columns += 1;
  if (set.fluctuation != VansSettings::NO_FLUCTUATION) eddy_column = columns, columns += 2;

  stream.reset(new VansStream(lmp, set));

  peratom_flag = 1;
  size_peratom_cols = OUTPUTS;
  peratom_freq = 1;
  vector_flag = 1;
  size_vector = VECTOR_SIZE;
  array_flag = 1;
  size_array_rows = set.ncell();
  size_array_cols = ARRAY_COLUMNS;
  global_freq = 1;
  extvector = 0;
  extarray = 0;
  restart_global = 1;
  restart_peratom = 1;
  create_attribute = 1;
  dynamic_group_allow = 1;

  grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
  for (int i = 0; i < atom->nlocal; i++) set_arrays(i);
  find_classes();
}

FixHydroVans::~FixHydroVans()
{
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
  memory->destroy(array_atom);
  memory->destroy(memo);
}

int FixHydroVans::setmask()
{
  return FixConst::POST_FORCE | FixConst::END_OF_STEP;
}

double FixHydroVans::area() const
{
  return set.area > 0.0 ? set.area : domain->xprd * domain->yprd;
}

/* One class for each radius, in the order of the lowest atom ID that has it. */
void FixHydroVans::find_classes()
{
  if (!has_grains() || !set.class_radii.empty() || !(set.classes || set.wants_pores())) {
    if (set.classes) size_array_cols = ARRAY_COLUMNS + 5 * (int) stream->class_radii.size();
    return;
  }
  const int found = group->find(set.average.c_str()), bit = found < 0 ? 1 : group->bitmask[found];
  std::map<double, double> first;    // radius: lowest ID
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & bit) || !(atom->radius[i] > 0.0)) continue;
    const auto at = first.find(atom->radius[i]);
    if (at == first.end())
      first[atom->radius[i]] = (double) atom->tag[i];
    else
      at->second = std::min(at->second, (double) atom->tag[i]);
    if (first.size() > MAX_CLASSES) break;
  }
  std::vector<double> mine(2 * (MAX_CLASSES + 1), 0.0), all(mine.size() * comm->nprocs);
  size_t k = 0;
  for (const auto &entry : first) {
    mine[k++] = entry.first;
    mine[k++] = entry.second;
  }
  MPI_Allgather(mine.data(), (int) mine.size(), MPI_DOUBLE, all.data(), (int) mine.size(), MPI_DOUBLE, world);
  first.clear();
  for (k = 0; k < all.size(); k += 2)
    if (all[k] > 0.0) {
      const auto at = first.find(all[k]);
      if (at == first.end())
        first[all[k]] = all[k + 1];
      else
        at->second = std::min(at->second, all[k + 1]);
    }
  if (first.size() > MAX_CLASSES) {
    if (set.classes)
      fail(lmp,
           COMMAND + ": keyword classes: the grains have more than " + std::to_string(MAX_CLASSES) +
               " different radii; a class is one radius exactly");
    first.clear();    // pores: one class of the mean radius
  }
  std::vector<std::pair<double, double>> order;
  for (const auto &entry : first) order.emplace_back(entry.second, entry.first);
  std::sort(order.begin(), order.end());
  std::vector<double> radii;
  for (const auto &entry : order) radii.push_back(entry.second);
  if (!radii.empty()) stream->set_classes(radii);
  if (set.classes) size_array_cols = ARRAY_COLUMNS + 5 * (int) stream->class_radii.size();
}

void FixHydroVans::init()
{
  if (update->whichflag == 2) fail(lmp, COMMAND + ": the force depends on velocities: it is no force for a minimisation");
  if (utils::strmatch(update->integrate_style, "^respa")) fail(lmp, COMMAND + ": run_style respa is not supported");
  if (has_grains() && !atom->radius_flag)
    fail(lmp, COMMAND + ": an atom style with radius is needed (sphere), unless couple fluid");
  region = nullptr;
  if (!set.region.empty()) {
    region = Compat::region(domain, set.region);
    if (!region) fail(lmp, COMMAND + ": keyword region: region '" + set.region + "' does not exist");
  }
  const int average_group = group->find(set.average.c_str());
  if (average_group < 0) fail(lmp, COMMAND + ": keyword average: group '" + set.average + "' does not exist");
  average_bit = group->bitmask[average_group];
  set.dpdx.init(lmp, COMMAND + ": keyword pressure_gradient");
  set.u_top.init(lmp, COMMAND + ": keyword surface");
  if (set.dpdx.is_atom_style()) fail(lmp, COMMAND + ": keyword pressure_gradient: an equal-style variable is needed");
  if (set.u_top.is_atom_style()) fail(lmp, COMMAND + ": keyword surface: an equal-style variable is needed");
  if (set.overlap_once && !atom->molecule) fail(lmp, COMMAND + ": keyword overlap: molecule IDs are needed to know the clumps");
  find_classes();

  if (set.couple == VansSettings::FLUID && set.radius == 0.0 &&
      std::any_of(stream->drag(), stream->drag() + stream->ncell(),
                  [](double f) {
                    return f != 0.0;
                  }) &&
      !set.classes)
    fail(lmp, COMMAND + ": keyword radius: couple fluid with a drag needs the radius of the grains");
  if ((set.couple == VansSettings::TWO || set.couple == VansSettings::FLUID) && comm->me == 0) {
    const double T = set.period > 0.0 ? set.period : nevery * update->dt, wanted = set.period > 0.0 ? set.dt : 0.1 * T;
    double dt = wanted;
    const auto steps = sd_vans_steps(set.rules, T, &dt);
    if (std::fabs(dt - wanted) > 1e-9 * wanted)
      utils::logmesg(lmp,
                     COMMAND + ": the step " + text(wanted) + " of keyword solve is no fraction of " + text(T) + ": " +
                         std::to_string(steps) + " steps of " + text(dt) + " are used\n");
    else if (std::fabs(steps * dt - T) > 1e-9 * T)
      utils::logmesg(lmp,
                     COMMAND + ": rules yade: " + std::to_string(steps) + " steps of " + text(dt) +
                         " are used for the period " + text(T) + "\n");
    if (set.couple == VansSettings::TWO && std::fabs(T / (nevery * update->dt) - 1.0) > 1e-9)
      utils::logmesg(lmp,
                     COMMAND + ": the water moves on by " + text(T) + " while the grains move on by " +
                         text(nevery * update->dt) + "\n");
  }
}

/* ---- which atoms --------------------------------------------------------------------------------------------------------- */

void FixHydroVans::select(int bit, bool not_in_group)
{
  const int n = atom->nlocal;
  take.resize(n);
  if (region) region->prematch();
  for (int i = 0; i < n; i++) {
    take[i] = (atom->mask[i] & bit) && atom->radius[i] > 0.0 && !(not_in_group && (atom->mask[i] & groupbit));
    if (take[i] && region) take[i] = region->match(atom->x[i][0], atom->x[i][1], atom->x[i][2]) != 0;
  }
}

const double *FixHydroVans::fluctuations()
{
  if (eddy_column < 0) return nullptr;
  u.resize(3 * (size_t) atom->nlocal + 3);
  for (int i = 0; i < atom->nlocal; i++) memcpy(&u[3 * (size_t) i], array_atom[i] + 3, 3 * sizeof(double));
  return u.data();
}

const double *FixHydroVans::weights()
{
  if (weight_column < 0) return nullptr;
  weight.resize(atom->nlocal + 1);
  for (int i = 0; i < atom->nlocal; i++) weight[i] = memo[i][weight_column];
  return weight.data();
}

/* The share of each member of a clump in the volume of the union. Once for every number of atoms: clumps are rigid. */
void FixHydroVans::count_overlaps()
{
  if (weights_of == atom->natoms) return;
  weights_of = atom->natoms;
  struct Member {
    double molecule, tag, x[3], a;
  };
  std::vector<Member> mine;
  for (int i = 0; i < atom->nlocal; i++) {
    memo[i][weight_column] = 1.0;
    if (atom->molecule[i] > 0 && (atom->mask[i] & average_bit) && atom->radius[i] > 0.0)
      mine.push_back(
          {(double) atom->molecule[i], (double) atom->tag[i], {atom->x[i][0], atom->x[i][1], atom->x[i][2]}, atom->radius[i]});
  }
  const int doubles = sizeof(Member) / sizeof(double);
  int count = (int) mine.size() * doubles;
  std::vector<int> counts(comm->nprocs), starts(comm->nprocs, 0);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int p = 1; p < comm->nprocs; p++) starts[p] = starts[p - 1] + counts[p - 1];
  std::vector<Member> all((starts.back() + counts.back()) / doubles);
  MPI_Allgatherv(mine.data(), count, MPI_DOUBLE, all.data(), counts.data(), starts.data(), MPI_DOUBLE, world);
  std::sort(all.begin(), all.end(), [](const Member &p, const Member &q) {
    return p.molecule != q.molecule ? p.molecule < q.molecule : p.tag < q.tag;
  });
  std::map<double, double> share;    // by atom ID
  std::vector<double> x, a;
  for (size_t begin = 0, end; begin < all.size(); begin = end) {
    for (end = begin; end < all.size() && all[end].molecule == all[begin].molecule; end++) {}
    const size_t n = end - begin;
    x.resize(3 * n);
    a.resize(n);
    for (size_t k = 0; k < n; k++) {
      double r[3];
      for (int d = 0; d < 3; d++) r[d] = all[begin + k].x[d] - all[begin].x[d];
      Compat::minimum_image(domain, r);
      memcpy(&x[3 * k], r, sizeof(r));
      a[k] = all[begin + k].a;
    }
    for (size_t k = 0; k < n; k++) share[all[begin + k].tag] = sd_vans_union_share((int) n, x.data(), a.data(), (int) k);
  }
  for (int i = 0; i < atom->nlocal; i++) {
    const auto at = share.find((double) atom->tag[i]);
    if (at != share.end()) memo[i][weight_column] = at->second;
  }
}

/* ---- time ---------------------------------------------------------------------------------------------------------------- */

void FixHydroVans::setup(int vflag)
{
  if (has_grains() && set.couple != VansSettings::NONE && !stream->averaged) {
    average();
    stream->profile_changed();
    if (set.couple == VansSettings::TWO) {
      // A bed up to the surface, or a mesh that misses most of the grains, is a mistake in the mesh and not a state of the run.
      const int top = stream->ncell() - 2;
      if (stream->phi()[top] > 0.5 * set.phi_max)
        fail(lmp,
             COMMAND + ": keyword mesh: the bed reaches the surface of the water: phi = " + text(stream->phi()[top]) +
                 " in the slice below z = " + text(set.z_ref + stream->mesh.edge[top + 1]) +
                 "; the mesh must hold bed and flow depth");
      select(average_bit);
      double volume[2] = {0, 0}, all[2];
      for (int i = 0; i < atom->nlocal; i++) {
        if (!take[i]) continue;
        const double V = atom->radius[i] * atom->radius[i] * atom->radius[i];
        const int p = sd_vans_slice_of(&stream->mesh, atom->x[i][2]);
        volume[0] += V;
        if (p < 0 || p >= stream->ncell()) volume[1] += V;
      }
      MPI_Allreduce(volume, all, 2, MPI_DOUBLE, MPI_SUM, world);
      if (all[1] > 0.5 * all[0])
        fail(lmp,
             COMMAND + ": keyword mesh: from z = " + text(set.z_ref) + " to " +
                 text(set.z_ref + stream->mesh.edge[stream->ncell()]) + " it misses " + text(100 * all[1] / all[0]) +
                 " % of the grains");
    }
  }
  if (eddy_column >= 0 && renewals == 0.0) renew_fluctuations(0.0, true);
  post_force(vflag);
}

void FixHydroVans::post_force(int /*vflag*/)
{
  const bool stepping =
      update->ntimestep != last_step && last_step >= 0 && update->whichflag == 1 && update->ntimestep > update->firststep;
  const bool repeat = update->ntimestep == last_step;    // a run that begins where another ended: the force of that step stands
  if (stepping) elapsed += update->dt;
  last_step = update->ntimestep;
  summed_step = -1;
  for (double &value : local) value = 0.0;
  if (!has_grains()) return;

  const int n = atom->nlocal;
  F.resize(3 * (size_t) n + 3);
  drag_x.resize(n + 1);
  select(groupbit);
  if (n > 0)
    local[4] = sd_vans_forces(&stream->mesh, &stream->law, stream->U.data(), stream->hindrance.data(), n, atom->x[0],
                              atom->v[0], atom->radius, fluctuations(), take.data(), F.data(), drag_x.data());
  double **f = atom->f;
  double check = 0.0;
  for (int i = 0; i < n; i++) {
    double *out = array_atom[i], *row = memo[i], *Fi = &F[3 * (size_t) i];
    if (!take[i]) {
      out[0] = out[1] = out[2] = row[SOLVED] = 0.0;
      if (drag_column >= 0) row[drag_column + DRAG] = 0.0;
      continue;
    }
    double drag = drag_x[i];
    if (drag_column >= 0) {
      Fi[0] += row[drag_column + SHEAR];
      drag += row[drag_column + SHEAR];
    }
    if (repeat && left_as_is(i)) {
      memcpy(Fi, out, 3 * sizeof(double));
      if (drag_column >= 0) drag = row[drag_column + DRAG];
    }
    row[SOLVED] = 1.0;
    if (drag_column >= 0) {
      // Velocity Verlet gives half of a step's force to the time before it, half to the time after.
      if (stepping) row[drag_column + IMPULSE] += 0.5 * update->dt * (row[drag_column + DRAG] + drag);
      row[drag_column + DRAG] = drag;
    }
    for (int d = 0; d < 3; d++) {
      out[d] = Fi[d];
      f[i][d] += Fi[d];
      local[d] += Fi[d];
    }
    local[3] += drag;
    check += Fi[0] + Fi[1] + Fi[2];
  }
  if (!std::isfinite(check))
    for (int i = 0; i < n; i++)
      for (int d = 0; d < 3; d++)
        if (take[i] && !std::isfinite(array_atom[i][d]))
          error->one(FLERR,
                     COMMAND + ": the force on atom " + std::to_string(atom->tag[i]) +
                         " is not finite: its position, velocity or radius is not");
}

void FixHydroVans::end_of_step()
{
  if (set.dpdx.is_variable() || set.u_top.is_variable()) {
    modify->clearstep_compute();
    stream->fluid.dpdx = set.dpdx.evaluate(lmp);
    stream->fluid.u_top = set.u_top.evaluate(lmp);
    modify->addstep_compute(update->ntimestep + nevery);
  }
  const double T = elapsed;
  if (set.couple == VansSettings::TWO || set.couple == VansSettings::ONE) average();
  if (set.couple == VansSettings::ONE) stream->profile_changed();
  if (set.couple == VansSettings::TWO || set.couple == VansSettings::FLUID) couple();
  elapsed = 0.0;
  if (eddy_column >= 0) renew_fluctuations(T, false);
  if (!told_outside && has_grains()) {
    sum_up();
    if (global[4] > 0.0) {
      told_outside = true;
      if (comm->me == 0)
        error->warning(FLERR,
                       COMMAND + ": " + std::to_string((bigint) global[4]) + " grains are outside the mesh; they " +
                           (set.rules == SD_VANS_YADE ? "feel nothing" : "feel the velocity of its end"));
    }
  }
}

/* Sums over grains of all ranks into the stream's averages. */
void FixHydroVans::average()
{
  const size_t N = stream->ncell(), nclass = stream->class_radii.size(), total = N * SD_VANS_NSUM * (1 + nclass);
  if (set.overlap_once) count_overlaps();
  select(average_bit);
  std::vector<double> sums(total + 4, 0.0), all(total + 4);
  work.resize(N + 1);
  const sd_vans_averaging how = {set.point, (int) nclass, stream->class_radii.data()};
  const int n = atom->nlocal;
  if (n > 0) {
    const int odd = sd_vans_average(&stream->mesh, &stream->law, &how, stream->U.data(), stream->hindrance.data(), n,
                                    atom->x[0], atom->v[0], atom->radius, fluctuations(), weights(), take.data(), sums.data(),
                                    nclass ? sums.data() + N * SD_VANS_NSUM : nullptr, work.data());
    if (odd >= 0)
      error->one(FLERR,
                 COMMAND + ": atom " + std::to_string(atom->tag[odd]) + " has radius " + text(atom->radius[odd]) +
                     ", which is no size class; name all of them with class_radii");
  }
  for (int i = 0; i < n; i++)
    if (take[i]) {
      const double a = atom->radius[i];
      sums[total] += 1.0;
      sums[total + 1] += a;
      sums[total + 2] += 4.0 / 3.0 * PI * a * a * a;
      sums[total + 3] += atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]];
    }
  MPI_Allreduce(sums.data(), all.data(), (int) sums.size(), MPI_DOUBLE, MPI_SUM, world);
  if (all[total] > 0.0) {
    mean_radius = all[total + 1] / all[total];
    mean_density = all[total + 3] / all[total + 2];
  }
  if (set.radius == 0.0) stream->fluid.radius = mean_radius;
  const std::vector<double> class_sums(all.begin() + N * SD_VANS_NSUM, all.begin() + total);
  all.resize(N * SD_VANS_NSUM);
  stream->take_averages(area(), all, class_sums);
}

/* What the grains got from the water since the last coupling: those of the group as booked step by step; the others, which
 * a fixed bed is made
 * of, as the law has it now. ratio: time of the water over time T of the grains. */
VansStream::Given FixHydroVans::impulses(double T, double ratio)
{
  const size_t N = stream->ncell();
  const int n = atom->nlocal;
  std::vector<double> mine(N + 2, 0.0), all(N + 2), value(n + 1);
  work.resize(N + 1);
  if (n > 0) {
    take.assign(n, 0);
    for (int i = 0; i < n; i++) {
      double *row = memo[i] + drag_column;
      take[i] = (atom->mask[i] & groupbit) && atom->radius[i] > 0.0;
      // The force of the last coupling's step acted for another half step.
      const double drag = row[IMPULSE] - ((T - 0.5 * update->dt) * row[SHEAR] + 0.5 * update->dt * row[PAST]);
      value[i] = row[FORESEEN] - ratio * drag;
      if (take[i]) mine[N] += row[IMPULSE];
      row[IMPULSE] = 0.0;
    }
    sd_vans_spread(&stream->mesh, set.point, n, atom->x[0], atom->radius, take.data(), value.data(), mine.data(), work.data());
    select(average_bit, true);
    if (std::find(take.begin(), take.end(), 1) != take.end()) {
      sd_vans_forces(&stream->mesh, &stream->law, stream->U.data(), stream->hindrance.data(), n, atom->x[0], atom->v[0],
                     atom->radius, fluctuations(), take.data(), F.data(), drag_x.data());
      for (int i = 0; i < n; i++) {
        value[i] = memo[i][drag_column + FORESEEN] - ratio * T * drag_x[i];
        if (take[i]) mine[N + 1] += T * (drag_x[i] + memo[i][drag_column + SHEAR]);
      }
      sd_vans_spread(&stream->mesh, set.point, n, atom->x[0], atom->radius, take.data(), value.data(), mine.data(),
                     work.data());
    }
  }
  MPI_Allreduce(mine.data(), all.data(), (int) mine.size(), MPI_DOUBLE, MPI_SUM, world);
  VansStream::Given given;
  given.all = ratio * (all[N] + all[N + 1]);
  given.others = ratio * all[N + 1];
  given.back.assign(all.begin(), all.begin() + N);
  return given;
}

void FixHydroVans::couple()
{
  const double T = set.period > 0.0 ? set.period : elapsed;
  if (!(T > 0.0)) return;
  VansStream::Given given;
  if (set.conserve && elapsed > 0.0) given = impulses(elapsed, T / elapsed);
  stream->solve(area(), T, given);
  if (given.back.empty()) return;
  const int n = atom->nlocal;
  if (n == 0) return;
  select(average_bit | groupbit);
  std::vector<double> shear(n), foreseen(n);
  sd_vans_gather(&stream->mesh, set.point, n, atom->x[0], atom->radius, weights(), take.data(), stream->shear_density.data(),
                 shear.data(), work.data());
  sd_vans_gather(&stream->mesh, set.point, n, atom->x[0], atom->radius, weights(), take.data(), stream->foreseen_density.data(),
                 foreseen.data(), work.data());
  for (int i = 0; i < n; i++) {
    memo[i][drag_column + PAST] = memo[i][drag_column + SHEAR];
    memo[i][drag_column + SHEAR] = shear[i];
    memo[i][drag_column + FORESEEN] = foreseen[i];
  }
}

/* Velocity fluctuations: new ones when their time is over. The random numbers depend on seed, atom ID and the number of
 * the renewal. */
void FixHydroVans::renew_fluctuations(double time, bool first)
{
  const bool depth = set.fluctuation == VansSettings::DEPTH;
  const double nu = set.eta / set.rho, bed = stream->bed_elevation();
  bool all = first;
  if (!depth) {
    eddy_age += time;
    if (!first && eddy_age < eddy_period * (1.0 - 1e-9)) return;
    all = true;
    eddy_age = 0.0;
    eddy_period = set.renewal > 0.0 ? set.renewal : stream->depth_over_velocity(bed);
  }
  renewals += 1.0;
  if (!has_grains()) return;
  select(groupbit);
  for (int i = 0; i < atom->nlocal; i++) {
    double *fluctuation = array_atom[i] + 3, *eddy = memo[i] + eddy_column;
    if (!take[i]) {
      fluctuation[0] = fluctuation[1] = fluctuation[2] = 0.0;
      continue;
    }
    eddy[LIFE] -= time;
    if (!all && eddy[LIFE] > 1e-9 * time) continue;
    const int p = sd_vans_slice_of(&stream->mesh, atom->x[i][2]);
    const double height = atom->x[i][2] - set.z_ref - bed, stress = p >= 0 && p < stream->ncell() ? stream->stress[p] : 0.0;
    const double u_star = stress > 0.0 && height > 0.0 ? std::sqrt(stress / set.rho) : 0.0;
    double normal[3];
    sd_vans_normal3(set.seed, (uint64_t) atom->tag[i], (uint64_t) eddy[COUNT], normal);
    eddy[COUNT] += 1.0;
    sd_vans_fluctuation(normal, u_star, set.fluctuation != VansSettings::UNCORRELATED, fluctuation);
    eddy[LIFE] = sd_vans_eddy_life(height, nu, u_star, nevery * update->dt);
  }
}

void FixHydroVans::post_run()
{
  for (int i = 0; i < atom->nlocal; i++) record(i);
}

/* ---- output -------------------------------------------------------------------------------------------------------------- */

void FixHydroVans::sum_up()
{
  if (summed_step == update->ntimestep) return;
  MPI_Allreduce(local, global, 5, MPI_DOUBLE, MPI_SUM, world);
  summed_step = update->ntimestep;
}

double FixHydroVans::compute_vector(int k)
{
  const double A = area();
  switch (k) {
    case FORCE_X:
    case FORCE_Y:
    case FORCE_Z:
      sum_up();
      return global[k - FORCE_X];
    case TOTAL_DRAG:
      sum_up();
      return global[3];
    case OUTSIDE:
      sum_up();
      return global[4];
    case TRANSPORT:
      return stream->transport();
    case FRICTION_VELOCITY:
      return std::sqrt(std::max(stream->largest_stress(), 0.0) / set.rho);
    case LARGEST_STRESS:
      return stream->largest_stress();
    case SHIELDS: {
      const double size = std::sqrt(set.g[0] * set.g[0] + set.g[1] * set.g[1] + set.g[2] * set.g[2]);
      const double scale = (mean_density - set.rho) * size * 2.0 * mean_radius;
      return scale > 0.0 ? stream->largest_stress() / scale : 0.0;
    }
    case BED:
      return stream->bed_elevation();
    case MOMENTUM:
      return stream->momentum(A);
    case TRANSIT:
      return stream->ledger.transit;
    case DRIVING:
      return stream->ledger.driving;
    case BOTTOM:
      return stream->ledger.bottom;
    case WALLS:
      return stream->ledger.walls;
    case SURFACE:
      return stream->ledger.surface;
    case OTHERS:
      return stream->ledger.others;
  }
  return 0.0;
}

double FixHydroVans::compute_array(int n, int k)
{
  const int N = stream->ncell();
  switch (k) {
    case Z:
      return set.z_ref + 0.5 * (stream->mesh.edge[n] + stream->mesh.edge[n + 1]);
    case VELOCITY:
      return stream->U[n + 1];
    case PHI:
    case GRAIN_X:
    case GRAIN_Y:
    case GRAIN_Z:
    case DRAG_PER_GRAIN:
      return stream->grain[(size_t) (k - PHI) * N + n];
    case EXCHANGE:
      return stream->b[n];
    case EDDY_VISCOSITY:
      return stream->nut[n];
    case STRESS:
      return stream->stress[n];
  }
  k -= ARRAY_COLUMNS;
  return k >= 0 && (size_t) k < 5 * stream->class_radii.size() ? stream->class_grain[(size_t) k * N + n] : 0.0;
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
      fail(lmp, what + ": " + std::to_string(narg - 2) + " values, ncell + 1 = " + std::to_string(needed) + " are needed");
    Keywords in(lmp, "fix_modify " + std::string(id), words(narg, arg), 1);
    in.next();
    for (double &value : stream->U) value = in.number();
  } else
    fail(lmp, what + ": '" + arg[1] + "' is none of: file, values");
  stream->profile_changed();
  last_step = -1;    // the forces of the last step do not stand any more
  return narg;
}

/* "velocity" [ncell+1], "phi", "stress" [ncell]; scalars "density", "viscosity", "ncell" is the number of rows of the array. */
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
      (double) (40 + 5 * stream->class_radii.size()) * stream->ncell() * sizeof(double);
}

/* ---- what follows the atoms ------------------------------------------------------------------------------------------------ */

void FixHydroVans::record(int i)
{
  domain->unmap(atom->x[i], atom->image[i], memo[i] + LEFT_X);
  memcpy(memo[i] + LEFT_V, atom->v[i], 3 * sizeof(double));
  memo[i][LEFT_A] = atom->radius ? atom->radius[i] : 0.0;
}

/* Is atom i where, and as fast as, the last run left it? Wrapping into the box and rigid bodies leave rounding. */
bool FixHydroVans::left_as_is(int i) const
{
  double x[3], dx = 0.0, dv = 0.0, v = 0.0;
  domain->unmap(atom->x[i], atom->image[i], x);
  for (int k = 0; k < 3; k++) {
    dx = std::fmax(dx, std::fabs(x[k] - memo[i][LEFT_X + k]));
    dv = std::fmax(dv, std::fabs(atom->v[i][k] - memo[i][LEFT_V + k]));
    v = std::fmax(v, std::fabs(atom->v[i][k]));
  }
  return memo[i][SOLVED] != 0.0 && memo[i][LEFT_A] == atom->radius[i] && dx <= 1e-9 * atom->radius[i] && dv <= 1e-12 * v;
}

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
  record(i);
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
    set_arrays(nlocal);    // other keywords than those of the restart file: nothing of the past fits
}

void FixHydroVans::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  std::vector<double> out = {(double) last_step, elapsed, eddy_age, eddy_period, renewals, mean_radius, mean_density};
  const auto profiles = stream->pack();
  out.insert(out.end(), profiles.begin(), profiles.end());
  const int size = (int) ((out.size() + 1) * sizeof(double));
  const double count = (double) out.size();
  fwrite(&size, sizeof(int), 1, fp);
  fwrite(&count, sizeof(double), 1, fp);
  fwrite(out.data(), sizeof(double), out.size(), fp);
}

void FixHydroVans::restart(char *buf)
{
  double count;
  memcpy(&count, buf, sizeof(double));
  std::vector<double> in((size_t) count);
  memcpy(in.data(), buf + sizeof(double), in.size() * sizeof(double));
  last_step = (bigint) in[0];
  elapsed = in[1];
  eddy_age = in[2];
  eddy_period = in[3];
  renewals = in[4];
  mean_radius = in[5];
  mean_density = in[6];
  stream->unpack(std::vector<double>(in.begin() + 7, in.end()));
}
