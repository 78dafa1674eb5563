/* Particles of pair_style sph/artVisc/tensCorr that are no fluid, of walls and of open ends: what they take
 * from the fluid before them. */
#ifndef SD_SPH_WALLS_H
#define SD_SPH_WALLS_H

#include "sph_part.h"

#include <string>

namespace StokesDyn {

class SphWalls : public SphPart {
 public:
  using SphPart::SphPart;

  /* Density and vest of all of them, from the pressures of the fluid; then all pressures are those of now. */
  void follow();
  double bytes() const;

 private:
  Rows spins;
  std::vector<double> wall_rows;

  const double *spins_of_walls();
  void check_turning(const double w2_shear2[2]) const;
  void sums_of_other_fluids(const double *w);
  void wall_row(int i, const double *sums_i, double *row);
  void held_row(int i, const double *sums_i, double *row);
  [[noreturn]] void no_density(const Voice &of, int i, const std::string &asked) const;
  void look_at_gravity() const;
};

}    // namespace StokesDyn
#endif
