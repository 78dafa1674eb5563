#include "lattice.h"

#include "domain.h"

#include <algorithm>

namespace StokesDyn {

Lattice Lattice::of(const LAMMPS_NS::Domain *domain)
{
  Lattice l = {};
  const double tilt[3] = {domain->yz, domain->xz, domain->xy};
  std::copy_n(domain->boxlo, 3, l.origin);
  std::copy_n(domain->prd, 3, l.h);
  if (domain->triclinic) std::copy_n(tilt, 3, l.h + 3);
  for (int d = 0; d < 3; d++) l.periodic[d] = domain->periodicity[d] && d < domain->dimension;
  return l;
}

}    // namespace StokesDyn
