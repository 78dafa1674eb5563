/* Drops of fluid over all ranks, and the momentum that each keeps. The arithmetic is core/sph/sd_sph_drops.h;
 * here stand the messages between ranks. */
#ifndef SD_DROPS_H
#define SD_DROPS_H

#include "ghost_rows.h"
#include "sd_sph_drops.h"

#include "pointers.h"

#include <vector>

namespace StokesDyn {

class Drops : protected LAMMPS_NS::Pointers {
 public:
  Drops(LAMMPS_NS::LAMMPS *lmp, GhostExchange &ghosts) : Pointers(lmp), ghosts(ghosts) {}
  ~Drops();
  Drops(const Drops &) = delete;
  Drops &operator=(const Drops &) = delete;

  /* Takes from the forces F [3 n] on particles of this rank what each drop has too much that holds no held
   * particle; held [n], nullptr: none is */
  void keep_momentum(const sd_sph_film &film, const char *held, double *F);
  /* Of the latest step: how many there are, and the force on those that are held, x y z */
  int number() const { return count; }
  double force_on_held(int d) const { return sum[d]; }

 private:
  GhostExchange &ghosts;
  sd_cells cells = {};
  size_t room = 0;
  // of the list of neighbours of this step: until the next one drops stay as they are
  bool stay = false;
  std::vector<int> parent, of;
  std::vector<double> name;
  std::vector<sd_sph_drop> mine;
  int here = 0, count = 0;
  double sum[3] = {0.0, 0.0, 0.0};
  void find(const sd_sph_film &film);
  void make_names(const sd_sph_film &film);
};

}    // namespace StokesDyn
#endif
