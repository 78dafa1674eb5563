/* Of pair_style sph/artVisc/tensCorr: a step. */
#include "pair_sph_artvisc_tenscorr.h"

#include "fix_nve_sph.h"
#include "fix_sph_grains.h"
#include "fix_sph_settings.h"
#include "fix_sph_shift.h"
#include "fix_wall_sph.h"
#include "keywords.h"
#include "sd_sph_density.h"
#include "sd_sph_order.h"
#include "sd_sph_probe.h"
#include "sd_sph_step.h"

#include "atom.h"
#include "force.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static double *rows(double **array)
{
  return array ? array[0] : nullptr;
}

void PairSph::compute(int eflag, int vflag)
{
  require_prepared();
  ev_init(eflag, vflag);
  listed = {atom->nlocal, atom->nghost};
  check_list();
  if (continuity && !moved_box.follow(atom->rho))
    voice.warn("the box has changed since the last run, but the particles have not moved with it: "
               "their densities stay as they are; if these are wrong, use set ... sph/rho");
  look_at_densities(atom->nlocal);
  if (grains) grains->find_fractions();
  prepare();
  if (update->setupflag) {
    look_at_sound();
    look_at_widths();
    look_at_fluids();
    if (wall) look_at_walls();
    if (wall) tell_of_belts();
    if (law != SD_SPH_NEWTON && !implicit) look_at_friction();
  }
  if (needs_velocity) estimate_velocities();
  if (leapfrog && update->setupflag && has_walls()) settle_walls();

  if (leapfrog) density_step();
  sd_sph_pack_x(particles.n, rows(atom->x), nullptr, nullptr, 0.0, x4.data());
  if (summation) sum_densities(summation->groupbit, false);
  if (filter && !update->setupflag && update->ntimestep % filter->every == 0)
    sum_densities(filter->groupbit, true);
  pressures_of_all();
  if (has_walls()) wall_particles();
  forces(continuity && !leapfrog);
  if (update->setupflag && wall) look_at_bodies();

  for (auto *fix : pressures) fix->output(P.data());
  if (continuity) continuity->output(atom->drho);
}

/* For compute pair/local and its like below a hybrid, which ask all styles of it: the forces of this one
 * need more than a pair, so its share is 0. Alone it has no answer (init_style). */
double PairSph::single(int, int, int, int, double, double, double, double &fforce)
{
  fforce = 0.0;
  return 0.0;
}

/* A list that could not be rebuilt in time misses pairs. LAMMPS counts that as a dangerous build
 * and goes on. */
void PairSph::check_list()
{
  if (update->setupflag) {
    dangerous_builds = neighbor->ndanger;
    return;
  }
  if (neighbor->ago != 0 || neighbor->ndanger == dangerous_builds) return;
  dangerous_builds = neighbor->ndanger;
  if (std::max(neighbor->every, neighbor->delay) <= 1) return;
  voice.at_step().fail("particles moved more than half the neighbour skin " + text(neighbor->skin) +
                       " before the neighbour list could be rebuilt; use neigh_modify delay 0 every 1, "
                       "or a larger skin");
}

/* Model, list and particles for the core. */
void PairSph::prepare()
{
  const int n = atom->nlocal + atom->nghost, ntypes = atom->ntypes;
  particles = sd_sph_particles();
  particles.n = n;
  for (auto *array : {&x4, &v4, &f4}) array->resize(4 * (size_t) (n + 1));
  P.resize(n + 1);
  particles.x4 = x4.data();
  particles.v4 = v4.data();
  if (types_are_alike()) {
    model.nclasses = 1;
  } else {
    model.nclasses = ntypes;
    masses.resize(n + 1);
    classes.resize(n + 1);
    for (int i = 0; i < n; i++) {
      masses[i] = Sph::mass(lmp, i);
      // density is that of the water itself; the volume of a particle is that of the mixture
      if (grains) masses[i] /= 1.0 - grains->fractions()[i];
      classes[i] = atom->type[i] - 1;
    }
    masses[n] = 0.0;
    classes[n] = 0;
    // Pairs of types that never meet: the filler row may still look them up.
    for (auto &c : coefficients)
      if (c.inv_h == 0.0) c.inv_h = 1.0;
    particles.m = masses.data();
    particles.cls = classes.data();
  }
  model.pair = coefficients.data();
  raw = {list->inum, NEIGHMASK, list->ilist, list->numneigh, list->firstneigh};
  pairs = raw;
  if (!has_walls() && !state && !sd_sph_of_fluids(&model) && !implicit) return;
  phases.assign(n + 1, 0);
  for (int i = 0; i < n; i++) {
    if (sd_sph_of_fluids(&model))
      for (size_t k = 0; k < pressures.size(); k++)
        if (atom->mask[i] & pressures[k]->groupbit) phases[i] = (int) k;
    const bool still = is_wall(i) ||
        ((state || implicit) && !(atom->mask[i] & own_vest_bits)) || is_held(i);
    if (still) phases[i] = ~phases[i];
  }
  particles.phase = phases.data();
}

