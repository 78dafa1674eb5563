/* The particles of this rank and their ghosts as the core reads them: model, lists and rows of one step of
 * pair_style sph/artVisc/tensCorr. */
#ifndef SD_SPH_ROWS_H
#define SD_SPH_ROWS_H

#include "sph_roles.h"

#include <vector>

namespace LAMMPS_NS {
class NeighList;
}

namespace StokesDyn {

/* Neighbours with their memory, as sd_sph_both. */
struct SphNeighbours {
  std::vector<int> pool, own, count;
  std::vector<int *> neighbor;
  void resize(int particles, size_t entries);
  sd_sph_both both(int n) { return {n, neighbor.data(), own.data(), count.data()}; }
  sd_sph_near room(double margin)
  {
    return {margin, pool.data(), neighbor.data(), own.data(), count.data()};
  }
  double bytes() const;
};

class SphRows : protected LAMMPS_NS::Pointers {
 public:
  SphRows(const SphCoefficients &settings, const SphRoles &roles);

  /* Of this step: model, list and particles; cutsq: of the pair style. Lists hold until the next list. */
  void prepare(const LAMMPS_NS::NeighList *list, double **cutsq);

  sd_sph_model model = {};
  sd_sph_particles particles = {};
  /* LAMMPS's list; that of near pairs, when a pass of the step has picked them, which are in `near` */
  sd_sph_list raw = {}, pairs = {};
  SphNeighbours near;
  /* Do two ranks share their pairs? With sums that have many columns each has its own: no ghost then gets
   * anything, and nothing goes back. */
  bool shared = true;
  /* as of sd_sph_particles; of each the pressure */
  Rows x4, v4;
  std::vector<double> P;
  /* room for sums over neighbours, and for what is summed */
  Rows sums, weights;
  /* as particles.phase, where somebody asks for it */
  std::vector<int> phases;

  /* x4 of this moment; with volumes, as sums over neighbours need them */
  void pack_places();
  void pack_volumes();
  /* P of owned and ghost particles from the densities they carry, so both sides of a pair see the same. */
  void find_pressures();
  /* Fails at one of the first n that has no density. */
  void look_at_densities(int n) const;
  double bytes() const;

 private:
  const SphCoefficients &settings;
  const SphRoles &roles;
  std::vector<sd_sph_coefficients> coefficients;
  std::vector<double> masses;
  std::vector<int> classes;
  bool types_are_alike(double **cutsq);
  void find_phases();
};

}    // namespace StokesDyn
#endif
