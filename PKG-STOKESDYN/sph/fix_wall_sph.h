/* Walls: fix wall/sph and fix wall/region/sph, that repel SPH particles, and fix wall/adami/sph. See
 * doc/fix_wall_sph.md, doc/fix_wall_adami_sph.md. */
#ifndef SD_FIX_WALL_SPH_H
#define SD_FIX_WALL_SPH_H

#include "sph.h"

#include <algorithm>
#include <array>

namespace LAMMPS_NS {
class Region;
}

namespace StokesDyn {

class FixRepulsiveWall : public WallFix {
 public:
  using WallFix::WallFix;

 protected:
  double r0 = 0.0, D = 0.0;
  /* Particle i at the distance r along the inward normal: the repulsion and `more`, and its
   * reaction on the wall. */
  void push(int i, const double normal[3], double r, double more);
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
  void find_region();
  PairSph *pair = nullptr;
};

/* Fixed particles that carry the pressure of the fluid before them, with or without slip. */
class FixWallAdamiSph : public WallFix {
 public:
  static constexpr const char *STYLE = "wall/adami/sph";

  FixWallAdamiSph(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override { return 0; }
  void init() override;

  /* Of this step and rank: the force of the fluid on the wall particles, from the pair style. */
  void bears(const std::array<double, 3> &F) { std::copy_n(F.data(), 3, on_wall); }
  void bears_more(const std::array<double, 3> &F)
  {
    for (int d = 0; d < 3; d++) on_wall[d] += F[d];
  }

  /* Per mass, as wall particle i sees it, which changes its place with the velocity v: gravity, with
   * own_acceleration less that of the particle, a mean over the time tau; once a step. */
  const double *body_force(int i, const double v[3], double tau);
  bool slip = false, suction = true;
  BodyForce gravity;

 private:
  bool own_acceleration = false;
  double b[3] = {0.0, 0.0, 0.0};
  /* velocity at the last force, acceleration */
  AtomArray motion;
};

}    // namespace StokesDyn
#endif
