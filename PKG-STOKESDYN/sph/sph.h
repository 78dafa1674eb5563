/* What the SPH styles share: how they find each other, checks of the scene, bases of the fixes. */
#ifndef SD_SPH_H
#define SD_SPH_H

#include "field.h"
#include "ghost_rows.h"
#include "rows_fix.h"

#include <new>
#include <vector>

namespace LAMMPS_NS {
class Pair;
}

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

  constexpr const char *PAIR_STYLE = "sph/artVisc/tensCorr";

  /* The pair style of the scene, a PairSph; fails without one. */
  LAMMPS_NS::Pair *require_pair(const Voice &voice);

  double mass(LAMMPS_NS::LAMMPS *lmp, int i);

  /* [3 n] the rows of an array of LAMMPS, which are one piece of memory; nullptr: there are none */
  inline double *numbers(double **rows) { return rows ? rows[0] : nullptr; }

}    // namespace Sph

// --- fixes ---------------------------------------------------------------------------------------

/* Knows the fluid: the scene must have its units and atom style, and at a run the pair style. */
class SphFix : public GhostRows<RowsFix> {
 public:
  SphFix(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override { return 0; }
  void init() override;

 protected:
  /* of a fix that asks it something: PairSph::of, prepared */
  PairSph *pair = nullptr;
};

/* A fix whose per-atom vector is made in the pair style: between runs it has the numbers of the
 * latest force, and 0 for atoms that are new. */
class SphOutputFix : public SphFix {
 public:
  SphOutputFix(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg) : SphFix(lmp, narg, arg), values(1) {}
  void grow_arrays(int) override;

  /* One number for each atom of this rank. */
  void output(const double *numbers);

 protected:
  /* Once, in the constructor. */
  void begin();

 private:
  AtomArray values;
};

/* A force per mass on all: x y z, each a number or a variable of equal style. */
class BodyForce {
 public:
  void parse(Keywords &in);
  void init(LAMMPS_NS::LAMMPS *lmp);
  /* Of this step; all ranks. */
  void find(LAMMPS_NS::LAMMPS *lmp);
  const double *now() const { return g; }
  bool varies() const;

 private:
  Field parts[3];
  double g[3] = {0.0, 0.0, 0.0};
};

/* A wall: sums up the force of the fluid on it, global vector x y z. */
class WallFix : public RowsFix {
 public:
  WallFix(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override;
  void setup(int vflag) override { post_force(vflag); }
  double compute_vector(int) override;

 protected:
  double on_wall[3] = {0.0, 0.0, 0.0};
};

}    // namespace StokesDyn
#endif
