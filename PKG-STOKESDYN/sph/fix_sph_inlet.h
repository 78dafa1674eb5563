/* fix sph/inlet: see doc/fix_sph_inlet.md. */
#ifndef SD_FIX_SPH_INLET_H
#define SD_FIX_SPH_INLET_H

#include "fix_sph_opening.h"

#include <vector>

namespace StokesDyn {

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
  bool reaches(const double *x) const override;
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
  /* Are particles beyond the plane that are none of the layer, on any rank? If so: the mass of the layer
   * over the section, and the largest of its nodes. */
  bool strayed = false;
  std::vector<double> layer;
  double full = 0.0;
  void look_at_strays();
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

}    // namespace StokesDyn
#endif
