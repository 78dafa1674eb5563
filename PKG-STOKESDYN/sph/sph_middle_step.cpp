#include "sph_middle.h"

#include "fix_sph_grains.h"
#include "fix_sph_settings.h"
#include "fix_sph_shift.h"
#include "ranks.h"
#include "sd_sph_density.h"
#include "sd_sph_order.h"
#include "sd_sph_step.h"

#include "atom.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace StokesDyn;

void SphMiddle::begin(const SphScheme &of)
{
  scheme = of;
  around_of = -1;
}

void SphMiddle::find_densities()
{
  if (roles.is_leapfrog()) density_step();
  rows.pack_places();
  if (roles.summation) sum_densities(roles.summation->groupbit, false);
  if (roles.filter && !update->setupflag && update->ntimestep % roles.filter->every == 0)
    sum_densities(roles.filter->groupbit, true);
}

/* [3 n] the velocity with which each particle changes its place. Those of a lid or a belt have a
 * velocity for friction and stand: if the density took them to move, one end of a lid would be a
 * source of fluid and the other a sink. */
const double *SphMiddle::displacement_rates()
{
  const double *v = Sph::numbers(atom->v);
  displacing.clear();
  for (int i = 0; i < rows.particles.n; i++) {
    if (!roles.stands(i) || !roles.has_velocity(i)) continue;
    if (displacing.empty()) displacing.assign(v, v + 3 * (size_t) rows.particles.n);
    std::fill_n(&displacing[3 * (size_t) i], 3, 0.0);
  }
  return displacing.empty() ? v : displacing.data();
}

/* Leapfrog: the rate of density of the half step, from positions and velocities at its middle,
 * moves the density by a whole step. At the start of a run the rate is that of the moment, and
 * nothing moves. Leaves the near pairs in the list for the force. */
void SphMiddle::density_step()
{
  const int n = rows.particles.n, nlocal = atom->nlocal;
  const double dt = update->setupflag ? 0.0 : update->dt;
  const double *v = displacement_rates(), *du = roles.shift();
  // The distance of two particles changes by less than dt times the largest speed in half a step.
  double margin = 0.0;
  if (dt > 0.0) {
    margin = dt * (sd_sph_fastest(n, v) + (du ? sd_sph_fastest(n, du) : 0.0)) * (1.0 + 1e-9);
    sd_sph_pack_x(n, Sph::numbers(atom->x), v, du, -0.5 * dt, rows.x4.data());
  } else
    rows.pack_places();
  sd_sph_pack_v(n, roles.grains ? roles.grains->mixture(v) : v, atom->rho, rows.v4.data());

  if (rows.shared)
    sum_rates(margin);
  else
    sum_middle(margin);

  for (int i = 0; i < nlocal; i++)
    atom->drho[i] = atom->mask[i] & roles.continuity->groupbit ? rate[i] : 0.0;
  if (dt == 0.0) return;
  for (int i = 0; i < nlocal; i++)
    if (roles.advances_density(i)) atom->rho[i] += dt * atom->drho[i];
  ghosts.forward(atom->rho, 1);
}

/* The rates alone. */
void SphMiddle::sum_rates(double margin)
{
  size_t entries = SD_SPH_LANES;
  for (int k = 0; k < rows.raw.n; k++) entries += rows.raw.count[rows.raw.first[k]];
  rows.near.resize(atom->nmax, entries);
  rate.assign(rows.particles.n + 1, 0.0);
  const sd_sph_near found = rows.near.room(margin);
  sd_sph_rates(&rows.model, &rows.raw, &rows.particles, rate.data(), &found);
  rows.pairs = {rows.raw.n, ~0, rows.raw.first, rows.near.own.data(), rows.near.neighbor.data()};
  ghosts.reverse(rate.data(), 1);
  if (roles.grains) roles.grains->divide_rates(nullptr, nullptr, rate.data());
}

/* All sums that delta, shift and correction ask for, of both particles of each pair: a list both
 * ways is made of LAMMPS's when that is new. */
