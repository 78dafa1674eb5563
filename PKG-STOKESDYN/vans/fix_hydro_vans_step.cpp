#include "fix_hydro_vans.h"

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
static const double PI = 3.14159265358979323846;

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
             COMMAND + ": keyword mesh: the bed reaches the surface of the water: phi = " +
                 text(stream->phi()[top]) +
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
                 text(set.z_ref + stream->mesh.edge[stream->ncell()]) + " it misses " +
                 text(100 * all[1] / all[0]) + " % of the grains");
    }
  }
  if (eddy_column >= 0 && renewals == 0.0) renew_fluctuations(0.0, true);
  post_force(vflag);
}

void FixHydroVans::post_force(int /*vflag*/)
{
  const bool stepping = update->ntimestep != last_step && last_step >= 0 &&
      update->whichflag == 1 && update->ntimestep > update->firststep;
  const bool repeat = update->ntimestep ==
      last_step;    // a run that begins where another ended: the force of that step stands
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
    local[4] = sd_vans_forces(&stream->mesh, &stream->law, stream->U.data(),
                              stream->hindrance.data(), n, atom->x[0], atom->v[0], atom->radius,
                              fluctuations(), take.data(), F.data(), drag_x.data());
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
      if (stepping)
        row[drag_column + IMPULSE] += 0.5 * update->dt * (row[drag_column + DRAG] + drag);
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
          fail_one(
              lmp,
              COMMAND + ": the force on atom " + std::to_string(atom->tag[i]) +
                  " is not finite: its position, velocity or radius is not, or the stream there");
}

void FixHydroVans::end_of_step()
{
  if (set.dpdx.is_variable() || set.u_top.is_variable()) {
    modify->clearstep_compute();
    stream->fluid.dpdx = set.dpdx.evaluate(lmp);
    stream->fluid.u_top = set.u_top.evaluate(lmp);
    modify->addstep_compute(update->ntimestep + nevery);
    const std::string where = ": step " + std::to_string(update->ntimestep) + ": keyword ";
    if (!std::isfinite(stream->fluid.dpdx))
      fail(lmp,
           COMMAND + where + "pressure_gradient: " + text(stream->fluid.dpdx) +
               " is not a finite number");
    if (!std::isfinite(stream->fluid.u_top))
      fail(lmp,
           COMMAND + where + "surface: speed " + text(stream->fluid.u_top) +
               " is not a finite number");
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
        error->warning(
            FLERR,
            COMMAND + ": " + std::to_string((bigint) global[4]) +
                " grains are outside the mesh; they " +
                (set.rules == SD_VANS_YADE ? "feel nothing" : "feel the velocity of its end"));
    }
  }
}

/* Sums over grains of all ranks into the stream's averages. */
void FixHydroVans::average()
{
  const size_t N = stream->ncell(), nclass = stream->class_radii.size(),
               total = N * SD_VANS_NSUM * (1 + nclass);
  if (set.overlap_once) count_overlaps();
  select(average_bit);
  std::vector<double> sums(total + 4, 0.0), all(total + 4);
  work.resize(N + 1);
  const sd_vans_averaging how = {set.point, (int) nclass, stream->class_radii.data()};
  const int n = atom->nlocal;
  if (n > 0) {
    const int odd = sd_vans_average(
        &stream->mesh, &stream->law, &how, stream->U.data(), stream->hindrance.data(), n,
        atom->x[0], atom->v[0], atom->radius, fluctuations(), weights(), take.data(), sums.data(),
        nclass ? sums.data() + N * SD_VANS_NSUM : nullptr, work.data());
    if (odd >= 0)
      fail_one(lmp,
               COMMAND + ": atom " + std::to_string(atom->tag[odd]) + " has radius " +
                   text(atom->radius[odd]) +
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
      const double drag =
          row[IMPULSE] - ((T - 0.5 * update->dt) * row[SHEAR] + 0.5 * update->dt * row[PAST]);
      value[i] = row[FORESEEN] - ratio * drag;
      if (take[i]) mine[N] += row[IMPULSE];
      row[IMPULSE] = 0.0;
    }
    sd_vans_spread(&stream->mesh, set.point, n, atom->x[0], atom->radius, take.data(), value.data(),
                   mine.data(), work.data());
    select(average_bit, true);
    if (std::find(take.begin(), take.end(), 1) != take.end()) {
      sd_vans_forces(&stream->mesh, &stream->law, stream->U.data(), stream->hindrance.data(), n,
                     atom->x[0], atom->v[0], atom->radius, fluctuations(), take.data(), F.data(),
                     drag_x.data());
      for (int i = 0; i < n; i++) {
        value[i] = memo[i][drag_column + FORESEEN] - ratio * T * drag_x[i];
        if (take[i]) mine[N + 1] += T * (drag_x[i] + memo[i][drag_column + SHEAR]);
      }
      sd_vans_spread(&stream->mesh, set.point, n, atom->x[0], atom->radius, take.data(),
                     value.data(), mine.data(), work.data());
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
  sd_vans_gather(&stream->mesh, set.point, n, atom->x[0], atom->radius, weights(), take.data(),
                 stream->shear_density.data(), shear.data(), work.data());
  sd_vans_gather(&stream->mesh, set.point, n, atom->x[0], atom->radius, weights(), take.data(),
                 stream->foreseen_density.data(), foreseen.data(), work.data());
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
    const double height = atom->x[i][2] - set.z_ref - bed,
                 stress = p >= 0 && p < stream->ncell() ? stream->stress[p] : 0.0;
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
  return memo[i][SOLVED] != 0.0 && memo[i][LEFT_A] == atom->radius[i] &&
      dx <= 1e-9 * atom->radius[i] && dv <= 1e-12 * v;
}
