/* A fix whose per-atom vector is made in the pair style. The numbers stay with their atoms when these move to another rank,
 * are sorted, deleted or created: between runs the vector has those of the latest force, and 0 for atoms that are new. */
#ifndef SD_FIX_SPH_OUTPUT_H
#define SD_FIX_SPH_OUTPUT_H

#include "fix.h"

namespace StokesDyn {

class FixSphOutput : public LAMMPS_NS::Fix {
 public:
  FixSphOutput(LAMMPS_NS::LAMMPS *, int, char **);
  ~FixSphOutput() override;
  int setmask() override { return 0; }
  void init() override;
  double memory_usage() override;
  void grow_arrays(int) override;
  void copy_arrays(int i, int j, int) override { vector_atom[j] = vector_atom[i]; }
  void set_arrays(int i) override { vector_atom[i] = 0.0; }
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;

  /* One number for each atom of this rank. */
  void output(const double *values);

 protected:
  /* For the end of the constructor. LAMMPS cannot take back a callback of a fix that failed before. */
  void begin();
};

}    // namespace StokesDyn
#endif