/* Coefficients of all pairs of types. Are they and the masses the same? Then there is one class for
 * the core, which is faster: coefficients[0] and particles.mass. What no term of this scene asks
 * for is 0, so that it sets no types apart. */
bool PairSph::types_are_alike()
{
  const int ntypes = atom->ntypes;
  coefficients.assign((size_t) ntypes * ntypes, sd_sph_coefficients());
  const sd_sph_coefficients *first = nullptr;
  bool alike = !atom->rmass;
  for (int i = 1; i <= ntypes; i++)
    for (int j = 1; j <= ntypes; j++) {
      if (!(table[H][i][j] > 0.0)) continue;    // two types of another style
      const sd_sph_parameters given_values = {table[H][i][j], table[C][i][j], table[ALPHA][i][j],
                                              table[BETA][i][j], table[DELTAP][i][j],
                                              has_own_viscosities() ? 1.0 : table[MU][i][j]};
      sd_sph_coefficients &c = coefficients[(size_t) (i - 1) * ntypes + j - 1];
      c = sd_sph_coefficients_of(&model, &given_values);
      if (c.support * c.support > cutsq[i][j] * (1.0 + 1e-12))
        voice.fail("types " + std::to_string(i) + " and " + std::to_string(j) +
                   ": h has grown beyond the neighbour list; use a larger skin (command neighbor)");
      if (!first) {
        first = &c;
        particles.mass = atom->rmass ? 0.0 : atom->mass[i];
      }
      alike = alike && memcmp(first, &c, sizeof(c)) == 0 && atom->mass[i] == particles.mass &&
          atom->mass[j] == particles.mass;
    }
  if (alike && first) coefficients[0] = *first;
  return alike && first;
}

/* vest is the velocity at the time of the force. The integrators set it before the force; who has
 * none of them moves with v. That of LAMMPS's fix sph is v at the start of a run, and its ghosts
 * have not heard of that yet. */
void PairSph::estimate_velocities()
{
  const int n = particles.n, bits = update->setupflag && integrators.empty() ? 0 : own_vest_bits;
  for (int i = 0; i < n; i++)
    if (!(atom->mask[i] & bits)) memcpy(atom->vest[i], atom->v[i], 3 * sizeof(double));
}

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
  const double *v = rows(atom->v);
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
  sd_sph_pack_x(particles.n, rows(atom->x), nullptr, nullptr, 0.0, x4.data());
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
    sd_sph_pack_x(n, rows(atom->x), v, du, -0.5 * dt, x4.data());
  } else
    sd_sph_pack_x(n, rows(atom->x), nullptr, nullptr, 0.0, x4.data());
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
  if (grains) grains->divide_rates(nullptr, 0, false, rate.data());
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
  const int n = particles.n, columns = sd_sph_columns(&model);
  rate.assign(n + 1, 0.0);
  order.resize(columns * (size_t) (n + 1));
  kick.resize(corrects || pliant ? 3 * (size_t) atom->nlocal + 1 : 0);
  const double least = update->setupflag ? 0.6 : 0.5;
  const sd_sph_closing closing = {atom->nlocal, sums.data(),  atom->mask,  own_vest_bits, full,
                                  least,        whole,       rate.data(), order.data(), kick.data()};
  const int stops = sd_sph_close(&model, &particles, &closing);
  if (stops >= 0)
    voice.at_step().fail_one("keyword correction: atom " + std::to_string(atom->tag[stops]) +
                             " is at a free surface: the smallest eigenvalue of the matrix of its neighbours "
                             "is below " +
                             text(least) + "; use shift yes where there is a free surface");
  if (state && update->setupflag && resumes()) state->put_back(order.data(), kick.data());
  forward(order.data(), columns);
  std::fill_n(&order[columns * (size_t) n], columns, 0.0);
  if (state) state->keep_rows(n, order.data(), kick.data());

  particles.order = order.data();
  const sd_sph_both close = near.both(atom->nlocal);
  if (grains) grains->divide_rates(order.data(), columns, shifts, rate.data());
  sd_sph_diffusion(&model, &close, &particles, rate.data());
}

