/* Where the factor of films is made (sd_tie_kept.h): at places that are rows of the memory, and those are
 * taken anew where films have changed too much since, or spheres have moved so far that they will have, where
 * a sphere has none, and where radii, viscosities or the box are others. So the same factor is there after a
 * restart and on other ranks: where rows are of other spheres than in the last solve it is made once more at
 * the places of then. */
#ifndef SD_FILMS_FACTOR_H
#define SD_FILMS_FACTOR_H

#include "body_scene.h"
#include "fix_stokes_dynamics_state.h"
#include "pointers.h"

#include <vector>

namespace StokesDyn {

class FilmsFactor : protected LAMMPS_NS::Pointers {
 public:
  FilmsFactor(LAMMPS_NS::LAMMPS *lmp, const Scene &scene, BodyScene &bodies) :
      Pointers(lmp), scene(scene), bodies(bodies)
  {
  }

  /* Before a solve, on all ranks together: the bodies have been assembled. And after it: where the factor
   * was made to the memory, if it was made anew */
  void recall(const FixStokesDynamicsState &memory);
  void note(FixStokesDynamicsState &memory);
  /* Another factor is made in between. */
  void forget() { rows.never(); }

 private:
  const Scene &scene;
  BodyScene &bodies;
  /* whose rows the factor is of */
  Stamp rows;
  /* that of now */
  std::vector<double> numbers;

  void find_numbers();
  bool known(const FixStokesDynamicsState &memory) const;
  void make_there(const FixStokesDynamicsState &memory);
};

}    // namespace StokesDyn
#endif
