/* What the command pair_style stokes_dynamics says. */
#ifndef SD_STOKES_SETTINGS_H
#define SD_STOKES_SETTINGS_H

#include "ambient.h"
#include "lubrication.h"
#include "preconditioner.h"
#include "rigid_clumps.h"
#include "scene.h"

#include <string>
#include <vector>

namespace StokesDyn {

struct StokesSettings {
  static constexpr const char *COMMAND = "Pair style stokes_dynamics";

  StokesSettings() = default;
  StokesSettings(LAMMPS_NS::LAMMPS *lmp, const std::vector<std::string> &words);

  int update_every = 1;
  bool add_force = false;
  double tolerance = 1e-3;
  int max_iter = 100;
  enum { SUBSTITUTION = 1, GRADIENTS = 2 };
  int algorithm = SUBSTITUTION;
  /* algorithm 1 stops where it diverges, instead of going on with 2 */
  bool strict = false;
  bool warm_start = true;
  Preconditioner::Kind precondition = Preconditioner::AUTO;
  Ambient::Settings ambient;
  Scene::Settings scene;
  RigidClumps::Settings rigid;
  Lubrication::Settings lubrication;
  Shells::Settings shells;

  /* Are solutions kept, from which the next solve begins? Substitution begins from 0, but it hands over to
   * gradients. */
  bool history() const { return warm_start && !strict; }

 private:
  std::string grid_file;

  void parse(class Keywords &in);
  void check(const class Keywords &in) const;
  void check_wall(const class Keywords &in) const;
  void check_close_spheres(const class Keywords &in, bool all_pairs) const;
};

}    // namespace StokesDyn
#endif
