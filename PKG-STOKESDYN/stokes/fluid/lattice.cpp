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

sd_ewald_box Lattice::ewald_box() const
{
  sd_ewald_box box = {};
  box.periodic = periodic[0];
  std::copy_n(origin, 3, box.origin);
  std::copy_n(h, 3, box.edge);
  for (int d = 0; d < 3; d++) box.tilt[d] = h[5 - d];    // xy xz yz
  return box;
}

}    // namespace StokesDyn
