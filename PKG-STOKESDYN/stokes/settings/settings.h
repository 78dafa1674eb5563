/* What the command pair_style stokes_dynamics says. */
#ifndef SD_STOKES_SETTINGS_H
#define SD_STOKES_SETTINGS_H

#include "ambient.h"
#include "lubrication.h"
#include "rigid_clumps.h"
#include "scene_settings.h"
#include "shells.h"

#include <string>
#include <vector>

namespace StokesDyn {

class Keywords;

struct StokesSettings {
  static constexpr const char *COMMAND = "Pair style stokes_dynamics";

  StokesSettings() = default;
  StokesSettings(LAMMPS_NS::LAMMPS *lmp, const std::vector<std::string> &words);

  int update_every = 1;
  bool add_force = false;
  double tolerance = 1e-3;
  /* Where so many substitutions do not suffice they are too slow; a smaller max_iter was asked for. */
  static constexpr int ENOUGH_SUBSTITUTIONS = 100;
  int max_iter = ENOUGH_SUBSTITUTIONS;
  enum { SUBSTITUTION = 1, GRADIENTS = 2 };
  int algorithm = SUBSTITUTION;
  /* algorithm 1 stops where it diverges, instead of going on with 2 */
  bool strict = false;
  bool warm_start = true;
  /* Of algorithm 2: which kind of preconditioner, or the rule that chooses (preconditioner.h) */
  enum Precondition { AUTO, NONE, CLUMP, SPARSE, WAVES };
  Precondition precondition = AUTO;
  Ambient::Settings ambient;
  SceneSettings scene;
  RigidClumps::Settings rigid;
  Lubrication::Settings lubrication;
  Shells::Settings shells;

  /* Are solutions kept, from which the next solve begins? Substitution begins from 0, but it hands over to
   * gradients. */
  bool history() const { return warm_start && !strict; }
  /* Are spheres points that bear nothing but their loads, unless they are held? Then there is nothing to
   * solve. */
  bool forces_are_loads() const
  {
    return !shells.on() && !lubrication.on && !(rigid.on && !rigid.each_alone());
  }
  /* Is the guess of motions of spheres that are points on a line through two solutions? */
  bool lines() const { return history() && !shells.on() && !forces_are_loads(); }

 private:
  std::string grid_file;

  void parse(Keywords &in);
  void take_visc(Keywords &in);
  void take_fluid_velocity(Keywords &in);
  void take_fluid_vorticity(Keywords &in);
  void take_algorithm(Keywords &in);
  void take_relative_tolerance(Keywords &in);
  void take_far_field_tolerance(Keywords &in);
  void take_rigid_clumps(Keywords &in);
  void take_shell(Keywords &in);
  void take_multiblob(Keywords &in);
  void take_multiblob_most(Keywords &in);
  void take_lubrication_gap(Keywords &in);
  void take_lubrication_range(Keywords &in);
  void check(const Keywords &in) const;
  void check_with_walls(const Keywords &in);
  void check_close_spheres(const Keywords &in, bool all_pairs) const;
};

}    // namespace StokesDyn
#endif
