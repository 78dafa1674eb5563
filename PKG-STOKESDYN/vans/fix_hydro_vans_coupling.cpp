#include "fix_hydro_vans.h"

#include "places.h"
#include "ranks.h"

#include "atom.h"
#include "region.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <map>

using namespace LAMMPS_NS;
using namespace StokesDyn;

/* ---- which atoms ----------------------------------------------------------------------------- */

void FixHydroVans::select(int bit, bool not_in_group)
{
  const int n = atom->nlocal;
  take.resize(n);
  if (region) region->prematch();
  for (int i = 0; i < n; i++) {
    if ((atom->mask[i] & bit) && !(atom->radius[i] >= 0.0 && std::isfinite(atom->radius[i])))
      set.voice.fail_one("atom " + std::to_string(atom->tag[i]) + " has the radius " +
                         text(atom->radius[i]) + "; it must be a number > 0, or 0 for what is no grain");
    take[i] = (atom->mask[i] & bit) && atom->radius[i] > 0.0 &&
        !(not_in_group && (atom->mask[i] & groupbit));
    if (!take[i] || !region) continue;
    double x[3];
    image_in_box(domain, atom->x[i], x);
    take[i] = region->match(x[0], x[1], x[2]) != 0;
  }
}

/* The atoms of this rank, those that `take` says. */
sd_vans_grains FixHydroVans::grains()
{
  const int n = atom->nlocal;
  sd_vans_grains all = {n, n ? atom->x[0] : nullptr, n ? atom->v[0] : nullptr, atom->radius,
                        nullptr, nullptr, take.data(), nullptr};
  if (set.fluctuates()) {
    u.resize(3 * (size_t) n + 3);
    for (int i = 0; i < n; i++) std::copy_n(out[i] + FLUCTUATION, 3, &u[3 * (size_t) i]);
    all.fluctuation = u.data();
  }
  if (set.overlap_once) {
    weight.resize(n + 1);
    for (int i = 0; i < n; i++) weight[i] = 1.0 - memo[i][column.lost];
    all.weight = weight.data();
  }
  return all;
}

/* Of those atoms into F and drag_x; how many are outside the mesh. */
int FixHydroVans::forces(const sd_vans_grains &all, bool accelerated)
{
  sd_vans_grains grains = all;
  if (set.law.added_mass > 0.0 && accelerated) grains.acceleration = acceleration.data();
  F.resize(3 * (size_t) grains.n + 3);
  drag_x.resize(grains.n + 1);
  const sd_vans_ambient ambient = stream.ambient();
  return sd_vans_forces(&ambient, &grains, F.data(), drag_x.data());
}

/* What each member of a clump loses to others */
void FixHydroVans::count_overlaps()
{
  if (!overlaps.are_new(average_bit)) return;
  const std::map<tagint, double> lost = overlaps.lost(average_bit);
  for (int i = 0; i < atom->nlocal; i++) {
    if (memo.has(i)) memo.row(i)[column.lost] = 0.0;
    const auto at = lost.find(atom->tag[i]);
    if (at != lost.end()) memo.writable(i)[column.lost] = at->second;
  }
}

/* ---- averages and solve ---------------------------------------------------------------------- */

/* Sums over grains of all ranks into the stream's averages. */
void FixHydroVans::average()
{
  const size_t N = stream.ncell(), nclass = stream.class_radii.size(),
               forces = N * SD_VANS_ROWS * (1 + nclass), total = forces + 2 * N;
  if (set.overlap_once) count_overlaps();
  select(average_bit);
  enum { COUNT, RADIUS, VOLUME, MASS, MEANS };
  std::vector<double> sums(total + MEANS, 0.0), all(total + MEANS);
  work.resize(3 * N);
  const sd_vans_averaging how = {set.point, (int) nclass, stream.class_radii.data(),
                                 &sums[forces], stream.bins()};
  const sd_vans_grains grains = this->grains();
  const sd_vans_ambient ambient = stream.ambient();
  const int odd = sd_vans_average(&ambient, &how, &grains, sums.data(), work.data());
  if (odd >= 0)
    set.voice.fail_one("atom " + std::to_string(atom->tag[odd]) + " has radius " +
                       text(atom->radius[odd]) +
                       ", which is no size class; give all radii with class_radii");
  double *mine = &sums[total], *means = &all[total];
  mine[VOLUME] = sd_vans_volume_of_grains(&grains);
  for (int i = 0; i < grains.n; i++) {
    if (!take[i]) continue;
    mine[COUNT] += 1.0;
    mine[RADIUS] += atom->radius[i];
    mine[MASS] += atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]];
  }
  MPI_Allreduce(sums.data(), all.data(), (int) sums.size(), MPI_DOUBLE, MPI_SUM, world);
  if (means[COUNT] > 0.0) {
    mean.radius = means[RADIUS] / means[COUNT];
    mean.density = means[MASS] / means[VOLUME];
  }
  if (set.radius == 0.0) stream.fluid.radius = mean.radius;
  stream.take_averages(area(), all.data(), &all[forces]);
}

/* In slices finer than its grains a bed that water holds up is unstable: a slice with a few grains
 * more than its neighbours is lifted, and catches up with those above. */
void FixHydroVans::tell_waves()
{
  double lowest = HUGE_VAL;
  for (int n = 0; n < stream.ncell(); n++)
    lowest = std::min(lowest, sd_vans_height(&set.mesh, n));
  if (!set.upflow || set.couple != VansSettings::ONE || lowest > 3.0 * mean.radius) return;
  stream.told.warn(VansTold::WAVES,
                   "keyword upflow: in slices of " + text(lowest) + " a bed of grains of diameter " +
                       text(2.0 * mean.radius) +
                       " breaks up into waves and becomes too high: use slices of three diameters");
}

