#include "sph_forces.h"

#include "fix_sph_settings.h"
#include "sd_sph_sums.h"

#include "atom.h"
#include "force.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

SphForces::SphForces(const SphCoefficients &settings, const SphRoles &roles, SphRows &rows, const SphMiddle &middle,
                     SphViscosities &viscosities, GhostExchange &ghosts) :
    SphPart(settings, roles, rows, ghosts), middle(middle), viscosities(viscosities)
{
}

void SphForces::begin(bool of_energy)
{
  measured = of_energy;
}

int SphForces::who_gets() const
{
  return rows.shared && force->newton_pair ? rows.particles.n : atom->nlocal;
}

void SphForces::compute(bool pairwise)
{
  const int n = rows.particles.n, receivers = who_gets();
  const bool rates = roles.continuity && !roles.is_leapfrog();
  if (rows.model.artvisc || rows.model.friction || rates || rows.model.scheme != SD_SPH_PLAIN)
    sd_sph_pack_v(n, Sph::numbers(atom->vest), atom->rho, rows.v4.data());
  if (settings.has_own_viscosities()) viscosities.find();
  f4.assign(4 * (size_t) (n + 1), 0.0);
  if (pairwise) {
    const int *count = settings.corrects ? rows.near.count.data() : rows.pairs.count;
    size_t entries = 0;
    for (int k = 0; k < rows.pairs.n; k++) entries += count[rows.pairs.first[k]];
    each.resize(3 * entries + 1);
  }
  const double nearest =
      sum_forces(rows.model, rows.near, rows.pairs, rates, f4, pairwise ? each.data() : nullptr);
  if (nearest == 0.0) coincident();

  if (settings.corrects) add_kicks(f4);
  for (int i = 0; i < receivers; i++)
    for (int d = 0; d < 3; d++) atom->f[i][d] += f4[4 * (size_t) i + d];
  if (rates)
    for (int i = 0; i < receivers; i++)
      if (atom->mask[i] & roles.continuity->groupbit) atom->drho[i] += f4[4 * (size_t) i + 3];
  if (measured)
    keep_forces();
  else if (roles.grains) {
    own = f4;
    ghosts.reverse(own.data(), 4);
  }
}

/* Over the list of these neighbours both ways, or over the half list; the square of the shortest
 * distance. */
double SphForces::sum_forces(const sd_sph_model &of, SphNeighbours &both, const sd_sph_list &half, bool rates,
                             Rows &F, double *of_pairs)
{
  const sd_sph_both list = both.both(atom->nlocal);
  return settings.corrects ? sd_sph_corrected_forces(&of, &list, &rows.particles, F.data(), of_pairs)
                           : sd_sph_forces(&of, &half, &rows.particles, rates, F.data(), of_pairs);
}

/* With correction, the momentum that particles take along as they are shifted. */
void SphForces::add_kicks(Rows &F) const
{
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++) F[4 * (size_t) i + d] += Sph::mass(lmp, i) * middle.kicks()[3 * (size_t) i + d];
}

/* The forces as their owners have them, and friction: the same loop without pressure. */
void SphForces::keep_forces()
{
  const sd_sph_list list = roles.has_ends() ? pairs_of_flow() : rows.pairs;
  SphNeighbours &close = roles.has_ends() ? of_flow : rows.near;
  own = f4;    // with the kicks
  if (roles.has_ends()) {
    std::fill(own.begin(), own.end(), 0.0);
    sum_forces(rows.model, close, list, false, own, nullptr);
    if (settings.corrects) add_kicks(own);
  }
  ghosts.reverse(own.data(), 4);
  rubs.assign(f4.size(), 0.0);
  if (!rows.model.artvisc && !rows.model.friction) return;
  sd_sph_model friction = rows.model;
  friction.tenscorr = 0;
  if (!settings.corrects) friction.scheme = SD_SPH_PLAIN;
  for (int i = 0; i < rows.particles.n; i++) rows.x4[4 * (size_t) i + 3] = 0.0;
  sum_forces(friction, close, list, false, rubs, nullptr);
  ghosts.reverse(rubs.data(), 4);
}

/* Two particles that stand in walls and open ends do no work on the flow, and at the back of an open
 * end it depends on the list of neighbours which of them are there. */
sd_sph_list SphForces::pairs_of_flow()
{
  const int *count = settings.corrects ? rows.near.count.data() : rows.pairs.count;
  size_t entries = 0;
  for (int k = 0; k < rows.pairs.n; k++) entries += count[rows.pairs.first[k]] + SD_SPH_LANES;
  of_flow.resize(atom->nmax, entries);
  const sd_sph_near all = rows.near.room(0.0), flow = of_flow.room(0.0);
  sd_sph_pairs_of_flow(&rows.particles, &rows.pairs, &all, settings.corrects, &flow);
  return {rows.pairs.n, ~0, rows.pairs.first, of_flow.own.data(), of_flow.neighbor.data()};
}

void SphForces::coincident()
{
  for (int k = 0; k < rows.pairs.n; k++) {
    const int i = rows.pairs.first[k];
    for (int m = 0; m < rows.pairs.count[i]; m++) {
      const int j = rows.pairs.neighbor[i][m] & rows.pairs.mask;
      if (memcmp(atom->x[i], atom->x[j], 3 * sizeof(double)) == 0)
        voice.at_step().fail_one("atoms " + std::to_string(atom->tag[i]) + " and " +
                                          std::to_string(atom->tag[j]) + " are at one place");
    }
  }
  voice.at_step().fail_one("two atoms are at one place");
}

void SphForces::rub_implicitly(double tau)
{
  viscosities.rub_implicitly(tau, f4);
  if (!measured) return;
  for (size_t k = 0; k < 4 * (size_t) atom->nlocal; k++) {
    own[k] += f4[k];
    rubs[k] += f4[k];
  }
}

double SphForces::bytes() const
{
  double bytes = of_flow.bytes() + each.capacity() * sizeof(double);
  for (const auto *v : {&f4, &own, &rubs}) bytes += v->capacity() * sizeof(double);
  return bytes;
}
