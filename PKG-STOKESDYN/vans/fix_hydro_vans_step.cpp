#include "fix_hydro_vans.h"

#include "sd_constants.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static const std::string COMMAND = VansSettings::COMMAND;

/* A bed up to the surface, or a mesh that misses most of the grains, is a mistake in the mesh and
 * not a state of the run. */
void FixHydroVans::check_mesh()
{
  const int N = stream->ncell(), top = N - 2;
  if (stream->phi()[top] > 0.5 * set.phi_max)
    fail(lmp,
         COMMAND + ": keyword mesh: the bed reaches the surface of the water: phi = " +
             text(stream->phi()[top]) + " in the slice below z = " +
             text(set.z_ref + stream->mesh.edge[top + 1]) +
             "; the mesh must hold bed and flow depth");
  select(average_bit);
  double volume[2] = {0, 0}, all[2];
  for (int i = 0; i < atom->nlocal; i++) {
    if (!take[i]) continue;
    const double V = atom->radius[i] * atom->radius[i] * atom->radius[i];
    const int p = sd_vans_slice_of(&stream->mesh, atom->x[i][2]);
    volume[0] += V;
    if (p < 0 || p >= N) volume[1] += V;
  }
  MPI_Allreduce(volume, all, 2, MPI_DOUBLE, MPI_SUM, world);
  if (all[1] > 0.5 * all[0])
    fail(lmp,
         COMMAND + ": keyword mesh: from z = " + text(set.z_ref) + " to " +
             text(set.z_ref + stream->mesh.edge[N]) + " it misses " + text(100 * all[1] / all[0]) +
             " % of the grains");
}

void FixHydroVans::setup(int vflag)
{
  if (set.averages() && !stream->averaged) {
    average();
    stream->profile_changed();
    if (set.couple == VansSettings::TWO) check_mesh();
  }
  if (eddy_column >= 0 && renewals == 0.0) renew_fluctuations(0.0, true);
  post_force(vflag);
}

void FixHydroVans::post_force(int /*vflag*/)
{
  const bool stepping = update->ntimestep != last_step && last_step >= 0 &&
      update->whichflag == 1 && update->ntimestep > update->firststep;
  // A run that begins where another ended: the force of that step stands.
  const bool repeat = update->ntimestep == last_step;
  if (stepping) elapsed += update->dt;
  last_step = update->ntimestep;
  summed_step = -1;
  for (double &value : local) value = 0.0;
  if (!has_grains()) return;

  const int n = atom->nlocal;
  select(groupbit);
  local[4] = forces(grains());
  double **f = atom->f, check = 0.0;
  for (int i = 0; i < n; i++) {
    double *out = array_atom[i], *row = memo[i], *Fi = &F[3 * (size_t) i], drag = drag_x[i];
    sd_vans_account *books = account_column >= 0 ? account(i) : nullptr;
    if (!take[i]) {
      out[0] = out[1] = out[2] = row[SOLVED] = 0.0;
      if (books) books->force = 0.0;
      continue;
    }
    if (books) {
      Fi[0] += books->shear;
      drag += books->shear;
    }
    const double *left = row + LEFT;
    if (repeat && row[SOLVED] != 0.0 && resume.placed(i, left) && resume.moving(i, left)) {
      memcpy(Fi, out, 3 * sizeof(double));
      if (books) drag = books->force;
    }
    row[SOLVED] = 1.0;
    if (books) {
      if (stepping) sd_vans_account_step(books, drag, update->dt);
      books->force = drag;
    }
    for (int d = 0; d < 3; d++) {
      out[d] = Fi[d];
      f[i][d] += Fi[d];
      local[d] += Fi[d];
    }
    local[3] += drag;
    check += Fi[0] + Fi[1] + Fi[2];
  }
  if (!std::isfinite(check)) no_force();
}

void FixHydroVans::no_force()
{
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++)
      if (take[i] && !std::isfinite(array_atom[i][d]))
        fail_one(lmp,
                 COMMAND + ": the force on atom " + std::to_string(atom->tag[i]) +
                     " is not finite: its position, velocity or radius is not, or the stream "
                     "there");
}

void FixHydroVans::read_variables()
{
  if (!set.dpdx.is_variable() && !set.u_top.is_variable()) return;
  modify->clearstep_compute();
  stream->fluid.dpdx = set.dpdx.evaluate(lmp);
  stream->fluid.u_top = set.u_top.evaluate(lmp);
  modify->addstep_compute(update->ntimestep + nevery);
  const auto check = [&](double value, const char *name) {
    if (!std::isfinite(value))
      fail(lmp,
           COMMAND + ": step " + std::to_string(update->ntimestep) + ": keyword " + name +
               text(value) + " is not a finite number");
  };
  check(stream->fluid.dpdx, "pressure_gradient: ");
  check(stream->fluid.u_top, "surface: speed ");
}

void FixHydroVans::end_of_step()
{
  read_variables();
  const double T = elapsed;
  if (set.averages()) average();
  if (set.couple == VansSettings::ONE) stream->profile_changed();
  if (set.solves()) couple();
  elapsed = 0.0;
  if (eddy_column >= 0) renew_fluctuations(T, false);
  if (told_outside || !has_grains()) return;
  sum_up();
  if (!(global[4] > 0.0)) return;
  told_outside = true;
  if (comm->me == 0)
    error->warning(FLERR,
                   COMMAND + ": " + std::to_string((bigint) global[4]) +
                       " grains are outside the mesh; they " +
                       (set.rules == SD_VANS_YADE ? "feel nothing"
                                                  : "feel the velocity of its end"));
}

