/* What the SPH styles share: the names by which they find each other, and checks of the scene. */
#ifndef SD_SPH_H
#define SD_SPH_H

#include "keywords.h"

#include "fix.h"

#include <new>
#include <vector>

namespace StokesDyn {

class PairSph;

/* Rows of four numbers that begin with a cache line: a row across two costs the loops a third. */
template <class T> struct CacheLines {
  using value_type = T;
  CacheLines() = default;
  template <class U> CacheLines(const CacheLines<U> &) {}
  T *allocate(size_t n)
  {
    return static_cast<T *>(::operator new(n * sizeof(T), std::align_val_t(64)));
  }
  void deallocate(T *p, size_t) { ::operator delete(p, std::align_val_t(64)); }
  template <class U> bool operator==(const CacheLines<U> &) const { return true; }
  template <class U> bool operator!=(const CacheLines<U> &) const { return false; }
};
using Rows = std::vector<double, CacheLines<double>>;

namespace Sph {

  /* Fails unless the atom style has the density and the velocity that SPH works with, and force is
   * mass times acceleration in the units of the scene, pressure mass / (length time^2) and density
   * mass / length^3. */
  void require_scene(const Voice &voice);

  /* The pair style of the scene; fails without one. */
  PairSph *require_pair(const Voice &voice);

  /* Those that move particles by forces: all that integrate in time but fix move and rigid
   * bodies. */
  std::vector<LAMMPS_NS::Fix *> integrators(LAMMPS_NS::LAMMPS *lmp);

  /* Union of their group bits. */
  int groups(const std::vector<LAMMPS_NS::Fix *> &fixes);

  double mass(LAMMPS_NS::LAMMPS *lmp, int i);

}    // namespace Sph
}    // namespace StokesDyn
#endif
