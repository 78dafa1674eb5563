/* Forces of pair_style sph/artVisc/tensCorr, and what is kept of them. */
#ifndef SD_SPH_FORCES_H
#define SD_SPH_FORCES_H

#include "sph_middle.h"
#include "sph_viscosities.h"

namespace StokesDyn {

class SphForces : public SphPart {
 public:
  SphForces(const SphCoefficients &settings, const SphRoles &roles, SphRows &rows, const SphMiddle &middle,
            SphViscosities &viscosities, GhostExchange &ghosts);

  /* a new run: does a compute sph/energy ask for forces and friction? */
  void begin(bool measured);
  /* Adds to the forces of atoms. pairwise: F of each pair is kept */
  void compute(bool pairwise);
  /* [4 n] what atoms got in it, or in the implicit friction after it, and how many: also ghosts, or none of
   * these */
  const Rows &given() const { return f4; }
  int who_gets() const;
  /* of the latest force, in the order of the near pairs, with correction of their list both ways */
  const double *of_pairs() const { return each.data(); }
  /* SphViscosities::rub_implicitly, added to what is kept */
  void rub_implicitly(double tau);
  const double *own_forces() const { return own.data(); }
  const double *own_friction() const { return rubs.data(); }
  double bytes() const;

 private:
  const SphMiddle &middle;
  SphViscosities &viscosities;
  bool measured = false;
  SphNeighbours of_flow;
  Rows f4, own, rubs;
  std::vector<double> each;

  double sum_forces(const sd_sph_model &of, SphNeighbours &both, const sd_sph_list &half, bool rates, Rows &F,
                    double *of_pairs);
  void add_kicks(Rows &F) const;
  void keep_forces();
  sd_sph_list pairs_of_flow();
  [[noreturn]] void coincident();
};

}    // namespace StokesDyn
#endif
