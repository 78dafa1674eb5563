/* A fix that keeps rows of numbers with its atoms: LAMMPS's callbacks, handed on to all of them. */
#ifndef SD_ROWS_FIX_H
#define SD_ROWS_FIX_H

#include "fix.h"

#include "atom_rows.h"

namespace StokesDyn {

class RowsFix : public LAMMPS_NS::Fix {
 public:
  RowsFix(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg) {}
  ~RowsFix() override;

  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override { return maxsize_restart(); }
  int maxsize_restart() override;
  double memory_usage() override;

 protected:
  /* Once, in the constructor: what it keeps, with restarts also in their files. output, one of all
   * or nullptr, becomes array_atom. */
  void keep(const std::vector<RowsOfAtoms *> &all, AtomArray *output, bool restarts);
  /* Before the rows of an atom are written to a restart file. */
  virtual void record(int /*i*/) {}
  /* Do the rows of a restart file stand? */
  virtual bool restored() const { return true; }

 private:
  std::vector<RowsOfAtoms *> kept;
  AtomArray *shown = nullptr;
};

}    // namespace StokesDyn
#endif
