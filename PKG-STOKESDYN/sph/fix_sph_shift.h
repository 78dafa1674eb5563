/* Internal fix: the memory of pair_style sph/artVisc/tensCorr with shift or correction. What the
 * middle of the last step left, by which the next one moves the particles, follows its atom through
 * migration, ghosts and restart: a broken run is then the unbroken one. */
#ifndef SD_FIX_SPH_SHIFT_H
#define SD_FIX_SPH_SHIFT_H

#include "rows_fix.h"

namespace StokesDyn {

class OwnFix;

class FixSphShift : public RowsFix {
 public:
  static constexpr const char *STYLE = "SPH/SHIFT";

  /* The pair style's, made anew unless it is of this kind; wanted false: nullptr, and none is left. */
  static FixSphShift *provide(const OwnFix &own, bool wanted, bool matrices);

  FixSphShift(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override { return 0; }
  int pack_border(int, int *, double *) override;
  int unpack_border(int, int, double *) override;

  /* [3 n] of particles and ghosts */
  const double *du() { return shifts.array()[0]; }
  /* Has there been a step? */
  bool filled() const { return has_rows != 0.0; }
  /* To and from the pair style's rows of sd_sph_order.h: du of all n, of this rank's whether their support is
   * whole, and with pliant shift and correction B and kick of this rank's. */
  void keep_rows(int n, const double *du, const double *B, const double *kick);
  void put_back(double *du, double *B, double *kick) const;

 protected:
  bool restored() const override { return filled(); }
  void another_in_file(int i) override { set_arrays(i); }
  std::vector<SavedNumbers> saved() override { return {{"filled", &has_rows}}; }

 private:
  const bool matrices;
  double has_rows = 0.0;
  // du; whether the support is whole; B and kick
  AtomArray shifts, wholes, rest;
};

}    // namespace StokesDyn
#endif
