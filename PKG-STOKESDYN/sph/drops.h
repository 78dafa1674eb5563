/* Drops of fluid over all ranks, and the momentum that each keeps. The arithmetic is core/sph/sd_sph_drops.h;
 * here stand the messages between ranks. */
#ifndef SD_DROPS_H
#define SD_DROPS_H

#include "sd_sph_drops.h"

#include "pointers.h"

#include <functional>
#include <vector>

namespace StokesDyn {

class Drops : protected LAMMPS_NS::Pointers {
 public:
  explicit Drops(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp) {}
  ~Drops();
  Drops(const Drops &) = delete;
  Drops &operator=(const Drops &) = delete;

  /* Sends a number of each particle of this rank to its ghosts */
  using ToGhosts = std::function<void(double *)>;
  /* Takes from the forces F [3 n] on particles of this rank what each drop has too much that holds no held
   * particle; mass, held [n] 0 or 1 */
  void keep_momentum(const sd_sph_film &film, const double *mass, const double *held,
                     const ToGhosts &to_ghosts, double *F);
  /* Of the latest step: how many there are, and the force on those that are held, x y z */
  int number() const { return count; }
  double force_on_held(int d) const { return sum[d]; }

 private:
  sd_cells cells = {};
  size_t room = 0;
  std::vector<int> parent, place;
  std::vector<double> name;
  std::vector<sd_sph_drop> drops;
  int count = 0;
  double sum[3] = {0.0, 0.0, 0.0};
  void find(const sd_sph_film &film, const ToGhosts &to_ghosts);
};

}    // namespace StokesDyn
#endif
