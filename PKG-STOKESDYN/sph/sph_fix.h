/* What the fixes of SPH share. */
#ifndef SD_SPH_FIX_H
#define SD_SPH_FIX_H

#include "fix.h"

#include <string>

namespace StokesDyn {

class PairSph;

/* Knows the fluid: the scene must have its units and its atom style, and at a run the pair style.
 * */
class SphFix : public LAMMPS_NS::Fix {
 public:
  SphFix(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override { return 0; }
  void init() override;

 protected:
  std::string command;
  PairSph *pair = nullptr;
};

/* A fix whose per-atom vector is made in the pair style. The numbers stay with their atoms when
 * these move to another rank, are sorted, deleted or created: between runs the vector has those of
 * the latest force, and 0 for atoms that are new. */
class SphOutputFix : public SphFix {
 public:
  SphOutputFix(LAMMPS_NS::LAMMPS *, int, char **);
  ~SphOutputFix() override;
  double memory_usage() override;
  void grow_arrays(int) override;
  void copy_arrays(int i, int j, int) override { vector_atom[j] = vector_atom[i]; }
  void set_arrays(int i) override { vector_atom[i] = 0.0; }
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;

  /* One number for each atom of this rank. */
  void output(const double *values);

 protected:
  /* For the end of the constructor: LAMMPS cannot take back a callback of a fix that failed. */
  void begin();
};

}    // namespace StokesDyn
#endif
