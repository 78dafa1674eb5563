/* What the fixes of SPH share. */
#ifndef SD_SPH_FIX_H
#define SD_SPH_FIX_H

#include "field.h"
#include "rows_fix.h"

namespace StokesDyn {

class PairSph;

/* Knows the fluid: the scene must have its units and atom style, and at a run the pair style. */
class SphFix : public RowsFix {
 public:
  SphFix(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override { return 0; }
  void init() override;

  const Voice voice;

 protected:
  Keywords keywords(int narg, char **arg) const;

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
  /* For the end of the constructor: LAMMPS cannot take back a callback of a fix that failed. */
  void begin();

 private:
  AtomArray values;
};

/* A force per mass on all: x y z, each a number or a variable of equal style. */
class BodyForce {
 public:
  void parse(Keywords &in);
  /* of: the keyword that gives it */
  void init(const Voice &of);
  /* Of this step; all ranks. */
  void find(LAMMPS_NS::LAMMPS *lmp);
  const double *now() const { return g; }

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

  const Voice voice;

 protected:
  Keywords keywords(int narg, char **arg) const;

  double on_wall[3] = {0.0, 0.0, 0.0};
};

}    // namespace StokesDyn
#endif
