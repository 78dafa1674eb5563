/* Of pair_style sph/artVisc/tensCorr: the middle of a step, from which densities go on. */
#include "pair_sph_artvisc_tenscorr.h"

#include "fix_sph_grains.h"
#include "fix_sph_settings.h"
#include "fix_sph_shift.h"
#include "keywords.h"
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

/* Does particle i, of this rank or a ghost, keep its place whatever its velocity is? */
bool PairSph::stands(int i) const
{
  return !(atom->mask[i] & displaced_bits) && used(atom->type[i]);
}

bool PairSph::has_velocity(int i) const
{
  const double *v = atom->v[i];
  return v[0] != 0.0 || v[1] != 0.0 || v[2] != 0.0;
}

/* [3 n] the velocity with which each particle changes its place. Those of a lid or a belt have a
 * velocity for friction and stand: if the density took them to move, one end of a lid would be a
 * source of fluid and the other a sink. */
const double *PairSph::displacement_rates()
{
  const double *v = Sph::numbers(atom->v);
  displacing.clear();
  for (int i = 0; i < particles.n; i++) {
    if (!stands(i) || !has_velocity(i)) continue;
    if (displacing.empty()) displacing.assign(v, v + 3 * (size_t) particles.n);
    std::fill_n(&displacing[3 * (size_t) i], 3, 0.0);
  }
  return displacing.empty() ? v : displacing.data();
}

/* At the start of a run, before any rate sees the densities that walls have in the input. Velocities are
 * then again those of estimate_velocities(). */
void PairSph::settle_walls()
{
  sd_sph_pack_x(particles.n, Sph::numbers(atom->x), nullptr, nullptr, 0.0, x4.data());
  pressures_of_all();
  wall_particles();
  if (needs_velocity) estimate_velocities();
}

/* Leapfrog: the rate of density of the half step, from positions and velocities at its middle,
 * moves the density by a whole step. At the start of a run the rate is that of the moment, and
 * nothing moves. Leaves the near pairs in the list for the force. */
void PairSph::density_step()
{
  const int n = particles.n, nlocal = atom->nlocal;
  const double dt = update->setupflag ? 0.0 : update->dt;
  const double *v = displacement_rates(), *du = shift();
  // The distance of two particles changes by less than dt times the largest speed in half a step.
  double margin = 0.0;
  if (dt > 0.0) {
    margin = dt * (sd_sph_fastest(n, v) + (du ? sd_sph_fastest(n, du) : 0.0)) * (1.0 + 1e-9);
    sd_sph_pack_x(n, Sph::numbers(atom->x), v, du, -0.5 * dt, x4.data());
  } else
    sd_sph_pack_x(n, Sph::numbers(atom->x), nullptr, nullptr, 0.0, x4.data());
  sd_sph_pack_v(n, grains ? grains->mixture(v) : v, atom->rho, v4.data());

  if (shared)
    sum_rates(margin);
  else
    sum_middle(margin);

  for (int i = 0; i < nlocal; i++)
    atom->drho[i] = atom->mask[i] & continuity->groupbit ? rate[i] : 0.0;
  if (dt == 0.0) return;
  for (int i = 0; i < nlocal; i++)
    if (atom->mask[i] & leapfrog_bits) atom->rho[i] += dt * atom->drho[i];
  forward(atom->rho, 1);
}

/* The rates alone. */
void PairSph::sum_rates(double margin)
{
  size_t entries = SD_SPH_LANES;
  for (int k = 0; k < raw.n; k++) entries += raw.count[raw.first[k]];
  near.resize(atom->nmax, entries);
  rate.assign(particles.n + 1, 0.0);
  const sd_sph_near found = near.room(margin);
  sd_sph_rates(&model, &raw, &particles, rate.data(), &found);
  pairs = {raw.n, ~0, raw.first, near.own.data(), near.neighbor.data()};
  reverse(rate.data(), 1);
  if (grains) grains->divide_rates(nullptr, nullptr, rate.data());
}

/* All sums that delta, shift and correction ask for, of both particles of each pair: a list both
 * ways is made of LAMMPS's when that is new. */
