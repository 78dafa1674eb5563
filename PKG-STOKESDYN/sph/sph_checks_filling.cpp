/* How the particles fill space when a run begins. */
#include "sph_checks.h"

#include "fix_sph_settings.h"
#include "fix_wall_sph.h"
#include "ranks.h"
#include "sd_sph_filling.h"
#include "sd_sph_probe.h"

#include "atom.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

// By such a factor a number may be off before it is said: disorder and spray do less, another unit or another
// dimension more.
static constexpr double MOST = 1.25;

void SphChecks::look_at_scene()
{
  if (roles.continuity && fills_space() && roles.wall) look_at_thickness();
  if (roles.continuity) look_at_rest();
}

/* A density far from rho0 is a pressure that tears the fluid in the first steps. */
void SphChecks::look_at_rest()
{
  for (const auto *fix : roles.pressures) {
    if (!(fix->state.rho0 > 0.0)) continue;
    double n = 0.0, ratio = 0.0;
    for (int i = 0; i < atom->nlocal; i++) {
      if (!(atom->mask[i] & fix->groupbit) || !settings.used(atom->type[i]) || roles.is_wall(i)) continue;
      n++;
      ratio += atom->rho[i] / fix->state.rho0;
    }
    n = sum_of_all(world, n);
    ratio = sum_of_all(world, ratio) / std::max(n, 1.0);
    if (n > 0.0 && fabs(log(ratio)) > log(MOST))
      voice.warn(std::string("the densities of the fluid of fix ") + fix->id + " are " + text(ratio) +
                 " times its rho0, on the mean: give them by 'set group ... sph/rho', in the units of rho0");
  }
}

/* Masses that are not density times the room of a particle (of three dimensions in two, of another spacing), or two
 * lattices in one place: gaps and surfaces seem to be where there are none. False: so it is. */
bool SphChecks::fills_space()
{
  const size_t all = rows.particles.n + 1;
  Rows around_each(4 * all, 0.0), M(6 * all, 0.0);
  rows.pack_volumes();
  sd_sph_surroundings(&rows.model, &rows.raw, &rows.particles, around_each.data());
  sd_sph_moments(&rows.model, &rows.raw, &rows.particles, M.data());
  ghosts.reverse(around_each.data(), 4);
  ghosts.reverse(M.data(), 6);
  double inside = 0.0, filled = 0.0;
  for (size_t i = 0; i < (size_t) atom->nlocal; i++) {
    if (!settings.used(atom->type[i]) || roles.is_wall((int) i) || roles.rests_alone((int) i)) continue;
    const double here = sd_sph_filled(&rows.model, &rows.particles, (int) i, &around_each[4 * i], &M[6 * i]);
    inside += here > 0.0;
    filled += here;
  }
  inside = sum_of_all(world, inside);
  filled = sum_of_all(world, filled) / std::max(inside, 1.0);
  if (inside == 0.0 || fabs(log(filled)) < log(MOST)) return true;
  voice.warn("inside the fluid the volumes of particles, mass over density, fill " + text(filled) +
             " of the space in place of 1: give each the mass density * dx^" + std::to_string(rows.model.dimension) +
             ", dx the distance of neighbours" + (filled > MOST ? ", and make no particles where others are" : ""));
  return false;
}

/* Water leaks through a wall whose end it sees. At the tip of a wedge that cannot be helped, so a few may. */
void SphChecks::look_at_thickness()
{
  constexpr double FEW = 0.05;
  rows.pack_volumes();
  Rows toward(4 * (size_t) (rows.particles.n + 1), 0.0);
  sd_sph_toward_walls(&rows.model, &rows.raw, &rows.particles, toward.data());
  ghosts.reverse(toward.data(), 4);
  ghosts.forward(toward.data(), 4);
  sd_sph_reach_of_walls(&rows.model, &rows.raw, &rows.particles, toward.data());
  ghosts.reverse(toward.data(), 4, true);
  double before = 0.0, past = 0.0;
  tagint first = MAXTAGINT;
  for (int i = 0; i < atom->nlocal; i++) {
    const double reach = toward[4 * (size_t) i + 3];
    if (!(reach > 0.0)) continue;
    before++;
    if (!sd_sph_sees_past(&rows.model, &rows.particles, i, reach)) continue;
    past++;
    first = std::min(first, atom->tag[i]);
  }
  before = sum_of_all(world, before);
  past = sum_of_all(world, past);
  first = smallest_of_all(world, first);
  if (past > FEW * before)
    roles.wall->voice.warn("the wall is thin: " + text(past) + " of the " + text(before) + " fluid particles that see "
                           "it, the first is atom " + std::to_string(first) + ", see its other side and will leak "
                           "through it; walls must be as thick as the support of the kernel, 2 h");
}