bool PairSph::resumes() const
{
  bool all = !state || state->filled();
  for (const auto *fix : integrators) all = all && fix->resumes();
  return all;
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

/* The P0 of all fluids; the lowest one where they differ. */
double PairSph::background() const
{
  double least = HUGE_VAL;
  for (const auto *fix : pressures) least = std::min(least, fix->state.P0);
  return least;
}

bool PairSph::is_particle(int i) const
{
  return used(atom->type[i]);
}

/* P of owned and ghost particles from the densities they carry, so both sides of a
 * pair see the same. */
void PairSph::pressures_of_all()
{
  const int n = particles.n;
  double *rho = atom->rho;
  for (auto *fix : pressures)
    sd_sph_keep_size(&fix->state, n, rho, atom->mask, fix->groupbit);
  look_at_densities(n);
  std::fill_n(P.data(), n, 0.0);    // of atoms that are no particles as well
  for (auto *fix : pressures)
    sd_sph_pressures(&fix->state, n, rho, atom->mask, fix->groupbit, P.data());
  sd_sph_pack_pressures(&model, n, P.data(), background(), rho, x4.data());
}

void PairSph::forces(bool rates)
{
  const int n = particles.n, receivers = shared && force->newton_pair ? n : atom->nlocal;
  const bool pairwise = evflag && vflag_either;
  if (model.artvisc || model.friction || rates || model.scheme != SD_SPH_PLAIN)
    sd_sph_pack_v(n, rows(atom->vest), atom->rho, v4.data());
  if (has_own_viscosities()) find_viscosities();
  std::fill(f4.begin(), f4.end(), 0.0);
  if (pairwise) {
    const int *count = corrects ? near.count.data() : pairs.count;
    size_t entries = 0;
    for (int k = 0; k < pairs.n; k++) entries += count[pairs.first[k]];
    each.resize(3 * entries + 1);
  }
  const double nearest =
      sum_forces(model, near, pairs, rates, f4, pairwise ? each.data() : nullptr);
  if (nearest == 0.0) coincident();

  if (corrects) add_kicks(f4);
  for (int i = 0; i < receivers; i++)
    for (int d = 0; d < 3; d++) atom->f[i][d] += f4[4 * (size_t) i + d];
  if (wall) wall->bears(load_of(f4, receivers));
  if (rates)
    for (int i = 0; i < receivers; i++)
      if (atom->mask[i] & continuity->groupbit) atom->drho[i] += f4[4 * (size_t) i + 3];
  if (pairwise) tally();
  if (measured)
    keep_forces();
  else if (grains) {
    own = f4;
    reverse(own.data(), 4);
  }
}

/* Over the list of these neighbours both ways, or over the half list; the square of the shortest
 * distance. */
double PairSph::sum_forces(const sd_sph_model &of, Neighbours &both, const sd_sph_list &half, bool rates,
                           Rows &F, double *of_pairs)
{
  const sd_sph_both list = both.both(atom->nlocal);
  return corrects ? sd_sph_corrected_forces(&of, &list, &particles, F.data(), of_pairs)
                  : sd_sph_forces(&of, &half, &particles, rates, F.data(), of_pairs);
}

/* With correction, the momentum that particles take along as they are shifted. */
void PairSph::add_kicks(Rows &F) const
{
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++) F[4 * (size_t) i + d] += Sph::mass(lmp, i) * kick[3 * (size_t) i + d];
}