void PairSph::sum_middle(double margin)
{
  const int nlocal = atom->nlocal, columns = sd_sph_sum_columns(sd_sph_level_of(&model));
  const bool outdated =
      neighbor->ago == 0 || update->setupflag || around_of != neighbor->lastcall;
  if (outdated) around.resize(atom->nmax, sd_sph_both_size(&raw, nlocal));
  sd_sph_both all = around.both(nlocal);
  if (outdated) sd_sph_both_ways(&raw, particles.n, around.pool.data(), &all);
  around_of = neighbor->lastcall;
  near.resize(atom->nmax, around.pool.size());
  sd_sph_pack_volumes(&model, &particles, atom->rho, x4.data());
  sums.resize(columns * (size_t) nlocal);
  const sd_sph_near found = near.room(margin);
  sd_sph_middle(&model, &all, &particles, sums.data(), &found);
  pairs = {raw.n, ~0, raw.first, near.own.data(), near.neighbor.data()};
  close_sums();
}

/* The rates, and what the force and the next step need of the middle. */
void PairSph::close_sums()
{
  const size_t n = particles.n, rows = n + 1;
  rate.assign(rows, 0.0);
  slope4.resize(4 * rows);
  du4.resize(shifts ? 4 * rows : 0);
  B8.resize(corrects || pliant ? 8 * rows : 0);
  kick.resize(corrects || pliant ? 3 * (size_t) atom->nlocal + 1 : 0);
  const double least = update->setupflag ? 0.6 : 0.5;
  const sd_sph_closing closing = {atom->nlocal, sums.data(), atom->mask,    own_vest_bits, full,      least,
                                  whole,        rate.data(), slope4.data(), du4.data(),    B8.data(), kick.data()};
  const int stops = sd_sph_close(&model, &particles, &closing);
  if (full && !corrects) {
    if (update->setupflag) look_at_surface(stops);
  } else if (stops >= 0)
    voice.at_step().fail_one("keyword correction: atom " + std::to_string(atom->tag[stops]) +
                             " is at a free surface: the smallest eigenvalue of the matrix of its neighbours "
                             "is below " +
                             text(least) + "; use shift yes where there is a free surface");
  if (state && update->setupflag && resumes()) state->put_back(du4.data(), B8.data(), kick.data());
  std::vector<RowsToSend> made = {{slope4.data(), 4}};
  if (shifts) made.push_back({du4.data(), 4});
  if (!B8.empty()) made.push_back({B8.data(), 8});
  forward(made);
  for (const RowsToSend &of : made) std::fill_n(of.row((int) n), of.width, 0.0);
  if (state) state->keep_rows((int) n, du4.data(), B8.data(), kick.data());

  particles.slope = slope4.data();
  particles.du = du4.data();
  particles.B = B8.data();
  const sd_sph_both close = near.both(atom->nlocal);
  if (grains) grains->divide_rates(slope4.data(), shifts ? du4.data() : nullptr, rate.data());
  sd_sph_diffusion(&model, &close, &particles, rate.data());
}

/* Of now, by all fixes that make them; x4 then has the places of now. */
void PairSph::find_densities()
{
  if (leapfrog) density_step();
  sd_sph_pack_x(particles.n, Sph::numbers(atom->x), nullptr, nullptr, 0.0, x4.data());
  if (summation) sum_densities(summation->groupbit, false);
  if (filter && !update->setupflag && update->ntimestep % filter->every == 0)
    sum_densities(filter->groupbit, true);
}

const double *PairSph::shift() const
{
  return state ? state->du() : nullptr;
}

/* Densities of a group from the sums over neighbours, or filtered by them. */
void PairSph::sum_densities(int bit, bool shepard)
{
  weights.resize(4 * (size_t) (particles.n + 1));
  sd_sph_pack_masses(&model, &particles, atom->rho, weights.data());
  sums.assign(4 * (size_t) (particles.n + 1), 0.0);
  sd_sph_weigh(&model, &pairs, &particles, weights.data(), sums.data());
  reverse(sums.data(), 4);
  const sd_sph_densities how = {atom->nlocal, bit, shepard, atom->mask, sums.data()};
  sd_sph_sum_densities(&model, &particles, &how, atom->rho);
  forward(atom->rho, 1);
}
