/* Of pair_style sph/artVisc/tensCorr: a step. */
#include "pair_sph_artvisc_tenscorr.h"

#include "fix_nve_sph.h"
#include "fix_sph_grains.h"
#include "fix_sph_settings.h"
#include "fix_sph_shift.h"
#include "fix_wall_sph.h"
#include "keywords.h"
#include "sd_sph_probe.h"
#include "sd_sph_step.h"

#include "atom.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

void PairSph::compute(int eflag, int vflag)
{
  require_prepared();
  if (continuity && !begun)
    voice.fail("cannot be used with rerun: a dump file has no densities for fix sph/density/continuity; use pair_style "
               "zero for what needs no forces of the water, or restart files");
  ev_init(eflag, vflag);
  listed = {atom->nlocal, atom->nghost};
  check_list();
  if (continuity && !moved_box.follow(atom->rho))
    voice.warn("the box has changed since the last run, but the particles have not moved with it: "
               "their densities stay as they are; if these are wrong, use set ... sph/rho");
  look_at_densities(atom->nlocal);
  if (grains) grains->find_fractions();
  prepare();
  if (update->setupflag) look_at_beginning();
  if (needs_velocity) estimate_velocities();
  if (leapfrog && update->setupflag && has_walls()) settle_walls();

  find_densities();
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

bool PairSph::resumes() const
{
  bool all = !state || state->filled();
  for (const auto *fix : integrators) all = all && fix->resumes();
  return all;
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

// --- for other fixes ----------------------------------------------------------------------------

void PairSph::largest_approach(std::vector<double> &largest)
{
  prepare();
  sd_sph_pack_x(particles.n, Sph::numbers(atom->x), nullptr, nullptr, 0.0, x4.data());
  sd_sph_pack_v(particles.n, Sph::numbers(atom->vest), atom->rho, v4.data());
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
  pack_volumes();
  M.assign(6 * (size_t) (particles.n + 1), 0.0);
  sd_sph_moments(&model, &pairs, &particles, M.data());
  reverse(M.data(), 6);
  return true;
}
