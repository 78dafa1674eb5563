/* The stress of a Brownian suspension of shells, in steps of scheme midpoint: first moments D of the solve in
 * the middle of the step just made, for compute stokes_dynamics/stress.
 *
 *   D = C(x_mid) (F* + f) + what the flow makes,      C: loads on bodies -> first moments
 *   < C(x_mid) f > = kT div C       since  x_mid - x = dt/2 N f + ...,   < N f f^T > = 2 kT/dt
 *
 * So the mean of D has the Brownian stress -kT div C/V without any further term. f itself, a force that
 * comes from nowhere, is no stress: what holds a sphere in its clump against f is none either.
 * C(x) f, of the same numbers where the step begins, has the mean 0 and nearly all of the variance: `low` is
 * D less that. It is what two solves at x differ by, with and without f.
 * Source: the mean is that of Bossis & Brady, J. Chem. Phys. 87, 5437 (1987), -R_SU R_FU^-1 there. */
#ifndef SD_BROWNIAN_STRESS_H
#define SD_BROWNIAN_STRESS_H

#include "pointers.h"
#include "rows_fix.h"

#include <vector>

namespace StokesDyn {

class Hydrodynamics;

class BrownianStress : protected LAMMPS_NS::Pointers {
 public:
  explicit BrownianStress(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp), rows(COLUMNS) {}

  /* Is there a compute that asks, and does one ask for `low` in the step after this one? */
  bool wanted() const;
  bool wants_low() const;
  /* When a run begins elsewhere than the last one ended: no step has been made */
  void forget() { raw = low = next = -1; }

  /* Of the solve at the start of a step without noise, if wants_low(), and of that with noise [6 nlocal].
   * Where no step has been made yet, these are what is shown. On all ranks together, as what follows. */
  void without_noise(Hydrodynamics &);
  void begin(Hydrodynamics &, const std::vector<double> &noise);
  /* Of that in the middle of the step */
  void middle(Hydrodynamics &, const std::vector<double> &noise);

  /* Is it known in this step? Then that of atom i [12], as Hydrodynamics::stress */
  bool known(bool of_low) const;
  const double *of(int i, bool of_low) const { return rows[i] + (of_low ? LOW : RAW); }

  /* D, D less that of the noise at the start, and that of the noise of the step that begins */
  enum { RAW, LOW = 12, NOISE = 24, COLUMNS = 36 };
  AtomRows rows;
  /* Steps of which these are known; NOISE: the step that begins there */
  double raw = -1, low = -1, next = -1;

 private:
  std::vector<double> still, moments;
};

}    // namespace StokesDyn
#endif
