/* fix wall/sph and fix wall/region/sph: walls that repel SPH particles. See doc/fix_wall_sph.md. */
#ifndef SD_FIX_WALL_SPH_H
#define SD_FIX_WALL_SPH_H

#include "fix.h"

#include <string>

namespace LAMMPS_NS {
class Region;
}

namespace StokesDyn {

class PairSph;

/* Sums the force on the wall, for both. */
class FixRepulsiveWall : public LAMMPS_NS::Fix {
 public:
  FixRepulsiveWall(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override;
  void setup(int) override;
  double compute_vector(int) override;

 protected:
  std::string command;
  double r0 = 0.0, D = 0.0;
  double on_wall[3] = {0.0, 0.0, 0.0};
  /* Adds a force to particle i, and its reaction to the wall. */
  void push(int i, const double normal[3], double size);
  [[noreturn]] void outside(int i);
};

class FixWallSph : public FixRepulsiveWall {
 public:
  static constexpr const char *STYLE = "wall/sph";
  FixWallSph(LAMMPS_NS::LAMMPS *, int, char **);
  void init() override;
  void post_force(int) override;

 private:
  // of the planes; -1: cylinder around z
  int axis = -1;
  bool has[2] = {false, false};
  double at[2] = {0.0, 0.0}, radius = 0.0;
};

class FixWallRegionSph : public FixRepulsiveWall {
 public:
  static constexpr const char *STYLE = "wall/region/sph";
  FixWallRegionSph(LAMMPS_NS::LAMMPS *, int, char **);
  void init() override;
  void post_force(int) override;

 private:
  std::string region_id;
  LAMMPS_NS::Region *region = nullptr;
  PairSph *pair = nullptr;
};

}    // namespace StokesDyn
#endif
