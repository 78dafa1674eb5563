/* Of pair_style sph/artVisc/tensCorr: viscosities of particles, and implicit friction. */
#include "pair_sph_artvisc_tenscorr.h"

#include "fix_wall_sph.h"
#include "keywords.h"
#include "ranks.h"
#include "sd_sph_implicit.h"

#include "atom.h"
#include "force.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

/* Of each particle of this rank, in walls as well: with the velocity that friction sees there, the rate is about
 * that at the face of the wall, while the first row of fluid is half a spacing away. x4 and v4 are packed. */
std::vector<double> PairSph::shear_rates()
{
  sums.assign(SD_SPH_GRADIENTS * (size_t) (particles.n + 1), 0.0);
  sd_sph_velocity_gradients(&model, &pairs, &particles, sums.data());
  reverse(sums.data(), SD_SPH_GRADIENTS);
  std::vector<double> rates(atom->nlocal);
  for (int i = 0; i < atom->nlocal; i++)
    rates[i] = sd_sph_shear_rate(model.dimension, &sums[SD_SPH_GRADIENTS * (size_t) i]);
  return rates;
}

void PairSph::find_viscosities()
{
  const std::vector<double> rates = is_newtonian() ? std::vector<double>(atom->nlocal) : shear_rates();
  std::vector<sd_sph_rheology> fluids(1);
  for (int type = 1; type <= atom->ntypes; type++) fluids.push_back(rheology(type));
  viscosities.assign(particles.n + 1, 0.0);
  for (int i = 0; i < atom->nlocal; i++)
    if (used(atom->type[i])) viscosities[i] = sd_sph_mu(&fluids[atom->type[i]], rates[i]);
  forward(viscosities.data(), 1);
  viscosities[particles.n] = 1.0;
  particles.mu = viscosities.data();
}

/* Beyond these two limits a run grows from its first steps on, whatever the flow. Friction is explicit; with a law
 * of viscosity a fluid at rest has mumax, though fix check/timestep/sph sees the viscosities of the moment. */
void PairSph::look_at_step()
{
  const bool newton = law == SD_SPH_NEWTON;
  double sound = HUGE_VAL, friction = HUGE_VAL;
  for (int i = 0; i < atom->nlocal; i++) {
    const int t = atom->type[i];
    if (!used(t) || is_wall(i) || !state_of(i) || !(atom->rho[i] > 0.0)) continue;
    const double h = table[H][t][t];
    sound = std::min(sound, h / speed_of_sound(i));
    if (!model.friction || implicit) continue;
    const sd_sph_rheology fluid = rheology(t);
    const double most = newton ? table[MU][t][t] : sd_sph_largest_mu(&fluid);
    friction = std::min(friction, h * h * atom->rho[i] / (8.0 * most));
  }
  sound = smallest_of_all(world, sound);
  friction = smallest_of_all(world, friction);
  const std::string dt = text(update->dt);
  if (update->dt > sound)
    voice.warn("the time step " + dt + " is longer than h/c = " + text(sound) +
               ", the time that sound takes over a smoothing length: the water may fly apart; take 0.2 to 0.4 of it");
  if (update->dt > friction && newton)
    voice.warn("keyword viscosity: the time step " + dt + " is longer than h^2 rho/(8 mu) = " + text(friction) +
               ": friction is unstable; use a smaller time step, or implicit yes");
  else if (update->dt > friction)
    voice.warn("keyword rheology: the time step " + dt + " is longer than h^2 rho/(8 mumax) = " + text(friction) +
               ": friction is unstable where the fluid is nearly at rest; use a smaller mumax "
               "(rho c h/3 costs no time step), a smaller time step, or implicit yes");
}

// --- implicit friction --------------------------------------------------------------------------------

/* All that acts is in atom->f, on its owners; the lists, places and viscosities are those of the force of this
 * step. */
void PairSph::rub_implicitly(double tau)
{
  const int nlocal = atom->nlocal;
  inertia.resize(nlocal + 1);
  for (int i = 0; i < nlocal; i++) inertia[i] = Sph::mass(lmp, i);
  for (int i = 0; i < particles.n; i++) x4[4 * (size_t) i + 3] = 0.0;
  sd_world ranks = {};
  ranks.ctx = &world;
  ranks.sum = [](void *ctx, double *values, int count) {
    MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, MPI_SUM, *static_cast<MPI_Comm *>(ctx));
    return SD_OK;
  };
  const sd_sph_implicit all = {&model, &pairs, &particles, nlocal, inertia.data(), tau, &ranks, this,
                               [](void *ctx, double *rows) { static_cast<PairSph *>(ctx)->forward(rows, 4); },
                               [](void *ctx, double *rows) { static_cast<PairSph *>(ctx)->reverse(rows, 4); }};
  scratch.resize(sd_sph_implicit_size(&all));
  const sd_status status =
      sd_sph_rub_implicitly(&all, nlocal ? atom->v[0] : nullptr, nlocal ? atom->vest[0] : nullptr,
                            nlocal ? atom->f[0] : nullptr, f4.data(), scratch.data(), &friction_steps);
  if (status != SD_OK)
    voice.at_step().fail("keyword implicit: conjugate gradients stopped after " + std::to_string(friction_steps) +
                         " steps: " + sd_status_string(status) + "; use a smaller time step");
  if (wall) wall->bears_more(load_of(f4, nlocal));
  if (!measured) return;
  for (size_t k = 0; k < 4 * (size_t) nlocal; k++) {
    own[k] += f4[k];
    rubs[k] += f4[k];
  }
}
