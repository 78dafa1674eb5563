#include "fix_hydro_vans.h"

#include "ranks.h"
#include "sd_constants.h"
#include "sd_hash.h"
#include "sd_lattice.h"

#include "atom.h"
#include "domain.h"
#include "region.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
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
    if (take[i] && region)
      take[i] = region->match(atom->x[i][0], atom->x[i][1], atom->x[i][2]) != 0;
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

/* Tells one set of members of clumps from another, in any order and on any ranks: IDs, molecules,
 * radii. */
uint64_t FixHydroVans::members() const
{
  uint64_t mine = 1, all = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & average_bit) || atom->molecule[i] == 0) continue;
    uint64_t radius;
    memcpy(&radius, &atom->radius[i], sizeof(radius));
    const uint64_t tag = sd_hash_mix((uint64_t) atom->tag[i] + SD_HASH_STEP);
    mine += sd_hash_mix(sd_hash_mix(tag ^ (uint64_t) atom->molecule[i]) ^ radius);
  }
  for (uint64_t part : from_all(world, std::vector<uint64_t>(1, mine))) all += part;
  return all;
}

namespace {
struct Member {
  tagint molecule, tag;
  double x[3], a;
};
}    // namespace

/* The share of each of the members [n] of a clump in the volume of their union, by tag. Seen from each
 * the others stand at their nearest image: what overlaps it is near. */
static void add_shares(const Voice &voice, const Domain *domain, const Member *clump, size_t n,
                       std::map<tagint, double> &share)
{
  std::vector<double> x(3 * n), a(n);
  for (size_t k = 0; k < n; k++) {
    for (size_t j = 0; j < n; j++) {
      for (int d = 0; d < 3; d++) x[3 * j + d] = clump[j].x[d] - clump[k].x[d];
      sd_closest_image(domain->h, domain->periodicity, &x[3 * j]);
      a[j] = clump[j].a;
    }
    const double part = sd_vans_union_share((int) n, x.data(), a.data(), (int) k);
    if (part < 0.0)
      voice.fail_one("keyword overlap: out of memory for a clump of " + std::to_string(n) + " members");
    share[clump[k].tag] = part;
  }
}

