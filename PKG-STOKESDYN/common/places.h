/* Where an atom is in the box: LAMMPS wraps it only when it re-neighbours. */
#ifndef SD_PLACES_H
#define SD_PLACES_H

#include "domain.h"

#include <cmath>

namespace StokesDyn {

/* More than one length of a periodic box outside of it, or no number? LAMMPS wraps an atom by one length,
 * and between two wrappings it moves by half the skin in any run that means something. */
inline bool far_out(const LAMMPS_NS::Domain *domain, const double *x)
{
  const double *lo = domain->triclinic ? domain->boxlo_bound : domain->boxlo;
  const double *hi = domain->triclinic ? domain->boxhi_bound : domain->boxhi;
  for (int d = 0; d < 3; d++)
    if (domain->periodicity[d] && !(x[d] >= lo[d] - domain->prd[d] && x[d] <= hi[d] + domain->prd[d]))
      return true;
  return false;
}

/* Its image in the box: an atom and its images are one place. Nearly all are inside, so that there is no
 * branch for each side. What is no number, or far out, stays: remap() goes box by box. */
inline void image_in_box(LAMMPS_NS::Domain *domain, const double *from, double *x)
{
  const double *lo = domain->boxlo, *hi = domain->boxhi;
  bool inside = !domain->triclinic;
  for (int d = 0; d < 3; d++) {
    inside &= (from[d] >= lo[d]) & (from[d] < hi[d]);
    x[d] = from[d];
  }
  if (!inside && std::isfinite(x[0] + x[1] + x[2]) && !far_out(domain, x)) domain->remap(x);
}

}    // namespace StokesDyn
#endif
