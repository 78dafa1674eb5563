/* compute sph/energy: where the energy of a fluid is and where it goes. See
 * doc/compute_sph_energy.md. */
#ifndef SD_COMPUTE_SPH_ENERGY_H
#define SD_COMPUTE_SPH_ENERGY_H

#include "keywords.h"

#include "compute.h"

namespace StokesDyn {

class ComputeSphEnergy : public LAMMPS_NS::Compute {
 public:
  static constexpr const char *STYLE = "sph/energy";

  ComputeSphEnergy(LAMMPS_NS::LAMMPS *, int, char **);
  ~ComputeSphEnergy() override;
  void init() override;
  double compute_scalar() override;
  void compute_vector() override;

 private:
  const Voice voice;
  /* the fix that follows the run */
  const std::string memory_id;
};

}    // namespace StokesDyn
#endif