/* Sums over grains of all ranks into the stream's averages. */
void FixHydroVans::average()
{
  const size_t N = stream->ncell(), nclass = stream->class_radii.size(),
               total = N * SD_VANS_ROWS * (1 + nclass);
  if (set.overlap_once) count_overlaps();
  select(average_bit);
  std::vector<double> sums(total + 4, 0.0), all(total + 4);
  work.resize(N + 1);
  const sd_vans_averaging how = {set.point, (int) nclass, stream->class_radii.data()};
  const sd_vans_grains grains = this->grains();
  const int odd = sd_vans_average(&stream->mesh, &stream->law, &how, stream->U.data(),
                                  stream->hindrance.data(), &grains, sums.data(), work.data());
  if (odd >= 0)
    fail_one(lmp,
             COMMAND + ": atom " + std::to_string(atom->tag[odd]) + " has radius " +
                 text(atom->radius[odd]) +
                 ", which is no size class; name all of them with class_radii");
  for (int i = 0; i < grains.n; i++)
    if (take[i]) {
      const double a = atom->radius[i];
      sums[total] += 1.0;
      sums[total + 1] += a;
      sums[total + 2] += 4.0 / 3.0 * SD_PI * a * a * a;
      sums[total + 3] += atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]];
    }
  MPI_Allreduce(sums.data(), all.data(), (int) sums.size(), MPI_DOUBLE, MPI_SUM, world);
  if (all[total] > 0.0) {
    mean_radius = all[total + 1] / all[total];
    mean_density = all[total + 3] / all[total + 2];
  }
  if (set.radius == 0.0) stream->fluid.radius = mean_radius;
  stream->take_averages(area(), all.data());
}

/* What the grains got from the water since the last coupling: those of the group as booked step by
 * step; the others, which a fixed bed is made of, as the law has it now. ratio: time of the water
 * over time T of the grains. */
VansStream::Given FixHydroVans::impulses(double T, double ratio)
{
  const size_t N = stream->ncell();
  const int n = atom->nlocal;
  std::vector<double> mine(N + 2, 0.0), all(N + 2), rest(n + 1);
  work.resize(N + 1);
  take.assign(n, 0);
  for (int i = 0; i < n; i++) {
    sd_vans_account *books = account(i);
    take[i] = (atom->mask[i] & groupbit) && atom->radius[i] > 0.0;
    rest[i] = sd_vans_account_rest(books, T, update->dt, ratio);
    if (take[i]) mine[N] += books->impulse;
    books->impulse = 0.0;
  }
  sd_vans_grains some = grains();
  sd_vans_spread(&stream->mesh, set.point, &some, rest.data(), mine.data(), work.data());
  select(average_bit, true);
  if (std::find(take.begin(), take.end(), 1) != take.end()) {
    some = grains();
    forces(some);
    for (int i = 0; i < n; i++) {
      rest[i] = account(i)->foreseen - ratio * T * drag_x[i];
      if (take[i]) mine[N + 1] += T * (drag_x[i] + account(i)->shear);
    }
    sd_vans_spread(&stream->mesh, set.point, &some, rest.data(), mine.data(), work.data());
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
  select(average_bit | groupbit);
  const sd_vans_grains all = grains();
  std::vector<double> shear(n + 1), foreseen(n + 1);
  sd_vans_gather(&stream->mesh, set.point, &all, stream->shear_density.data(), shear.data(),
                 work.data());
  sd_vans_gather(&stream->mesh, set.point, &all, stream->foreseen_density.data(), foreseen.data(),
                 work.data());
  for (int i = 0; i < n; i++) {
    sd_vans_account *books = account(i);
    books->past = books->shear;
    books->shear = shear[i];
    books->foreseen = foreseen[i];
  }
}

/* Velocity fluctuations: new ones when their time is over. The random numbers depend on seed, atom
 * ID and the number of the renewal. */
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
  // Yade's longest life is 10 s; a time of 1 is 1 s in units si and cgs.
  const double second = strcmp(update->unit_style, "micro") == 0 ? 1e6
      : strcmp(update->unit_style, "nano") == 0                 ? 1e9
                                                                : 1.0;
  const double longest = stream->longest_eddy(second);
  for (int i = 0; i < atom->nlocal; i++) {
    double *fluctuation = array_atom[i] + 3, *eddy = memo[i] + eddy_column;
    if (!take[i]) {
      fluctuation[0] = fluctuation[1] = fluctuation[2] = 0.0;
      continue;
    }
    eddy[LIFE] -= time;
    if (!all && eddy[LIFE] > 1e-9 * time) continue;
    const int p = sd_vans_slice_of(&stream->mesh, atom->x[i][2]);
    const double height = atom->x[i][2] - set.z_ref - bed,
                 stress = p >= 0 && p < stream->ncell() ? stream->stress[p] : 0.0;
    const double u_star = stress > 0.0 && height > 0.0 ? std::sqrt(stress / set.rho) : 0.0;
    double normal[3];
    sd_vans_normal3(set.seed, (uint64_t) atom->tag[i], (uint64_t) eddy[COUNT], normal);
    eddy[COUNT] += 1.0;
    sd_vans_fluctuation(normal, u_star, set.fluctuation != VansSettings::UNCORRELATED, fluctuation);
    eddy[LIFE] = sd_vans_eddy_life(height, nu, u_star, longest, nevery * update->dt);
  }
}

void FixHydroVans::post_run()
{
  for (int i = 0; i < atom->nlocal; i++) resume.record(i, memo[i] + LEFT);
}
