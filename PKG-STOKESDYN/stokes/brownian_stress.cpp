#include "brownian_stress.h"

#include "compute_stokes_dynamics_stress.h"
#include "hydrodynamics.h"

#include "atom.h"
#include "modify.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

template <class Is> static bool any_compute(const Modify *modify, const Is &is)
{
  for (int k = 0; k < modify->ncompute; k++)
    if (const auto *stress = dynamic_cast<const ComputeStokesDynamicsStress *>(modify->compute[k]))
      if (is(*stress)) return true;
  return false;
}

bool BrownianStress::wanted() const
{
  return any_compute(modify, [](const ComputeStokesDynamicsStress &) { return true; });
}

bool BrownianStress::wants_low() const
{
  return any_compute(modify, [this](const ComputeStokesDynamicsStress &compute) {
    return compute.low() && (update->setupflag || compute.asked_in(update->ntimestep));
  });
}

bool BrownianStress::known(bool of_low) const
{
  return (of_low ? low : raw) == (double) update->ntimestep;
}

void BrownianStress::without_noise(Hydrodynamics &hydro)
{
  hydro.stress(still);
}

void BrownianStress::begin(Hydrodynamics &hydro, const std::vector<double> &noise)
{
  const double now = (double) update->ntimestep;
  const bool has_still = !still.empty(), made = raw == now;
  if (!wanted()) return;
  hydro.stress(moments, noise);
  for (int i : hydro.ambient.who()) {
    double *row = rows.give(i);
    const double *D = &moments[12 * (size_t) i], *D_still = has_still ? &still[12 * (size_t) i] : D;
    for (int k = 0; k < 12; k++) row[NOISE + k] = D[k] - D_still[k];
    if (made) continue;
    std::copy_n(D, 12, row + RAW);
    std::copy_n(D_still, 12, row + LOW);
  }
  if (has_still) next = now;
  if (!made) raw = now;
  if (!made && has_still) low = now;
  still.clear();
}

void BrownianStress::middle(Hydrodynamics &hydro, const std::vector<double> &noise)
{
  if (!wanted()) return;
  const double now = (double) update->ntimestep;
  hydro.stress(moments, noise);
  for (int i : hydro.ambient.who()) {
    double *row = rows.give(i);
    for (int k = 0; k < 12; k++) {
      row[RAW + k] = moments[12 * (size_t) i + k];
      row[LOW + k] = row[RAW + k] - row[NOISE + k];
    }
  }
  raw = now;
  low = next == now - 1 ? now : -1;
}

}    // namespace StokesDyn
