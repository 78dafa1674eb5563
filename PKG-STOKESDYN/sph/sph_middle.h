/* The middle of a step of pair_style sph/artVisc/tensCorr, from which densities go on and particles are
 * shifted. */
#ifndef SD_SPH_MIDDLE_H
#define SD_SPH_MIDDLE_H

#include "sph_part.h"
#include "sph_scheme.h"

namespace StokesDyn {

class SphMiddle : public SphPart {
 public:
  using SphPart::SphPart;

  /* a new run */
  void begin(const SphScheme &scheme);
  /* The densities of now, by all fixes that make them; leaves x4 with the places of now, and the near pairs
   * in the list for the force. */
  void find_densities();
  /* [3 n] with pliant shift and correction, of each particle the acceleration by what it carries along */
  const double *kicks() const { return kick.data(); }
  /* Is the support of particle i, of this rank or a ghost, whole? In the middle of the latest step. */
  bool is_whole(int i) const { return du4[4 * (size_t) i + 3] > 0.0; }
  double bytes() const;

 private:
  SphScheme scheme = {};
  SphNeighbours around;
  LAMMPS_NS::bigint around_of = -1;    // the step of the list that `around` is made of
  Rows slope4, du4, B8;
  std::vector<double> rate, kick, displacing;

  const double *displacement_rates();
  void density_step();
  void sum_rates(double margin);
  void sum_middle(double margin);
  void close_sums();
  void look_at_surface(int found);
  void sum_densities(int bit, bool shepard);
};

}    // namespace StokesDyn
#endif