/* The forces as their owners have them, and friction: the same loop without pressure. */
void PairSph::keep_forces()
{
  const sd_sph_list list = has_ends() ? pairs_of_flow() : pairs;
  Neighbours &close = has_ends() ? of_flow : near;
  own = f4;    // with the kicks
  if (has_ends()) {
    std::fill(own.begin(), own.end(), 0.0);
    sum_forces(model, close, list, false, own, nullptr);
    if (corrects) add_kicks(own);
  }
  reverse(own.data(), 4);
  rubs.assign(f4.size(), 0.0);
  if (!model.artvisc && !model.friction) return;
  sd_sph_model friction = model;
  friction.tenscorr = 0;
  if (!corrects) friction.scheme = SD_SPH_PLAIN;
  for (int i = 0; i < particles.n; i++) x4[4 * (size_t) i + 3] = 0.0;
  sum_forces(friction, close, list, false, rubs, nullptr);
  reverse(rubs.data(), 4);
}

/* For the virial. With correction F is not opposite on the two: each has its half of F d. */
void PairSph::tally()
{
  const double *F = each.data();
  if (corrects) {
    for (int i = 0; i < atom->nlocal; i++)
      for (int m = 0; m < near.count[i]; m++, F += 3) {
        const int j = near.neighbor[i][m];
        if (j == particles.n) continue;
        const double *xi = atom->x[i], *xj = atom->x[j];
        ev_tally_xyz_full(i, 0.0, 0.0, F[0], F[1], F[2], xi[0] - xj[0], xi[1] - xj[1],
                          xi[2] - xj[2]);
      }
    return;
  }
  for (int k = 0; k < pairs.n; k++) {
    const int i = pairs.first[k];
    for (int m = 0; m < pairs.count[i]; m++, F += 3) {
      const int j = pairs.neighbor[i][m] & pairs.mask;
      const double *xi = atom->x[i], *xj = atom->x[j];
      ev_tally_xyz(i, j, atom->nlocal, shared && force->newton_pair, 0.0, 0.0, F[0], F[1], F[2],
                   xi[0] - xj[0], xi[1] - xj[1], xi[2] - xj[2]);
    }
  }
}

void PairSph::coincident()
{
  for (int k = 0; k < pairs.n; k++) {
    const int i = pairs.first[k];
    for (int m = 0; m < pairs.count[i]; m++) {
      const int j = pairs.neighbor[i][m] & pairs.mask;
      if (memcmp(atom->x[i], atom->x[j], 3 * sizeof(double)) == 0)
        voice.at_step().fail_one("atoms " + std::to_string(atom->tag[i]) + " and " +
                                 std::to_string(atom->tag[j]) + " are at one place");
    }
  }
  voice.at_step().fail_one("two atoms are at one place");
}

// --- for other fixes ----------------------------------------------------------------------------

void PairSph::largest_approach(std::vector<double> &largest)
{
  prepare();
  sd_sph_pack_x(particles.n, rows(atom->x), nullptr, nullptr, 0.0, x4.data());
  sd_sph_pack_v(particles.n, rows(atom->vest), atom->rho, v4.data());
  largest.assign(particles.n + 1, 0.0);
  sd_sph_approach(&model, &pairs, &particles, largest.data());
  reverse(largest.data(), 1, true);
}

bool PairSph::moments(std::vector<double> &M)
{
  int current = listed == std::make_pair(atom->nlocal, atom->nghost);
  MPI_Allreduce(MPI_IN_PLACE, &current, 1, MPI_INT, MPI_MIN, world);
  if (!current) return false;
  prepare();
  sd_sph_pack_x(particles.n, rows(atom->x), nullptr, nullptr, 0.0, x4.data());
  sd_sph_pack_volumes(&model, &particles, atom->rho, x4.data());
  M.assign(6 * (size_t) (particles.n + 1), 0.0);
  sd_sph_moments(&model, &pairs, &particles, M.data());
  reverse(M.data(), 6);
  return true;
}

double PairSph::dW_dr(int itype, double r) const
{
  return r * sd_sph_dW_over_r(model.kernel, model.dimension, r, table[H][itype][itype]);
}
