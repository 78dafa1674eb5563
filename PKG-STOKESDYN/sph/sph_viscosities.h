/* Viscosities of the particles of pair_style sph/artVisc/tensCorr, and friction that is implicit. */
#ifndef SD_SPH_VISCOSITIES_H
#define SD_SPH_VISCOSITIES_H

#include "sph_part.h"

namespace StokesDyn {

class SphViscosities : public SphPart {
 public:
  using SphPart::SphPart;

  /* Of a step, where each particle has its own; x4 and v4 are packed. */
  void find();
  /* Of particle i, of this rank, in the latest force; with a law of viscosity 0 for walls. */
  double of(int i) const;
  /* what shear feels, with that of artVisc: rho alpha c h/(2 (D+2)) */
  double all_of(int i) const;
  /* At the end of a step, when all forces are known: rows F [4 (n+1)] of what makes their friction, that of
   * the estimated velocities, that of the velocities a time tau later (sd_sph_implicit.h). */
  void rub_implicitly(double tau, Rows &F);
  double bytes() const;

 private:
  std::vector<double> viscosities, inertia;
  Rows scratch;
  std::vector<double> shear_rates();
};

}    // namespace StokesDyn
#endif