/* What the last solve, over the time T, has for atom i */
double FixHydroVans::due(int i, double T, double ratio)
{
  return sd_vans_account_due(account(i), T, (atom->mask[i] & groupbit) ? 0.5 * ratio * update->dt : 0.0);
}

/* What the grains got from the water since the last coupling: those of the group as booked step by
 * step; the others, which a fixed bed is made of, as the law has it now. ratio: time of the
 * water over that of the grains. */
VansStream::Given FixHydroVans::impulses(double ratio)
{
  const size_t N = stream.ncell();
  const int n = atom->nlocal;
  std::vector<double> mine(N + 3, 0.0), all(N + 3), rest(n + 1, 0.0);
  take.assign(n, 0);
  for (int i = 0; i < n; i++) {
    if (!memo.has(i)) continue;
    sd_vans_account *books = account(i);
    take[i] = (atom->mask[i] & groupbit) && atom->radius[i] > 0.0;
    mine[N + 2] += due(i, ratio * elapsed, ratio);
    rest[i] = sd_vans_account_rest(books, elapsed, update->dt, ratio);
    if (take[i]) mine[N] += books->impulse;
    books->impulse = 0.0;
  }
  sd_vans_grains some = grains();
  sd_vans_spread(&set.mesh, set.point, &some, rest.data(), mine.data());
  select(average_bit, true);
  if (std::find(take.begin(), take.end(), 1) != take.end()) {
    some = grains();
    forces(some);
    for (int i = 0; i < n; i++) {
      if (!take[i]) continue;
      double impulse;
      rest[i] = sd_vans_account_held(account(i), drag_x[i], elapsed, ratio, &impulse);
      mine[N + 1] += impulse;
    }
    sd_vans_spread(&set.mesh, set.point, &some, rest.data(), mine.data());
  }
  MPI_Allreduce(mine.data(), all.data(), (int) mine.size(), MPI_DOUBLE, MPI_SUM, world);
  VansStream::Given given;
  given.all = ratio * (all[N] + all[N + 1]);
  given.others = ratio * all[N + 1];
  if (std::isfinite(handed)) given.lost = handed - all[N + 2];
  given.back.assign(all.begin(), all.begin() + N);
  return given;
}

void FixHydroVans::couple(double T, double dt)
{
  if (!(T > 0.0)) return;
  VansStream::Given given;
  if (set.conserve && elapsed > 0.0) given = impulses(T / elapsed);
  stream.solve(area(), T, dt, given);
  if (!given.back.empty()) hand_over(T, T / elapsed);
}

void FixHydroVans::feel_pressure()
{
  stream.feel_pressure(set.law.g[0]);
  set.law.dpdx = stream.felt;
}

/* Books what the pressure gradient gives to the grains. */
void FixHydroVans::press(Moment moment, const Sums &before)
{
  if (set.law.dpdx != 0.0) {
    const sd_vans_grains all = grains();
    local.pressure -= sd_vans_volume_of_grains(&all) * set.law.dpdx;
  }
  if (moment == AGAIN) local.pressure = before.pressure;
  local.pressed = before.pressed;
  if (moment == STEP) local.pressed += 0.5 * update->dt * (before.pressure + local.pressure);
}

/* The next interval begins. */
void FixHydroVans::end_interval()
{
  const double T = elapsed;
  elapsed = 0.0;
  if (set.fluctuates()) renew_fluctuations(T, false);
  feel_pressure();
}

/* What a user asks for is a coupling if it moves the water on as far as one would; otherwise the
 * water moves on alone. */
void FixHydroVans::solve_on_demand(double T, double dt)
{
  const double due = set.period > 0.0 ? set.period : elapsed;
  if (set.couple == VansSettings::TWO && elapsed > 0.0 && std::fabs(T - due) <= 1e-9 * due) {
    couple(T, dt);
    end_interval();
    return;
  }
  VansStream::Given given;
  given.held = true;
  stream.solve(area(), T, dt, given);
  stream.rest();
}

/* To each grain what the solve took from the water for it: to those of the averages alone, since the solve knew of
 * no others. Of these all that they feel goes back to the water. */
void FixHydroVans::hand_over(double T, double ratio)
{
  const int n = atom->nlocal;
  select(average_bit);
  const sd_vans_grains all = grains();
  std::vector<double> shear(n + 1), foreseen(n + 1);
  sd_vans_gather(&set.mesh, set.point, &all, stream.shear_density.data(), shear.data());
  sd_vans_gather(&set.mesh, set.point, &all, stream.foreseen_density.data(), foreseen.data());
  double mine = 0.0;
  for (int i = 0; i < n; i++) {
    if (!take[i] && !memo.has(i)) continue;
    sd_vans_account *books = account(i);
    books->past = books->shear;
    books->shear = shear[i];
    books->foreseen = foreseen[i];
    mine += due(i, T, ratio);
  }
  MPI_Allreduce(&mine, &handed, 1, MPI_DOUBLE, MPI_SUM, world);
}

/* time: since the last call */
void FixHydroVans::renew_fluctuations(double time, bool first)
{
  const VansFluctuations::Renew renew = fluctuations.after(time, nevery * update->dt, first);
  if (!renew) return;
  select(groupbit);
  for (int i = 0; i < atom->nlocal; i++)
    if (take[i])
      renew(atom->x[i][2], (uint64_t) atom->tag[i], memo.writable(i) + column.eddy, out.writable(i) + FLUCTUATION);
    else if (out.has(i))
      std::fill_n(out.writable(i) + FLUCTUATION, 3, 0.0);
}
