/* What particles are by their groups and types. */
#include "sph_roles.h"

#include "fix_sph_grains.h"
#include "fix_sph_inlet.h"
#include "fix_sph_outlet.h"
#include "fix_sph_settings.h"
#include "fix_wall_sph.h"

#include "atom.h"

using namespace LAMMPS_NS;
using namespace StokesDyn;

bool SphRoles::is_wall(int i) const
{
  return wall && (atom->mask[i] & wall->groupbit);
}

std::array<double, 3> SphRoles::load_on_walls(const Rows &F, int receivers) const
{
  std::array<double, 3> sum = {0.0, 0.0, 0.0};
  for (int i = 0; i < receivers; i++) {
    if (!is_wall(i)) continue;
    for (int d = 0; d < 3; d++) sum[d] += F[4 * (size_t) i + d];
  }
  return sum;
}

template <class Style> static Style *holder(const std::vector<Style *> &fixes, const Atom *atom, int i)
{
  for (auto *fix : fixes)
    if ((atom->mask[i] & fix->groupbit) && fix->holds(atom->x[i])) return fix;
  return nullptr;
}

const FixSphPressure *SphRoles::state_of(int i) const
{
  for (const auto *fix : pressures)
    if (atom->mask[i] & fix->groupbit) return fix;
  return nullptr;    // look_at_densities has seen to it
}

double SphRoles::speed_of_sound(int i) const
{
  return sd_sph_speed_of_sound(&state_of(i)->state, atom->rho[i]);
}

double SphRoles::rest_density(int i) const
{
  const FixSphPressure *eos = state_of(i);
  return eos && eos->state.rho0 > 0.0 ? eos->state.rho0 : atom->rho[i];
}

double SphRoles::volume_of(int i) const
{
  const FixSphPressure *eos = state_of(i);
  const double rho = eos ? sd_sph_density_of_water(&eos->state, atom->rho[i]) : atom->rho[i];
  return Sph::mass(lmp, i) / (rho * (grains ? 1.0 - grains->fraction(i) : 1.0));
}

bool SphRoles::stands(int i) const
{
  return !(atom->mask[i] & displaced_bits) && settings.used(atom->type[i]);
}

bool SphRoles::has_velocity(int i) const
{
  const double *v = atom->v[i];
  return v[0] != 0.0 || v[1] != 0.0 || v[2] != 0.0;
}

FixSphInlet *SphRoles::inlet_of(int i) const
{
  return holder(inlets, atom, i);
}

FixSphOutlet *SphRoles::outlet_of(int i) const
{
  return holder(outlets, atom, i);
}

bool SphRoles::has_state(int i) const
{
  return atom->mask[i] & pressure_bits;
}

bool SphRoles::advances_density(int i) const
{
  return atom->mask[i] & leapfrog_bits;
}

const double *SphRoles::fractions() const
{
  return grains ? grains->fractions() : nullptr;
}
