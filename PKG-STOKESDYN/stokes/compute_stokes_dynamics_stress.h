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

  /* With noise: less the stress of the same random numbers at the start of the step? */
  bool low() const { return low_variance; }
  /* Has somebody said that this will be asked for in that step, or in the one after it? Who asks in every
   * step says so at the end of each, when the next one has begun */
  bool asked_in(LAMMPS_NS::bigint step) const;

 private:
  const Voice voice;
  enum { COLUMNS = 12, OTHERS = COLUMNS, PRESSURE = 18, VALUES = 19 };
  double sums[VALUES] = {0.0};
  bool low_variance = false;
  std::vector<double> moments;
  /* LAMMPS reads rows through these */
  std::vector<double *> rows;

  Hydrodynamics &hydrodynamics() const;
  void find_moments();
  void add_others(double *virial) const;
};

}    // namespace StokesDyn
#endif
