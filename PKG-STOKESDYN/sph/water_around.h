/* Which particles of SPH are around which grains smaller than h, and rows of atoms for the sums over them
 * (core/sph/sd_sph_grains.h). */
#ifndef SD_WATER_AROUND_H
#define SD_WATER_AROUND_H

#include "sd_sph_grains.h"

#include "pointers.h"

#include <vector>

namespace StokesDyn {

class PairSph;

class WaterAround : protected LAMMPS_NS::Pointers {
 public:
  explicit WaterAround(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp) {}
  ~WaterAround();
  WaterAround(const WaterAround &) = delete;
  WaterAround &operator=(const WaterAround &) = delete;

  /* As atoms: the particles of this rank and its ghosts, and the grains of this rank */
  std::vector<int> points, grains;
  /* Of the points: places, 1 of a wall; places of the grains. As of the latest call of follow */
  std::vector<double> places, grain_places;
  std::vector<int> walls;

  /* Grains are the atoms of these groups that are no particles; they see what is within 2 h. Lists last as
   * long as those of LAMMPS. */
  void follow(const PairSph &pair, int bits, double h);
  /* With the weights that are in it, of the caller */
  sd_sph_around list() { return {(int) grains.size(), first.data(), particle.data(), weight.data()}; }
  bool is_beside_wall(size_t grain) const;

  /* Rows of atoms as rows of points, and back: 0 of all other atoms */
  std::vector<double> at_points(const double *of_atoms, int columns) const;
  std::vector<double> at_atoms(const std::vector<double> &of_points, int columns) const;
  /* Rows of grains: means over the water around them, of 1 or 3 columns */
  std::vector<double> mean_of(const double *of_atoms, int columns);

 private:
  sd_cells cells = {};
  LAMMPS_NS::bigint list_of = -1;
  std::vector<int> first, particle;
  std::vector<double> weight;
  void look_at_places();
  void make(const PairSph &pair, int bits, double h);
};

}    // namespace StokesDyn
#endif
