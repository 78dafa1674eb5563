/* compute stokes_dynamics/stress: the stress of spheres that are shells of points.
 * See doc/compute_stokes_dynamics_stress.md. */
#ifndef SD_COMPUTE_STOKES_DYNAMICS_STRESS_H
#define SD_COMPUTE_STOKES_DYNAMICS_STRESS_H

#include "compute.h"

#include "keywords.h"

#include <vector>

namespace StokesDyn {

class Hydrodynamics;

class ComputeStokesDynamicsStress : public LAMMPS_NS::Compute {
 public:
  static constexpr const char *STYLE = "stokes_dynamics/stress";

  ComputeStokesDynamicsStress(LAMMPS_NS::LAMMPS *, int, char **);
  void init() override;
  void compute_vector() override;
  void compute_peratom() override;
  double memory_usage() override;

 private:
  const Voice voice;
  enum { COLUMNS = 12 };
  double sums[18] = {0.0};
  std::vector<double> moments;
  /* LAMMPS reads rows through these */
  std::vector<double *> rows;

  Hydrodynamics &hydrodynamics() const;
  void find_moments();
  void add_others(double *virial) const;
};

}    // namespace StokesDyn
#endif
