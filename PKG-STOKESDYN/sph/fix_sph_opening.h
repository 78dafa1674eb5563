/* fix sph/inlet and sph/outlet: open ends of a flow. Beyond a plane stands a layer of particles that
 * are not moved by forces; one layer sends new ones, the other takes those that come. See
 * doc/fix_sph_inlet.md. */
#ifndef SD_FIX_SPH_OPENING_H
#define SD_FIX_SPH_OPENING_H

#include "sd_sph_opening.h"
#include "sph.h"

#include <array>
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
  /* Has the layer a pressure that is given to it? */
  virtual bool gives_pressure() const = 0;
  /* That of this step; all ranks. Then that of particle i, in the layer. */
  void find_pressures();
  double pressure_of(int i) const { return pressures[i]; }

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
  Field pressure;
  /* the flow turns against the opening, which has been said */
  bool told = false;
  void tell_of_backflow(const std::string &what);
  /* The flow before the layer, within 2 h of the plane; all ranks. Then its speed out of the layer, across
   * from place x, and how the flow goes as a whole. */
  void look_at_flow();
  double speed_before(const double *x, double otherwise) const;
  double whole_flow() const;

 private:
  sd_sph_section section = {};
  std::vector<double> flow;
  std::array<double, 2> across(const double *x) const;
  std::vector<double> pressures;
};

/* Particles of its layer move into the flow with a given velocity, or all with that of a given discharge,
 * their pressure that of the fluid before them; or they have a given pressure, and move as the fluid before
 * them does. Where one leaves the layer, a new one begins at its back, the width of the layer
 * behind. */
class FixSphInlet : public FixSphOpening {
 public:
  static constexpr const char *STYLE = "sph/inlet";

  FixSphInlet(LAMMPS_NS::LAMMPS *, int, char **);
  void init() override;
  void setup_pre_exchange() override;
  void pre_exchange() override;
  void post_integrate() override;
  bool gives_pressure() const override { return drive == PRESSURE; }

  BodyForce gravity;

 protected:
  std::vector<SavedNumbers> saved() override;
  void write_state(NamedState &) override;
  void read_state(const NamedState &in) override { resumed = !in.get("time").empty(); }

 private:
  enum Drive { VELOCITY, FLOW_RATE, PRESSURE };
  Drive drive = VELOCITY;
  Field velocity, flow_rate;
  /* of a file: discharges at their times */
  std::vector<double> times, rates;
  /* Some LAMMPS begin the time at 0 again after a restart: the time of the restart file, whether
   * this fix has it from there, and what its time is ahead of LAMMPS's. */
  double time_then = 0.0, time_before = 0.0;
  bool resumed = false;
  double time() const;
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
  void read_hydrograph(const std::string &file);
  double discharge();
  double common_speed();
  void follow_flow();
  void find_speeds();
  void move_layer();
  std::vector<Newcomer> newcomers();
  bool is_here(double *place) const;
  int create(const Newcomer &like, LAMMPS_NS::tagint tag);
};

/* Particles of its layer move across the plane as the fluid before them does, and have a given pressure.
 * They are deleted at its end. */
class FixSphOutlet : public FixSphOpening {
 public:
  static constexpr const char *STYLE = "sph/outlet";

  FixSphOutlet(LAMMPS_NS::LAMMPS *, int, char **);
  void init() override;
  void setup_pre_exchange() override;
  void pre_exchange() override;
  void post_integrate() override;
  bool gives_pressure() const override { return true; }
};

}    // namespace StokesDyn
#endif
