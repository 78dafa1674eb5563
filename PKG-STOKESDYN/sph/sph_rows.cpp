#include "sph_rows.h"

#include "fix_sph_settings.h"
#include "sd_sph_order.h"
#include "sd_sph_step.h"

#include "atom.h"
#include "neigh_list.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

void SphNeighbours::resize(int particles, size_t entries)
{
  if (pool.size() < entries) pool.resize(entries + entries / 8);
  if ((int) own.size() >= particles) return;
  for (auto *v : {&own, &count}) v->resize(particles);
  neighbor.resize(particles);
}

double SphNeighbours::bytes() const
{
  return sizeof(int) * (pool.capacity() + own.capacity() + count.capacity()) +
      sizeof(int *) * neighbor.capacity();
}

SphRows::SphRows(const SphCoefficients &settings, const SphRoles &roles) :
    Pointers(settings.voice.lmp), settings(settings), roles(roles)
{
}

void SphRows::prepare(const NeighList *list, double **cutsq)
{
  const int n = atom->nlocal + atom->nghost, ntypes = atom->ntypes;
  model = settings.model;
  particles = sd_sph_particles();
  particles.n = n;
  for (auto *array : {&x4, &v4}) array->resize(4 * (size_t) (n + 1));
  P.resize(n + 1);
  particles.x4 = x4.data();
  particles.v4 = v4.data();
  if (types_are_alike(cutsq)) {
    model.nclasses = 1;
  } else {
    model.nclasses = ntypes;
    const double *fractions = roles.fractions();
    masses.resize(n + 1);
    classes.resize(n + 1);
    for (int i = 0; i < n; i++) {
      masses[i] = Sph::mass(lmp, i);
      // density is that of the water itself; the volume of a particle is that of the mixture
      if (fractions) masses[i] /= 1.0 - fractions[i];
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
  if (roles.has_walls() || roles.state || sd_sph_of_fluids(&model) || settings.implicit) find_phases();
}

/* Of which fluid is each; is it none that flows? */
void SphRows::find_phases()
{
  const int n = particles.n;
  phases.assign(n + 1, 0);
  for (int i = 0; i < n; i++) {
    if (sd_sph_of_fluids(&model))
      for (size_t k = 0; k < roles.pressures.size(); k++)
        if (atom->mask[i] & roles.pressures[k]->groupbit) phases[i] = (int) k;
    const bool still = roles.is_wall(i) ||
        ((roles.state || settings.implicit) && !(atom->mask[i] & roles.with_own_vest())) || roles.is_held(i);
    if (still) phases[i] = ~phases[i];
  }
  particles.phase = phases.data();
}

void SphRows::pack_places()
{
  sd_sph_pack_x(particles.n, Sph::numbers(atom->x), nullptr, nullptr, 0.0, x4.data());
}

void SphRows::pack_volumes()
{
  pack_places();
  sd_sph_pack_volumes(&model, &particles, atom->rho, x4.data());
}

void SphRows::find_pressures()
{
  const int n = particles.n;
  double *rho = atom->rho;
  for (auto *fix : roles.pressures)
    sd_sph_keep_size(&fix->state, n, rho, atom->mask, fix->groupbit);
  look_at_densities(n);
  std::fill_n(P.data(), n, 0.0);    // of atoms that are no particles as well
  for (auto *fix : roles.pressures)
    sd_sph_pressures(&fix->state, n, rho, atom->mask, fix->groupbit, P.data());
  sd_sph_pack_pressures(&model, n, P.data(), roles.background(), rho, x4.data());
}

/* Owned particles before any sum takes them in (what one lacks is no number in all around it then),
 * and with their ghosts after the density has been advanced. */
void SphRows::look_at_densities(int n) const
{
  const double *rho = atom->rho;
  for (int i = 0; i < n; i++) {
    if (rho[i] > 0.0 && std::isfinite(rho[i]) && roles.has_state(i)) continue;
    if (!settings.used(atom->type[i])) continue;
    const Voice now = settings.voice.at_step();
    const std::string who = "atom " + std::to_string(atom->tag[i]);
    if (!roles.has_state(i))
      now.fail_one(who + " is in the group of no fix sph/pressure");
    const char *cure = update->setupflag ? "; give it one by the command set ... sph/rho"
        : rho[i] == 0.0 ? "; if it was created in this run: fix sph/pressure relativ and Tait give "
                          "new atoms of their group the density rho0"
                        : "; the time step may be too long";
    now.fail_one(who + " has the density " + text(rho[i]) + "; it must be a number > 0" + cure);
  }
}

/* Coefficients of all pairs of types. Are they and the masses the same? Then there is one class for
 * the core, which is faster: coefficients[0] and particles.mass. What no term of this scene asks
 * for is 0, so that it sets no types apart. */
bool SphRows::types_are_alike(double **cutsq)
{
  const int ntypes = atom->ntypes;
  coefficients.assign((size_t) ntypes * ntypes, sd_sph_coefficients());
  const sd_sph_coefficients *first = nullptr;
  bool alike = !atom->rmass;
  for (int i = 1; i <= ntypes; i++)
    for (int j = 1; j <= ntypes; j++) {
      sd_sph_parameters values = settings.parameters(i, j);
      if (!(values.h > 0.0)) continue;    // two types of another style
      if (settings.has_own_viscosities()) values.mu = 1.0;
      sd_sph_coefficients &c = coefficients[(size_t) (i - 1) * ntypes + j - 1];
      c = sd_sph_coefficients_of(&model, &values);
      if (c.support * c.support > cutsq[i][j] * (1.0 + 1e-12))
        settings.voice.fail("types " + std::to_string(i) + " and " + std::to_string(j) +
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

double SphRows::bytes() const
{
  double bytes = near.bytes();
  for (const auto *v : {&x4, &v4, &sums, &weights}) bytes += v->capacity() * sizeof(double);
  for (const auto *v : {&P, &masses}) bytes += v->capacity() * sizeof(double);
  for (const auto *v : {&classes, &phases}) bytes += v->capacity() * sizeof(int);
  return bytes;
}
