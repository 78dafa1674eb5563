/* The box as it repeats itself. */
#ifndef SD_STOKES_LATTICE_H
#define SD_STOKES_LATTICE_H

#include "sd_ewald_box.h"

namespace LAMMPS_NS {
class Domain;
}

namespace StokesDyn {

/* The parallelepiped that LAMMPS repeats in the directions with periodic = 1. */
struct Lattice {
  double origin[3];
  /* xx yy zz yz xz xy, the order of LAMMPS: edges (h0 0 0), (h5 h1 0), (h4 h3 h2) */
  double h[6];
  int periodic[3];

  static Lattice of(const LAMMPS_NS::Domain *domain);
  /* The same box for sums over its images: periodic in all directions, or in none */
  sd_ewald_box ewald_box() const;
};

}    // namespace StokesDyn
#endif
