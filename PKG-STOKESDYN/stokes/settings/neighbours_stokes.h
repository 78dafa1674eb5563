/* Which commands of LAMMPS go with pair_style stokes_dynamics and its fixes. */
#ifndef SD_NEIGHBOURS_STOKES_H
#define SD_NEIGHBOURS_STOKES_H

#include "neighbours.h"

#include <string>
#include <vector>

namespace StokesDyn {

/* Facts of a run; the page says them in the words that stand here. */
enum StokesFact : unsigned {
  FORCE = 1 << 0,         // with inertia
  OVERDAMPED = 1 << 1,    // without inertia
  NOISE = 1 << 2,         // with temperature
  ADAPTING = 1 << 3,      // with adapt
  TURNING = 1 << 4,       // spheres turn
  RESTING = 1 << 5,       // the fluid rests
  UPRIGHT = 1 << 6,       // spheres do not turn
  APPLIED = 1 << 7,       // with fix stokes_dynamics
  MIDWAY = 1 << 8,        // with scheme midpoint
  ADDED = 1 << 9,         // with add_force yes
};

inline unsigned fact(StokesFact which, bool holds) { return holds ? (unsigned) which : 0u; }

/* Sorts of spheres: held are those of keyword held. */
enum StokesSort : unsigned { FREE = 1 << 0, HELD = 1 << 1 };

extern const std::vector<Neighbour> stokes_neighbours;

/* Stiffness along the line of centres and across, and damping, of a contact style of package
 * GRANULAR, which tells nobody but a restart file: k_n k_t gamma_n gamma_t friction. Without a
 * style: there is none. */
struct Contact {
  std::string style;
  double k = 0.0, across = 0.0, damping = 0.0, friction = 0.0;
};
Contact contact_of(LAMMPS_NS::LAMMPS *lmp);

/* Does hybrid/scaled, the guest, scale forces of pair_style stokes_dynamics? says: by what */
bool scales_us(const Guest &guest, std::string &says);

}    // namespace StokesDyn
#endif
