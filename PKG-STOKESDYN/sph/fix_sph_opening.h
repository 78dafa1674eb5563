/* fix sph/inlet and sph/outlet: open ends of a flow. Beyond a plane stands a layer of particles that
 * are not moved by forces; one layer sends new ones, the other takes those that come. See
 * doc/fix_sph_inlet.md. */
#ifndef SD_FIX_SPH_OPENING_H
#define SD_FIX_SPH_OPENING_H

#include "sph.h"

#include <vector>

namespace StokesDyn {

class FixSphOpening : public SphFix {
 public:
  FixSphOpening(LAMMPS_NS::LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  double compute_scalar() override;

  /* Of a particle of the group at x: does it stand in the layer? */
  bool holds(const double *x) const { return beyond(x) > 0.0; }

 protected:
  std::vector<SavedNumbers> saved() override { return {{"passed", &passed, 1, true}}; }
  /* the words FACE POSITION WIDTH, which come first */
  Keywords parse_place(int narg, char **arg);
  /* For a setup of a run: the layer hides the empty space beyond it, and the fluid is not behind it. */
  void check_width();
  void check_side() const;
  double beyond(const double *x) const { return side * (x[axis] - plane); }
  bool is_held(int i) const;

  /* 0 1 2; 1: the layer is at the upper end of the flow, -1: at the lower one */
  int axis = 0, side = 1;
  double plane = 0.0, width = 0.0;
  /* mass that has passed, of this rank */
  double passed = 0.0;
};

/* Particles of its layer move with a given velocity into the flow, their pressure that of the fluid
 * before them. Where one leaves the layer, a new one begins at its back, the width of the layer
 * behind. */
class FixSphInlet : public FixSphOpening {
 public:
  static constexpr const char *STYLE = "sph/inlet";

  FixSphInlet(LAMMPS_NS::LAMMPS *, int, char **);
  void init() override;
  void setup_pre_exchange() override;
  void pre_exchange() override;
  void post_integrate() override;

  BodyForce gravity;

 private:
  Field velocity;
  std::vector<double> speeds;
  /* state, place of the new particle, its speed, the step in which the old one left. A particle that
   * comes back into the layer from the flow has been replaced and stays so. */
  enum Column { STATE, PLACE, SPEED = 4, LEFT, COLUMNS };
  enum State { REPLACED, IN_LAYER, DUE };
  AtomArray marks;

  /* A particle that is to be made. */
  struct Newcomer {
    double left, parent, place[3], speed, rho, mass, radius;
    int type, mask;
  };
  void find_speeds();
  void move_layer();
  std::vector<Newcomer> newcomers();
  bool is_here(double *place) const;
  void create(const Newcomer &like, LAMMPS_NS::tagint tag);
};

/* Particles of its layer keep the velocity across the plane with which they came, and have a given
 * pressure. They are deleted at its end. */
class FixSphOutlet : public FixSphOpening {
 public:
  static constexpr const char *STYLE = "sph/outlet";

  FixSphOutlet(LAMMPS_NS::LAMMPS *, int, char **);
  void init() override;
  void setup_pre_exchange() override;
  void pre_exchange() override;
  void post_integrate() override;

  /* [nlocal] Of this step; all ranks. */
  const double *find_pressures();

 private:
  Field pressure;
  std::vector<double> pressures;
};

}    // namespace StokesDyn
#endif