/* What each member of a clump loses to others. Once for every set of members: clumps are rigid. */
void FixHydroVans::count_overlaps()
{
  const uint64_t now = members();
  if (now == members_counted) return;
  members_counted = now;
  std::vector<Member> mine;
  for (int i = 0; i < atom->nlocal; i++) {
    const double *x = atom->x[i];
    if (memo.has(i)) memo.row(i)[column.lost] = 0.0;
    if (atom->molecule[i] != 0 && (atom->mask[i] & average_bit) && atom->radius[i] > 0.0)
      mine.push_back({atom->molecule[i], atom->tag[i], {x[0], x[1], x[2]}, atom->radius[i]});
  }
  auto all = from_all(world, mine);
  std::sort(all.begin(), all.end(), [](const Member &p, const Member &q) {
    return p.molecule != q.molecule ? p.molecule < q.molecule : p.tag < q.tag;
  });
  std::map<tagint, double> share;
  for (size_t begin = 0, end; begin < all.size(); begin = end) {
    for (end = begin; end < all.size() && all[end].molecule == all[begin].molecule; end++) {}
    add_shares(set.voice, domain, &all[begin], end - begin, share);
  }
  for (int i = 0; i < atom->nlocal; i++) {
    const auto at = share.find(atom->tag[i]);
    if (at != share.end()) memo.writable(i)[column.lost] = 1.0 - at->second;
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
  for (int i = 0; i < grains.n; i++) {
    if (!take[i]) continue;
    const double a = atom->radius[i];
    mine[COUNT] += 1.0;
    mine[RADIUS] += a;
    mine[VOLUME] += (grains.weight ? weight[i] : 1.0) * 4.0 / 3.0 * SD_PI * a * a * a;
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
  if (told_waves || !set.upflow || set.couple != VansSettings::ONE || lowest > 3.0 * mean.radius)
    return;
  told_waves = true;
  set.voice.warn("keyword upflow: in slices of " + text(lowest) + " a bed of grains of diameter " +
                 text(2.0 * mean.radius) +
                 " breaks up into waves and becomes too high: use slices of three diameters");
}

/* What the grains got from the water since the last coupling: those of the group as booked step by
 * step; the others, which a fixed bed is made of, as the law has it now. ratio: time of the
 * water over that of the grains. */
VansStream::Given FixHydroVans::impulses(double ratio)
{
  const size_t N = stream.ncell();
  const int n = atom->nlocal;
  std::vector<double> mine(N + 2, 0.0), all(N + 2), rest(n + 1, 0.0);
  take.assign(n, 0);
  for (int i = 0; i < n; i++) {
    if (!memo.has(i)) continue;
    sd_vans_account *books = account(i);
    take[i] = (atom->mask[i] & groupbit) && atom->radius[i] > 0.0;
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
      rest[i] = account(i)->foreseen - ratio * elapsed * drag_x[i];
      mine[N + 1] += elapsed * (drag_x[i] + account(i)->shear);
    }
    sd_vans_spread(&set.mesh, set.point, &some, rest.data(), mine.data());
  }
  MPI_Allreduce(mine.data(), all.data(), (int) mine.size(), MPI_DOUBLE, MPI_SUM, world);
  VansStream::Given given;
  given.all = ratio * (all[N] + all[N + 1]);
  given.others = ratio * all[N + 1];
  given.back.assign(all.begin(), all.begin() + N);
  return given;
}

void FixHydroVans::couple(double T, double dt)
{
  if (!(T > 0.0)) return;
  VansStream::Given given;
  if (set.conserve && elapsed > 0.0) given = impulses(T / elapsed);
  stream.solve(area(), T, dt, given);
  if (!given.back.empty()) hand_over();
}

void FixHydroVans::feel_pressure()
{
  stream.feel_pressure(set.law.g[0]);
  set.law.dpdx = stream.felt;
}

/* Books what the pressure gradient gives to the grains. A run that begins where another ended has
 * the force of that step. */
void FixHydroVans::press(bool stepping, bool repeat, const Sums &before)
{
  for (int i = 0; set.law.dpdx != 0.0 && i < atom->nlocal; i++) {
    const double a = atom->radius[i], share = set.overlap_once ? weight[i] : 1.0;
    if (take[i]) local.pressure -= share * 4.0 / 3.0 * SD_PI * a * a * a * set.law.dpdx;
  }
  if (repeat) local.pressure = before.pressure;
  local.pressed = before.pressed;
  if (stepping) local.pressed += 0.5 * update->dt * (before.pressure + local.pressure);
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
}

/* To each grain what the solve took from the water for it. */
void FixHydroVans::hand_over()
{
  const int n = atom->nlocal;
  select(average_bit | groupbit);
  const sd_vans_grains all = grains();
  std::vector<double> shear(n + 1), foreseen(n + 1);
  sd_vans_gather(&set.mesh, set.point, &all, stream.shear_density.data(), shear.data());
  sd_vans_gather(&set.mesh, set.point, &all, stream.foreseen_density.data(), foreseen.data());
  for (int i = 0; i < n; i++) {
    if (!take[i] && !memo.has(i)) continue;
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
  if (set.fluctuation == VansSettings::LANGEVIN)
    walk_on(time, first);
  else
    renew_eddies(time, first);
}

/* renew(i, what the grain carries, its fluctuation) for every grain; the others have none. */
template <class Renew> void FixHydroVans::fluctuate(const Renew &renew)
{
  eddies.renewals += 1.0;
  select(groupbit);
  for (int i = 0; i < atom->nlocal; i++)
    if (take[i])
      renew(i, memo.writable(i) + column.eddy, out.writable(i) + FLUCTUATION);
    else if (out.has(i))
      std::fill_n(out.writable(i) + FLUCTUATION, 3, 0.0);
}

void FixHydroVans::renew_eddies(double time, bool first)
{
  const double bed = stream.bed_elevation();
  bool all = first;
  if (set.fluctuation != VansSettings::DEPTH) {
    eddies.age += time;
    if (!first && eddies.age < eddies.period * (1.0 - 1e-9)) return;
    all = true;
    eddies.age = 0.0;
    eddies.period = set.renewal > 0.0
        ? set.renewal
        : sd_vans_depth_over_velocity(&stream.wet, stream.U.data(), bed);
  }
  const std::vector<double> u_star = stream.friction_velocities();
  const sd_vans_walk walk = {
      set.seed,
      set.fluctuation != VansSettings::UNCORRELATED,
      bed,
      u_star.data(),
      sd_vans_longest_life(&stream.wet, &stream.fluid, stream.stress.data()),
      nevery * update->dt};
  fluctuate([&](int i, double *carried, double *fluctuation) {
    sd_vans_eddy *eddy = (sd_vans_eddy *) carried;
    eddy->life -= time;
    if (all || !(eddy->life > 1e-9 * time))
      sd_vans_new_eddy(&set.mesh, set.fluid.eta / set.fluid.rho, &walk, atom->x[i][2],
                       (uint64_t) atom->tag[i], eddy, fluctuation);
  });
}

/* A step of the Langevin walk of every grain, over the time since the last coupling. */
void FixHydroVans::walk_on(double time, bool first)
{
  const std::vector<double> u_star = stream.friction_velocities(),
                            life = stream.lagrangian_times(u_star);
  const sd_vans_langevin walk = {set.seed, stream.bed_elevation(), u_star.data(), life.data(),
                                 first ? HUGE_VAL : time, stream.wet.ncell - 1};
  fluctuate([&](int i, double *carried, double *fluctuation) {
    sd_vans_langevin_step(&set.mesh, &walk, atom->x[i][2], (uint64_t) atom->tag[i],
                          (sd_vans_wander *) carried, fluctuation);
  });
}