void SphMiddle::sum_middle(double margin)
{
  const int nlocal = atom->nlocal, columns = sd_sph_sum_columns(sd_sph_level_of(&rows.model));
  const bool outdated =
      neighbor->ago == 0 || update->setupflag || around_of != neighbor->lastcall;
  if (outdated) around.resize(atom->nmax, sd_sph_both_size(&rows.raw, nlocal));
  sd_sph_both all = around.both(nlocal);
  if (outdated) sd_sph_both_ways(&rows.raw, rows.particles.n, around.pool.data(), &all);
  around_of = neighbor->lastcall;
  rows.near.resize(atom->nmax, around.pool.size());
  sd_sph_pack_volumes(&rows.model, &rows.particles, atom->rho, rows.x4.data());
  rows.sums.resize(columns * (size_t) nlocal);
  const sd_sph_near found = rows.near.room(margin);
  sd_sph_middle(&rows.model, &all, &rows.particles, rows.sums.data(), &found);
  rows.pairs = {rows.raw.n, ~0, rows.raw.first, rows.near.own.data(), rows.near.neighbor.data()};
  close_sums();
}

/* The rates, and what the force and the next step need of the middle. */
void SphMiddle::close_sums()
{
  const size_t n = rows.particles.n, all = n + 1;
  rate.assign(all, 0.0);
  slope4.resize(4 * all);
  du4.resize(settings.shifts ? 4 * all : 0);
  B8.resize(settings.corrects || settings.pliant ? 8 * all : 0);
  kick.resize(settings.corrects || settings.pliant ? 3 * (size_t) atom->nlocal + 1 : 0);
  const double least = update->setupflag ? 0.6 : 0.5;
  const sd_sph_closing closing = {atom->nlocal, rows.sums.data(), atom->mask,    roles.with_own_vest(),
                                  scheme.full,  least,            scheme.whole,  rate.data(),
                                  slope4.data(), du4.data(),      B8.data(),     kick.data()};
  const int stops = sd_sph_close(&rows.model, &rows.particles, &closing);
  if (scheme.full && !settings.corrects) {
    if (update->setupflag) look_at_surface(stops);
  } else if (stops >= 0)
    voice.at_step().fail_one("keyword correction: atom " + std::to_string(atom->tag[stops]) +
                             " is at a free surface: the smallest eigenvalue of the matrix of its neighbours "
                             "is below " + text(least) + "; use shift yes where there is a free surface");
  if (roles.state && update->setupflag && roles.resumes())
    roles.state->put_back(du4.data(), B8.data(), kick.data());
  std::vector<RowsToSend> made = {{slope4.data(), 4}};
  if (settings.shifts) made.push_back({du4.data(), 4});
  if (!B8.empty()) made.push_back({B8.data(), 8});
  ghosts.forward(made);
  for (const RowsToSend &of : made) std::fill_n(of.row((int) n), of.width, 0.0);
  if (roles.state) roles.state->keep_rows((int) n, du4.data(), B8.data(), kick.data());

  rows.particles.slope = slope4.data();
  rows.particles.du = du4.data();
  rows.particles.B = B8.data();
  const sd_sph_both close = rows.near.both(atom->nlocal);
  if (roles.grains) roles.grains->divide_rates(slope4.data(), settings.shifts ? du4.data() : nullptr, rate.data());
  sd_sph_diffusion(&rows.model, &close, &rows.particles, rate.data());
}

/* At a surface that should not be there shift moves particles out of the fluid. found: one of this rank that is
 * at a surface, -1: none. */
void SphMiddle::look_at_surface(int found)
{
  const tagint at_surface = smallest_of_all(world, found < 0 ? MAXTAGINT : atom->tag[found]);
  if (at_surface < MAXTAGINT)
    voice.warn("P0 of fix sph/pressure is " + text(roles.background()) + ", which says with shift that the fluid "
               "fills its vessel, but atom " + std::to_string(at_surface) + " is at a free surface: use P0 = 0");
}

/* Densities of a group from the sums over neighbours, or filtered by them. */
void SphMiddle::sum_densities(int bit, bool shepard)
{
  rows.weights.resize(4 * (size_t) (rows.particles.n + 1));
  sd_sph_pack_masses(&rows.model, &rows.particles, atom->rho, rows.weights.data());
  rows.sums.assign(4 * (size_t) (rows.particles.n + 1), 0.0);
  sd_sph_weigh(&rows.model, &rows.pairs, &rows.particles, rows.weights.data(), rows.sums.data());
  ghosts.reverse(rows.sums.data(), 4);
  const sd_sph_densities how = {atom->nlocal, bit, shepard, atom->mask, rows.sums.data()};
  sd_sph_sum_densities(&rows.model, &rows.particles, &how, atom->rho);
  ghosts.forward(atom->rho, 1);
}

double SphMiddle::bytes() const
{
  double bytes = around.bytes();
  for (const auto *v : {&slope4, &du4, &B8}) bytes += v->capacity() * sizeof(double);
  for (const auto *v : {&rate, &kick, &displacing}) bytes += v->capacity() * sizeof(double);
  return bytes;
}
