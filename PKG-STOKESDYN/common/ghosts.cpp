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

void refuse_endless_ghosts(LAMMPS *lmp, const std::string &what, double length)
{
  const Domain *domain = lmp->domain;
  const double cut = length + lmp->neighbor->skin;
  double boxes = 0.0, periodic_boxes = 0.0, atoms = lmp->atom->natoms, swaps = 0.0;
  for (int d = 0; d < domain->dimension; d++) {
    double row = 1.0 / domain->prd[d];    // one over the distance of opposite faces
    if (domain->triclinic && d < 2) {
      const double *inv = domain->h_inv;
      row = d == 0 ? sqrt(inv[0] * inv[0] + inv[5] * inv[5] + inv[4] * inv[4])
                   : sqrt(inv[1] * inv[1] + inv[3] * inv[3]);
    }
    boxes = std::max(boxes, cut * row);
    swaps = std::max(swaps, cut * row * lmp->comm->procgrid[d]);
    if (!domain->periodicity[d]) continue;
    atoms *= 2.0 * cut * row + 1.0;
    periodic_boxes = std::max(periodic_boxes, cut * row);
  }
  const double most = periodic_boxes > 10.0 ? 1e7 : (double) MAXSMALLINT;
  if (atoms < most && swaps < MAXSMALLINT) return;
  fail(lmp,
       what + " is " + text(boxes) +
           " times the box, which is more than LAMMPS can make ghost atoms for: is it in other units?");
}

}    // namespace StokesDyn
