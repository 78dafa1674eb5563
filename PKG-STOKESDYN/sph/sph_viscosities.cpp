#include "sph_viscosities.h"

#include "sd_sph_implicit.h"

#include "atom.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace StokesDyn;

void SphViscosities::find()
{
  const std::vector<double> rates = settings.is_newtonian() ? std::vector<double>(atom->nlocal) : shear_rates();
  std::vector<sd_sph_rheology> fluids(1);
  for (int type = 1; type <= atom->ntypes; type++) fluids.push_back(settings.rheology(type));
  viscosities.assign(rows.particles.n + 1, 0.0);
  for (int i = 0; i < atom->nlocal; i++)
    if (settings.used(atom->type[i])) viscosities[i] = sd_sph_mu(&fluids[atom->type[i]], rates[i]);
  ghosts.forward(viscosities.data(), 1);
  viscosities[rows.particles.n] = 1.0;
  rows.particles.mu = viscosities.data();
}

/* Of each particle of this rank, in walls as well: with the velocity that friction sees there, the rate is about
 * that at the face of the wall, while the first row of fluid is half a spacing away. x4 and v4 are packed. */
std::vector<double> SphViscosities::shear_rates()
{
  rows.sums.assign(SD_SPH_GRADIENTS * (size_t) (rows.particles.n + 1), 0.0);
  sd_sph_velocity_gradients(&rows.model, &rows.pairs, &rows.particles, rows.sums.data());
  ghosts.reverse(rows.sums.data(), SD_SPH_GRADIENTS);
  std::vector<double> rates(atom->nlocal);
  for (int i = 0; i < atom->nlocal; i++)
    rates[i] = sd_sph_shear_rate(rows.model.dimension, &rows.sums[SD_SPH_GRADIENTS * (size_t) i]);
  return rates;
}

double SphViscosities::of(int i) const
{
  if (!settings.is_newtonian()) return roles.is_wall(i) ? 0.0 : viscosities[i];
  return settings.model.friction ? settings.parameters(atom->type[i], atom->type[i]).mu : 0.0;
}

double SphViscosities::all_of(int i) const
{
  const sd_sph_parameters p = settings.parameters(atom->type[i], atom->type[i]);
  const double artificial = settings.model.artvisc ? atom->rho[i] * p.alpha * p.c * p.h : 0.0;
  return of(i) + artificial / (2.0 * (settings.model.dimension + 2));
}

/* All that acts is in atom->f, on its owners; the lists, places and viscosities are those of the force of this
 * step. Whoever looked at it since (fix check/timestep/sph) has prepared the rows anew. */
void SphViscosities::rub_implicitly(double tau, Rows &F)
{
  const int nlocal = atom->nlocal;
  rows.particles.mu = viscosities.data();
  inertia.resize(nlocal + 1);
  for (int i = 0; i < nlocal; i++) inertia[i] = Sph::mass(lmp, i);
  for (int i = 0; i < rows.particles.n; i++) rows.x4[4 * (size_t) i + 3] = 0.0;
  sd_world ranks = {};
  ranks.ctx = &world;
  ranks.sum = [](void *ctx, double *values, int count) {
    MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, MPI_SUM, *static_cast<MPI_Comm *>(ctx));
    return SD_OK;
  };
  const sd_sph_implicit all = {&rows.model, &rows.pairs, &rows.particles, nlocal, inertia.data(), tau, &ranks, &ghosts,
                               [](void *ctx, double *of) { static_cast<GhostExchange *>(ctx)->forward(of, 4); },
                               [](void *ctx, double *of) { static_cast<GhostExchange *>(ctx)->reverse(of, 4); }};
  int steps = 0;
  scratch.resize(sd_sph_implicit_size(&all));
  const sd_status status =
      sd_sph_rub_implicitly(&all, nlocal ? atom->v[0] : nullptr, nlocal ? atom->vest[0] : nullptr,
                            nlocal ? atom->f[0] : nullptr, F.data(), scratch.data(), &steps);
  if (status != SD_OK)
    voice.at_step().fail("keyword implicit: conjugate gradients stopped after " + std::to_string(steps) +
                                  " steps: " + sd_status_string(status) + "; use a smaller time step");
}

double SphViscosities::bytes() const
{
  return (viscosities.capacity() + inertia.capacity() + scratch.capacity()) * sizeof(double);
}
