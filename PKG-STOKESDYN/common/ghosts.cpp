#include "ghosts.h"

#include "keywords.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

GhostNeed ghosts_for(LAMMPS *lmp, double length)
{
  const Domain *domain = lmp->domain;
  const double cut = length + lmp->neighbor->skin;
  GhostNeed need = {0.0, 0.0, (double) lmp->atom->natoms, false};
  double swaps = 0.0;
  for (int d = 0; d < domain->dimension; d++) {
    double row = 1.0 / domain->prd[d];    // one over the distance of opposite faces
    if (domain->triclinic && d < 2) {
      const double *inv = domain->h_inv;
      row = d == 0 ? sqrt(inv[0] * inv[0] + inv[5] * inv[5] + inv[4] * inv[4])
                   : sqrt(inv[1] * inv[1] + inv[3] * inv[3]);
    }
    need.boxes = std::max(need.boxes, cut * row);
    swaps = std::max(swaps, cut * row * lmp->comm->procgrid[d]);
    if (!domain->periodicity[d]) continue;
    need.atoms *= 2.0 * cut * row + 1.0;
    need.periodic_boxes = std::max(need.periodic_boxes, cut * row);
  }
  const double most = need.periodic_boxes > 10.0 ? 1e7 : (double) MAXSMALLINT;
  need.endless = !(need.atoms < most && swaps < MAXSMALLINT);
  return need;
}

void refuse_endless_ghosts(LAMMPS *lmp, const std::string &what, double length,
                           const std::string &way_out)
{
  const GhostNeed need = ghosts_for(lmp, length);
  if (need.endless)
    fail(lmp,
         what + " is " + text(need.boxes) +
             " times the box, which is more than LAMMPS can make ghost atoms for: is it in other "
             "units?" + way_out);
}

}    // namespace StokesDyn
