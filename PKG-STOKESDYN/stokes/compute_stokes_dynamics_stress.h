/* compute stokes_dynamics/stress: the stress of spheres that are shells of points.
 * See doc/compute_stokes_dynamics_stress.md.
 *
 * With noise it contains the stress that Brownian motion adds, without any further term. The solve of a step
 * has its points at x' = x + dt/2 v' and its films at x'' = x + dt/2 v'' (sd_drifter.h), and first moments
 *
 *   D = Q^T l + B V,   l = M'^-1 (K V - y),   V = N (K^T M'^-1 y + f),   C = Q^T M'^-1 K N + B N
 *
 * (C: loads on bodies -> D), so that in second order
 *
 *   <D> = kT [ div C - Q^T M'^-1 sum_k (d_k M') A_k - sum_k (d_k Q)^T A_k ] = kT div C
 *
 * as the second term is 0, or made up for as the drift is, and so is the third one. The random forces f of
 * films, which come from nowhere, are no stress themselves. At x the same y and f alone make a D of mean 0
 * that has nearly all of the variance: `variance low` takes it off.
 * Source: the mean is that of Bossis & Brady, J. Chem. Phys. 87, 5437 (1987), -R_SU R_FU^-1 there; that
 * one solve has it is our own. */
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

  /* Has somebody said that one of these with `variance low` will be asked for in this step? */
  static bool wants_low(LAMMPS_NS::LAMMPS *lmp);

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
  void take_off_noise();
  void symmetrise_pairs(double *virial) const;
  void add_others(double *virial) const;
};

}    // namespace StokesDyn
#endif
